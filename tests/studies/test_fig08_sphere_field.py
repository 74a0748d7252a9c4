"""The study of the sphere's field: pictures of both sizes, and which are drawn."""

import numpy as np
import pandas as pd

from studies import fig08_sphere_field as study
from studies.common.sphere_in_time import slice_grid
from studies.harness.cells import cell


def picture(side, value):
    points, _ = slice_grid(side)
    return cell(np.full(len(points), value))


def test_a_picture_knows_its_side():
    for row in ({"slice_error": picture(41, 2.0)}, {"slice_error": picture(11, 2.0), "slice_side": 11.0}):
        plane = study._plane(row)
        side = int(row.get("slice_side", 41))
        # A circle fills pi / 4 of its square.
        assert plane.shape == (side, side) and abs(np.isfinite(plane).mean() - np.pi / 4) < 0.05
        assert np.nanmin(plane) == np.nanmax(plane) == 2.0


def test_both_sizes_of_the_papers_network_are_drawn():
    rows = [
        {"law": law, "method": "dem", "particles": number, "unknowns": number, "slice_error": picture(11, 0.0)}
        for law in ("calibrated", "laguerre")
        for number in (1_000, 100_000, 1_000_000)
    ]
    rows.append({"order": 2, "method": "fem", "unknowns": 5, "slice_error": picture(11, 0.0)})
    found = [(row.get("law"), row.get("particles")) for row in study._shown(pd.DataFrame(rows))]
    assert found[:3] == [("calibrated", 1e5), ("calibrated", 1e6), ("laguerre", 1e6)] and len(found) == 4
    assert {"law": "calibrated", "particles": 100_000, "seed": 0, "method": "dem"} in study.CASES


def test_large_rows_have_the_finer_picture():
    assert study._side(particles=100_000) == study._side(order=2, size=0.00276) == study.SIDE
    assert study._side(particles=3_000, seed=0) == study._side(order=1, size=0.008) == study.COARSE
