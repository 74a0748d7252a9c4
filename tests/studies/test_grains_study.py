"""Study `grains`: the cell of two grains that meet in a disc, and beds that are what they are said to be."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from studies.grains import cell, rows


def test_a_cell_of_one_material():
    """Without contrast it is a cylinder, whatever its grid: k times area over length."""
    for contact in (0.1, 0.3):
        length = 2 * np.sqrt(1 - contact**2)
        # Elements that bend hold linear fields; where the surface is steep rounding leaves 6e-9.
        assert_allclose(cell.conductance(contact, 3.0, 3.0, lines=10), 3 * np.pi * 1.05**2 / length, rtol=1e-7)


def test_a_contact_narrows_lines_of_flow():
    """Small discs tend to 2 k a: a part of the radius of a disc is missing, times a number near one."""
    lost = [1 - cell.conductance(contact, 1.0) / (2 * contact) for contact in (0.01, 0.02, 0.04)]
    assert 0 < lost[0] < lost[1] < lost[2] < 1.2 * 0.04
    # Elements are too stiff: bounds from above, that fall with the grid.
    assert cell.conductance(0.1, 1.0, lines=20) > cell.conductance(0.1, 1.0, lines=40) > 0.1868


@pytest.mark.parametrize("contact", [0.05, 0.3])
def test_the_grid_is_fine_enough(contact):
    for medium in (0.0, 1e-3, 0.1):
        coarse, fine = (cell.conductance(contact, 1.0, medium, lines=lines) for lines in (40, 80))
        # Half of a per cent, far below what it is held against.
        assert_allclose(coarse, fine, rtol=5e-3)


@pytest.mark.parametrize("kind", rows.SITES)
def test_crystals_are_as_far_apart_as_is_said(kind):
    bed = rows.crystal(kind, 0.1)
    away = bed.centers[1:] - bed.centers[0]
    away -= bed.size * np.round(away / bed.size)
    assert_allclose(np.linalg.norm(away, axis=1).min(), 2.1, rtol=1e-12)
