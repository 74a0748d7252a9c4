"""Intervals of the FFT beside edges that lie in voxels, where coarser grids may err as much by chance."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import Box, Cylinder, Material, Scene, Sphere
from demheat.error import of_conductivity_alone
from demheat.scene.edges import edge_order
from references import fft
from references.fft.edges import hidden

MATRIX, GOOD = Material(1.0), Material(10.0)
# Of a cube of .4 in the middle of a cell: voxels on its faces, 20 to 100 of them along an edge.
RIGHT = 1.16877


def cell(*shapes):
    return Scene((1, 1, 1), MATRIX, shapes, gradient=(0.0, 1.0, 0.0))


def test_what_edges_hide_is_nothing_on_faces_of_voxels_and_most_half_way_between():
    cube = cell(Box((0.5, 0.5, 0.5), (0.4, 0.4, 0.4), GOOD))
    # Points around edges stand off them by a millionth of a side, on this side and that.
    assert_allclose(hidden(cube, (40, 20, 30)), 0.0, atol=1e-9)
    # .3 of an edge is 7.5 voxels.
    order = edge_order(cube)
    assert_allclose(hidden(cube, (25, 25, 25)), (0.04 / 0.4) ** order)
    # Of twelve edges eight lie half way along one of the two ways across them.
    assert_allclose(hidden(cube, (25, 40, 40)), (0.04 / 0.4) ** order / 3, rtol=1e-6)
    # .4 and .2 of a voxel beyond its face.
    assert_allclose(hidden(cube, (48, 48, 48)) / hidden(cube, (24, 24, 24)), 0.5**order * 0.24 / 0.16)


@pytest.mark.parametrize(
    "shape",
    [Sphere((0.5, 0.5, 0.5), 0.3, GOOD), Cylinder((0.5, 0.5, 0.5), 0.3, (0, 0, 1), GOOD)],
    ids=["sphere", "fibre"],
)
def test_what_has_no_edges_hides_nothing(shape):
    assert np.array_equal(hidden(cell(shape), (25, 25, 25)), [0.0])


def test_a_cube_along_the_axes_is_within_its_interval_where_three_grids_err_alike():
    """An eighth of the cell between walls, with voxels as of 88, 62 and 44 along its edge: each is .0009 to .0011 off.

    Changes between them tell .0007 of that at most.
    """
    eighth = Scene((0.5,) * 3, MATRIX, [Box((0.5,) * 3, (0.4,) * 3, GOOD)], walls={"y-": 0.0, "y+": 1.0})
    with of_conductivity_alone():
        found = fft.solve(eighth, voxels=44, threads=1)
        error = found.error
    assert_allclose(error.runs, RIGHT + 0.00102, atol=0.00015)
    assert error.lower < RIGHT < error.upper
    # No wider than three times the error.
    assert error.upper - error.lower < 6 * abs(found.conductivity - RIGHT)
    # Of the flux as much; but for rounding.
    part = 0.5 * (error.upper - error.lower) / found.conductivity
    assert error.flux >= (1 - 1e-9) * part * np.linalg.norm(found.mean_flux)
