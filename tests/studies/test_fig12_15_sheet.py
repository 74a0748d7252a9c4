"""The sheet's source ends where the papers' does; packings are held against bricks at the time of the largest error."""

import numpy as np
import pandas as pd
from numpy.testing import assert_allclose

from studies import fig12_15_sheet as study
from studies.common import terreros
from studies.fig12_15_sheet import STOP
from studies.harness.cells import cell


def test_the_source_stays_inside_and_reaches_the_edge():
    scene = terreros.sheet()
    source = scene.sources[0]
    # Terreros et al. 2013: the rim is at the far edge, x = 50 mm, when the axis is 4 mm before it.
    last = (terreros.SHEET[0] - terreros.START[0] - source.diameter / 2) / terreros.SPEED
    assert_allclose(source.position(last), [46e-3, 15e-3], rtol=1e-12)
    # The study stops within a millisecond before.
    assert 0 < last - STOP < 1e-3
    for point in terreros.POINTS.values():
        assert all(0 < x < side for x, side in zip(point, scene.size, strict=True))


def test_packings_are_held_against_bricks():
    """Three packings whose mean is 100, 200, ... C at every output, bricks a tenth warmer at the second one only."""
    mean = 100.0 * np.arange(1, study.OUTPUTS + 1)
    bricks = mean.copy()
    bricks[1] *= 1.1
    law = {"law": "laguerre", "particles": 1_000, "method": "dem", "status": "ok"}
    rows = [law | {name: cell(curve) for name in study.NAMES} for curve in (0.9 * mean, mean, 1.1 * mean)]
    rows.append({"law": "hexahedra", "size": study.ELEMENT, "status": "ok"} | {n: cell(bricks) for n in study.NAMES})
    found = study.compared(pd.DataFrame(rows), "laguerre", 1_000, "B")
    assert found["at"] == study.TIMES[1] and found["end"] == 0.0
    assert_allclose([found["off"], found["span"]], [10.0, 100 * 20 / mean[-1]], rtol=1e-12)
    assert_allclose(found["dispersion"], 100 * 0.2 / 1.1, rtol=1e-5)  # six digits are kept
