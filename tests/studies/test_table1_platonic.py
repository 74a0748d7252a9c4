"""The study of the Platonic law: its table by the printed rule."""

import pytest

from studies import table1_platonic as study


@pytest.mark.parametrize("neighbours", [1, 5, 10, 20])
def test_the_printed_rule_gives_the_printed_lines(neighbours):
    # Terreros et al. 2013, table 1; of cut digits up to three are carried on.
    for letter in "sf":
        assert study._by_rule(letter, neighbours) == pytest.approx(study.PAPER[f"{letter}_{neighbours}"], abs=3e-5)


def test_corners_are_met():
    assert [study._by_rule("s", n) for n in (4, 6, 12)] == [10.39230, 4.0, 1.38757]
    assert study._by_rule("f", 8) == 0.68017
    # Above the last crystal the line goes on.
    assert study._by_rule("f", 16) == pytest.approx(0.74048 + (0.74048 - 0.68017))
