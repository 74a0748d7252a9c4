"""Answers are judged: errors of the right sign and size, bounds, intervals, symmetry; who leads, and by what."""

import math

import numpy as np
import pytest

import benchmark
from demheat.io.answers import Answers, Given
from demheat.terminal.commands.scores import Score, cheapest, scores_of, standings

SPHERE, TRUE = "sc-third-s10", 1.3957348377442804


def score(**given):
    (found,) = scores_of(Answers("mine.json", "mine", "", "", "", (Given(**given),)), benchmark.read)
    return found


def test_an_error_is_that_of_what_is_known():
    found = score(scene=SPHERE, conductivity=1.02 * TRUE, cpu_s=3.0, wall_s=2.0)
    assert found.error == pytest.approx(0.02, rel=1e-12)  # rounding
    # The file's error, over the value.
    assert found.known_to == pytest.approx(2e-12 / TRUE) and found.cost == 3.0
    assert found.beyond == "" and found.holds is None and found.interval == "" and found.remarks == ""


@pytest.mark.parametrize(("lower", "upper", "holds"), [(0.99, 1.01, True), (1.001, 1.01, False), (0.9, 0.999, False)])
def test_an_interval_holds_or_not(lower, upper, holds):
    found = score(scene=SPHERE, conductivity=TRUE, lower=lower * TRUE, upper=upper * TRUE)
    assert found.holds is holds and found.width == pytest.approx(upper - lower)
    assert found.interval.startswith("holds" if holds else "misses")


def test_what_no_body_conducts_is_beyond_bounds():
    # Of a sphere with 15.5 % of the cube and contrast 10: Reuss 1.16, Voigt 2.4.
    assert score(scene=SPHERE, conductivity=1.1).beyond.startswith("Reuss, Voigt: 1.16")
    assert score(scene=SPHERE, conductivity=2.5).beyond and not score(scene=SPHERE, conductivity=2.3).beyond
    # A laminate attains Reuss's, to rounding.
    assert not score(scene="laminate-across", conductivity=20 / 11).beyond


def test_a_tensor_is_symmetric_or_not():
    rows = [[1.4, 0.1, 0.0], [0.0, 1.4, 0.0], [0.0, 0.0, 1.6]]
    table = Given(scene=SPHERE, conductivity=TRUE, tensor=np.array(rows))
    (found,) = scores_of(Answers("mine.json", "mine", "", "", "", (table,)), benchmark.read)
    assert found.asymmetry == pytest.approx(0.1 / 1.6) and "asymmetric by 6.2 %" in found.remarks


def test_temperatures_are_judged_by_the_worst_over_the_span():
    known = benchmark.load("slab-step")[1]
    given = known.temperature.copy()
    given[3] -= 0.05
    # Walls at 0 and 1.
    found = score(scene="slab-step", temperatures=given)
    assert found.error == pytest.approx(-0.05, rel=1e-9) and found.known_to == pytest.approx(1e-12)
    with pytest.raises(
        ValueError, match=r"mine.json: answers\[0\]: scene 'slab-step' asks for temperatures .* 12 points"
    ):
        score(scene="slab-step", temperatures=given[:5])
    with pytest.raises(ValueError, match="in their order, and there are none"):
        score(scene="slab-step", conductivity=1.0)
    with pytest.raises(ValueError, match="asks for a conductivity, which is not there"):
        score(scene=SPHERE, temperatures=given)


def test_an_image_that_is_not_shipped_is_judged_all_the_same():
    assert abs(score(scene="taufactor-500-x", conductivity=0.2157).error) < 1e-3


def test_who_leads():
    made = [
        Score("slow", "a", "", error=0.001, cpu_s=8.0),
        Score("slow", "b", "", error=0.001, cpu_s=2.0),
        Score("fast", "a", "", error=-0.005, cpu_s=2.0),
        Score("fast", "a", "fine", error=0.0, cpu_s=3.0),
        Score("fast", "b", "", error=0.02, cpu_s=0.1),
        Score("none", "a", "", refused="cannot"),
        Score("free", "a", "", error=0.0),
    ]
    best = cheapest(made, 0.01)
    assert {scene: [each.program for each in row] for scene, row in best.items()} == {
        "a": ["fast", "slow", "free"],
        "b": ["slow"],
    }
    slow, fast, free, none = standings(made, 0.01)
    # 8 over 2 and 2 over 2; a refusal is no answer, what declares no cost has no factor.
    assert slow[:3] == ("slow", 2, 2) and slow.factor == pytest.approx(2.0) and slow.first == 1
    assert fast[:3] == ("fast", 1, 2) and fast.factor == 1.0 and fast.first == 1
    assert free[:3] == ("free", 1, 1) and math.isnan(free.factor) and free.first == 0
    assert none[:3] == ("none", 0, 0)
