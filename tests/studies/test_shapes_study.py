"""Study `shapes`: its scenes, and intervals and distances from rows that are known."""

import math

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from demheat.scene.volumes import fractions
from studies.shapes import scenes, tables


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
