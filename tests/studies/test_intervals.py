"""The study of intervals: what counts as holding, that claims fail where intervals do, and what is drawn."""

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from demheat.referee import value_error
from studies import intervals
from studies.intervals import means, rows, scenes


def frame(*, off, half, doubt=0.0, **more):
    """Rows of one method with these errors and half intervals, beside what is true, 2."""
    n = len(off)
    right = {"scene": "rod", "seed": range(n), "method": "truth", "true_lower": 2 - doubt, "true_upper": 2 + doubt}
    k = 2 * (1 + np.array(off))
    ends = {"conductivity": k, "lower": k - 2 * np.array(half), "upper": k + 2 * np.array(half)}
    flags = {"warned": False, "unseen": False, "judging_only": [n % 2 == 1 for n in range(n)], "dual_lower": np.nan}
    found = {"scene": "rod", "seed": range(n), "method": "fft", **ends, **flags, "dual_upper": np.nan, **more}
    both = pd.concat([pd.DataFrame(right), pd.DataFrame(found)], ignore_index=True)
    return both.assign(status="ok", reached=both["reached"] if "reached" in both else np.nan)


def test_an_interval_holds_what_it_has_in_common_with_what_is_true():
    each = means.answers(frame(off=[0.1, -0.1, 0.1, -0.1], half=[0.11, 0.11, 0.09, 0.09], doubt=0.01))
    assert means.held(each).tolist() == [True] * 2 + [False] * 2
    each = means.answers(frame(off=[0.1, -0.1], half=[0.098, 0.098], doubt=0.01))
    # Within the doubt of what is true, and not beyond.
    assert means.held(each).all() and not means.strictly(each).any()


def test_rows_without_a_dual_are_judged_as_well():
    few = frame(off=[0.1, 0.1], half=[0.11, 0.09])
    for each in (means.answers(few), means.answers(few.drop(columns=["dual_lower", "dual_upper"]))):
        assert means.strictly(each).tolist() == [True, False]


def test_errors_are_judged_where_they_are_known_well():
    each = means.answers(frame(off=[0.1, 0.001, 0.0], half=[0.3, 0.1, 0.1], doubt=0.01))
    assert_allclose(means.over(each), [3.0])


def test_a_dual_tells_where_nothing_else_does():
    df = frame(off=[0.0, 0.0], half=[0.1, 0.1], dual_lower=[2.1, 2.3], dual_upper=[2.3, 2.5])
    df.loc[df["method"] == "truth", ["true_lower", "true_upper"]] = np.nan
    each = means.answers(df)
    assert means.held(each).tolist() == [True, False] and means.over(each).empty


@pytest.mark.parametrize("kind", scenes.KINDS)
def test_what_is_drawn_is_drawn_again(kind):
    """Conductivities that are known lie between Wiener's bounds."""
    scene, known, dual = scenes.scene_of(kind, 0)
    again = scenes.scene_of(kind, 0).scene
    assert scene.size == again.size and np.array_equal(scene.conductivities, again.conductivities)
    assert (known is None) == (dual is not None)
    if known is not None and kind not in ("bodies", "polydisperse"):
        found, k = known(), scene.conductivities
        assert k.min() <= found.upper and found.lower <= k.max() and found.lower <= found.upper
        assert value_error(found.upper, found.lower) < 1e-3


def test_parts_that_are_not_seen_are_told():
    """Specks smaller than a voxel."""
    found = [rows.judged("speck", seed, "fft") for seed in range(4)]
    assert any(each["unseen"] and each["reached"] for each in found)
    assert not rows.judged("fibre", 1, "fft")["unseen"]


def test_half_of_the_scenes_are_for_judging_only():
    seeds = {case["seed"] for case in intervals.CASES}
    assert sum(intervals.run("layers", seed, "truth")["judging_only"] for seed in seeds) == len(seeds) / 2
    assert len({(case["scene"], case["seed"]) for case in intervals.CASES}) >= 400
