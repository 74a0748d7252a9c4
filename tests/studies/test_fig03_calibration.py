"""Only here: C_t of a crystal off what it must be, under each of the loads."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat.packing.base import make_packing
from demheat.packing.neighbours import contacts
from studies.fig03_calibration.rows import calibrated

EDGE = 12  # spheres along each side: walls leave bulk between layers of 6 radii


def simple_cubic(periodic):
    x = np.stack(np.meshgrid(*[np.arange(EDGE) + 0.5] * 3, indexing="ij"), -1).reshape(-1, 3) / EDGE
    return make_packing(x, np.full(len(x), 0.5 / EDGE), (1, 1, 1), periodic, {})


@pytest.mark.parametrize("loading", ["flux", "isothermal", "across", "periodic"])
def test_simple_cubic_crystal(loading):
    """S = pi R^2 over d = 2 R and area (2 R)^2 make the conductivity pi/4, where the linear field is the true one."""
    crystal = simple_cubic({"periodic": True, "across": (True, False, True)}.get(loading, False))
    # All contacts of the crystal, none of its diagonal pairs; at walls there are fewer than 6.
    wanted = np.diff(contacts(crystal, gap=0.1)[0]).mean()
    row = calibrated(crystal, loading, wanted=wanted, margin=0.0)
    as_papers = loading in ("flux", "isothermal")
    # The papers' centres at wall temperature leave a length of 1 - 2 R; to 1e-4 of a radius at each end.
    length = 1 - 1 / EDGE if as_papers else 1.0
    assert_allclose(row["ct"], 4 / np.pi * length, rtol=3e-5 if as_papers else 1e-7)
    if loading == "periodic":
        assert_allclose([row["bound"], row["formula"]], 4 / np.pi, rtol=1e-12)  # rounding
