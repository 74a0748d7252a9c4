"""Study `shapes`: its scenes, and intervals and distances from rows that are known."""

import math

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

import studies.shapes as study
from demheat.scene.volumes import fractions
from references import exact
from studies.shapes import cases, scenes, tables


@pytest.mark.parametrize(
    ("scene", "share"),
    [
        (scenes.fibre(10.0, 0.6), 0.6),
        (scenes.diagonal(4.0), 0.5),
        (scenes.ball("sphere", 10.0, 0.2), 0.2),
        (scenes.ball("level set", 10.0, 0.2), 0.2),
        (scenes.ellipsoid(10.0, 0.002), 0.002),
        (scenes.rod(10.0), math.pi * 0.2**2 * 0.5),
    ],
)
def test_scenes_hold_as_much_as_they_say(scene, share):
    # Rounding; a level set's volume is right to some 1e-4, as it says.
    assert_allclose(fractions(scene)[1], share, rtol=1e-4)


def test_square_rods_are_half_as_wide_as_the_cell():
    scene = scenes.square_rod(10.0)
    # Their sides lie between points.
    points = scene.size * (np.indices((8, 8, 3)).reshape(3, -1).T + 0.5) / (8, 8, 3)
    assert np.mean(scene.phase_at(points)) == 0.25


def test_a_neutral_fibre_is_one():
    """A uniform field has no part of degree 3 or more: without a dipole nothing else is roused."""
    k = scenes.fibre(10.0, 0.3).matrix.conductivity
    assert_allclose(exact.solve(scenes.fibre(10.0, 0.3, kapitza=0.9)).conductivity, k, rtol=1e-12)
    assert exact.solve(scenes.fibre(10.0, 0.3)).conductivity / k > 1.6


def rods(**values):
    size = {"fem": [0.0125, 0.00625], "dem": [np.nan] * 2}
    number = {"fem": [np.nan] * 2, "dem": [3000.0, 30_000.0]}
    frames = [
        pd.DataFrame({"name": name, "size": size[name], "particles": number[name], "k_ratio": k})
        for name, k in values.items()
    ]
    df = pd.concat(frames, ignore_index=True).assign(part="capped rod", error_percent=np.nan, seed=0)
    return df.assign(lower_ratio=df["k_ratio"] - 0.01, upper_ratio=df["k_ratio"] + 0.02)


def test_rods_are_held_against_the_finest_elements():
    df = tables.compared(rods(fem=[1.1, 1.25], dem=[1.5, 1.0]))
    assert_allclose(df["error_percent"], [-12.0, np.nan, 20.0, -20.0], rtol=1e-12)
    without = rods(dem=[1.5, 1.0])
    assert tables.compared(without) is without


def test_intervals_share_something_or_not():
    found = list(study._intervals(rods(fem=[1.1, 1.25], dem=[1.265, 1.3])))
    # Of 1.24 to 1.27, the finest elements': 1.255 to 1.285, 1.29 to 1.32, 1.09 to 1.12.
    shared = {sentence.split(":")[0]: value for sentence, value, _ in found}
    assert_allclose(list(shared.values()), [1.5, -2.0, -12.0], rtol=1e-9)
    unknown = list(study._intervals(rods(fem=[1.1, 1.25]).assign(upper_ratio=np.nan)))
    assert len(unknown) == 1 and all(math.isnan(value) for _, value, _ in unknown)


def test_each_method_takes_what_its_cases_ask():
    asked = {(case["part"], case["name"]) for case in study.CASES}
    # FEM has no sizes for level sets, voxels no resistances: refusals stand in tests of the methods.
    assert {("level set", "fem"), ("neutral fibre", "fft")}.isdisjoint(asked)
    assert {part for part, _ in asked} == {"fibres", *cases.PARTS}
