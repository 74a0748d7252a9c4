"""Only here: the witness of two grains that meet in a disc off a cylinder, or off the limit of small discs."""

import numpy as np
from numpy.testing import assert_allclose

from studies.grains import cell


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
