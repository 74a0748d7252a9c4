"""The study `packings`: what it measures of a packing, on packings known by heart."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat.packing.base import make_packing
from studies.packings import rows as packers


def cubic(side=6, radius=0.5):
    """Simple cubic array of spheres, periodic, contacts at radius 0.5 (unit cells)."""
    grid = np.stack(np.meshgrid(*[np.arange(side) + 0.5] * 3, indexing="ij"), -1).reshape(-1, 3)
    return make_packing(grid, np.full(side**3, radius), (side,) * 3, True, {})


def test_overlap():
    # Touching, apart, and overlapping by 0.02 of which the diameter is 1.02; rounding of coordinates up to 6.
    assert_allclose(packers.overlap(cubic()), 0.0, atol=1e-15)
    assert packers.overlap(cubic(radius=0.4)) == 0.0
    assert_allclose(packers.overlap(cubic(radius=0.51)), 0.02 / 1.02, rtol=1e-12)


@pytest.mark.parametrize("domain", ["box", "cylinder-x", "sphere"])
def test_overlap_with_walls(domain):
    # A sphere of radius 0.3 whose centre is 0.1 from the wall, and one far away.
    centers = [[1.0, 1.9, 1.0], [1.0, 0.8, 1.0]]
    packing = make_packing(centers, [0.3, 0.3], (2, 2, 2), False, {}, domain=domain)
    assert_allclose(packers.overlap(packing), 0.2 / 0.6, rtol=1e-12)  # rounding


def test_neighbours_within_a_gap():
    z = packers._z_of_gap(cubic(radius=0.495))
    # Six at a distance of 1 / 0.99 contacts: a gap of 0.0101.
    assert z[packers.GAPS < 0.0101].max() == 0 and set(z[packers.GAPS > 0.0102]) == {6.0}
