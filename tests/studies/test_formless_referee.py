"""What walkers say as a referee in study `formless`, on rows made up by hand."""

import numpy as np
import pandas as pd
import pytest

from studies.formless import scenes, walked


def row(name, part, contrast, fraction, **values):
    empty = {"size": float("nan"), "k_ratio": float("nan"), "walked_ratio": float("nan")}
    empty |= {"walked_half_percent": float("nan"), "lower_ratio": 0.0, "upper_ratio": 1e3}
    return empty | {"name": name, "part": part, "contrast": contrast, "fraction": fraction} | values


def frame(*rows):
    return pd.DataFrame(rows)


WALKERS = row("walkers", "gyroid", 0.01, 0.3, walked_ratio=0.5, walked_half_percent=1.0)


def test_a_good_labyrinth_is_judged_by_the_bad_one_beside_it():
    df = frame(WALKERS)
    assert walked.witness(df, "gyroid", 0.01, 0.3) == (0.5, 1.0)
    assert walked.witness(df, "gyroid", 100.0, 0.7) == (50.0, 1.0)
    for part, contrast, fraction in (("gyroid", 100.0, 0.3), ("gyroid", 0.0, 0.3), ("diamond", 0.01, 0.3)):
        assert walked.witness(df, part, contrast, fraction) is None
    # Other parts are not like what is left of them.
    other = frame(row("walkers", "random field", 0.01, 0.3, walked_ratio=0.5, walked_half_percent=1.0))
    assert walked.witness(other, "random field", 100.0, 0.7) is None


def test_a_scene_without_a_fraction():
    df = frame(row("walkers", "knot", 0.01, float("nan"), walked_ratio=0.9, walked_half_percent=0.5))
    assert walked.witness(df, "knot", 0.01, float("nan")) == (0.9, 0.5)
    assert walked.witness(df, "knot", 100.0, float("nan")) is None


def test_the_finest_elements_and_all_others_are_judged():
    df = frame(
        WALKERS,
        row("fem", "gyroid", 0.01, 0.3, size=0.1, k_ratio=0.6),
        row("fem", "gyroid", 0.01, 0.3, size=0.05, k_ratio=0.504),
        row("dem", "gyroid", 0.01, 0.3, k_ratio=0.492),
        row("fft", "gyroid", 100.0, 0.7, k_ratio=48.5),
        row("fem", "diamond", 0.01, 0.3, size=0.05, k_ratio=0.5),
    )
    judged = walked.judged(df)
    # By hand, % of the walkers' value; a half of their interval is 1 %.
    assert judged["off_percent"].tolist() == pytest.approx([0.8, -1.6, -3.0])
    assert walked.outside(judged)["name"].tolist() == ["dem", "fft"]
    assert walked.wrong(judged)["name"].tolist() == ["fft"]
    assert walked.words(df).endswith(
        "of FEM they hold 1 of 1; of DEM they hold 0 of 1 (others are 1.6 % off); of FFT they hold 0 of 1 (others are "
        "3 % off)"
    )


def test_a_value_that_is_none_is_outside():
    judged = walked.judged(frame(WALKERS, row("dem", "gyroid", 0.01, 0.3)))
    assert len(walked.outside(judged)) == len(walked.wrong(judged)) == 1


def test_how_far_beyond_its_bounds_a_value_is():
    bracket = row("bracket", "checkerboard", 10.0, float("nan"), lower_ratio=4.0, upper_ratio=5.0)
    for k, percent in ((4.5, 0.0), (5.5, 10.0), (3.0, 25.0)):
        own = row("fem-p1", "checkerboard", 10.0, float("nan"), k_ratio=k)
        assert walked.beyond(frame(bracket, own), own) == pytest.approx(percent)
        # Without it those of its fractions hold.
        assert walked.beyond(frame(own), own) == 0.0
    assert np.isnan(walked.beyond(frame(bracket), own | {"k_ratio": float("nan")}))


@pytest.mark.slow
def test_the_round_knot_is_as_large_as_that_of_triangles():
    ours, theirs = (made("knot", 2.0, None).inclusions[0].volume for made in (scenes.walked, scenes.made))
    # Cells that the surface cuts count by planes; a tube with facets is shorter on the inside of bends.
    assert ours == pytest.approx(theirs, rel=0.005)
