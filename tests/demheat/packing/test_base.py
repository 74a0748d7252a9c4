"""Only here: a packing whose radii part from their centres, or that lies in memory as no neighbours do."""

import numpy as np
from numpy.testing import assert_allclose

from demheat.packing.base import make_packing, wrap
from demheat.scene.shapes.morton import morton_order


def some(number=50, seed=0):
    rng = np.random.default_rng(seed)
    return rng.random((number, 3)) * (1.0, 2.0, 3.0), rng.uniform(0.01, 0.05, number)


def test_arrays_keep_together_and_are_copies():
    centers, radii = some()
    packing = make_packing(centers, radii, (1, 2, 3), (True, False, True), {"algorithm": "test"})
    assert packing.number == 50 and packing.periodic.tolist() == [True, False, True]
    before = {(*x, r) for x, r in zip(centers.tolist(), radii.tolist(), strict=True)}
    after = {(*x, r) for x, r in zip(packing.centers.tolist(), packing.radii.tolist(), strict=True)}
    assert before == after
    centers[:] = 0.5
    assert packing.centers.std() > 0


def test_neighbours_in_memory_are_neighbours_in_space():
    centers = np.random.default_rng(1).random((4096, 3))
    steps = np.diff(centers[morton_order(centers, np.ones(3))], axis=0)
    # A Morton curve steps about one spacing (1/16) most of the time; random order steps 0.66.
    assert np.median(np.linalg.norm(steps, axis=1)) < 2 / 16


def test_wrap():
    size, periodic = np.array([1.0, 2.0, 3.0]), np.array([True, True, False])
    inside = wrap(np.array([[1.25, -0.5, -1.0], [1.0, -1e-20, 4.0]]), size, periodic)
    # Exact in binary; a tiny negative coordinate rounds to the far face, which is 0.
    assert inside.tolist() == [[0.25, 1.5, -1.0], [0.0, 0.0, 4.0]]


def test_phi_and_scaling():
    packing = make_packing([[0.5, 0.5, 0.5]], [0.5], (1, 1, 1), True, {})
    assert_allclose(packing.phi, np.pi / 6, rtol=1e-15)  # rounding
    small = packing.scaled(0.1)
    assert_allclose(small.phi, np.pi / 6, rtol=1e-14)  # rounding
    assert_allclose(small.centers, 0.05, rtol=1e-15)
