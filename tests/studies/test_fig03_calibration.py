"""The calibration's helpers on a crystal whose C_t is known, and on packings."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import Calibrated, Material, Scene
from demheat.dem.networks import network_of
from demheat.packing.base import make_packing
from demheat.packing.neighbours import contacts
from studies.fig03_calibration.rows import affine, calibrated, packed

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


def test_links_of_those_that_are_left():
    packing = packed("periodic", "cube", "relaxed", 1_000, 0)
    every, rest = (calibrated(packing, "periodic", sparse="drop", count=count) for count in ("all", "rest"))
    # One pair more or less; without count what is left has more than the 7.5 links that all have on average.
    assert_allclose(rest["linked"], 7.5, atol=0.01)
    assert every["linked"] > 7.52 and every["links"] == pytest.approx(7.5, abs=2e-3)
    assert rest["left"] < 1_000


def test_affine_of_a_stretched_crystal():
    """Twice the spheres' distance along y doubles the length of those links: the bound follows the geometry."""
    crystal = simple_cubic(True)
    stretched = make_packing(crystal.centers * [1, 2, 1], crystal.radii, (1, 2, 1), True, {})
    scene = Scene(size=(1, 2, 1), matrix=Material(1.0), gradient=(0, 1, 0))
    network = network_of(scene, stretched, Calibrated(gap=1.01, sparse="keep", factor=1.0))
    rows = np.repeat(np.arange(stretched.number), np.diff(network.indptr))
    step = stretched.centers[network.indices] - stretched.centers[rows]
    step -= stretched.size * np.round(step / stretched.size)
    expected = 0.5 * (np.pi * (0.5 / EDGE) ** 2 / np.linalg.norm(step, axis=1)) @ step[:, 1] ** 2 / 2.0
    assert_allclose(affine(stretched, network)["bound"], 1 / expected, rtol=1e-12)
