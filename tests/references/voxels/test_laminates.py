"""Tensors of cut voxels between tensors: one gradient along, one flux across."""

import numpy as np
from numpy.testing import assert_allclose

from demheat import Layer, Material, Scene, Sphere, orthotropic
from references.voxels.cut import laminate_tensors
from references.voxels.laminates import cut_tensors, laminated, packed, unpacked, with_own
from references.voxels.paint import turned, voxelise

ONE, OTHER = (
    np.array(orthotropic(*k, rotation=r)) for k, r in (((1, 4, 9), (0.3, -0.5, 0.8)), ((3, 1, 0.2), (1, 0, 2)))
)
NORMAL = np.array([2.0, -1.0, 2.0]) / 3


def test_entries_are_put_back():
    entries = packed(ONE)
    assert entries.tolist() == [ONE[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))]
    assert_allclose(unpacked(entries), ONE)


def test_a_laminate_has_one_gradient_along_and_one_flux_across():
    part = np.array([0.3, 0.7])
    (found,) = laminated(np.zeros(2, int), part, np.stack([ONE, OTHER]), NORMAL[None])
    assert_allclose(found, found.T, atol=1e-14)
    gradient = np.array([1.0, 2.0, -0.5])
    # Jumps of the gradient along the normal alone, so that the flux across does not jump and the mean is the gradient.
    jump = -(NORMAL @ (ONE - OTHER) @ gradient) / (NORMAL @ (part[1] * ONE + part[0] * OTHER) @ NORMAL)
    in_one, in_other = gradient + part[1] * jump * NORMAL, gradient - part[0] * jump * NORMAL
    assert_allclose(NORMAL @ ONE @ in_one, NORMAL @ OTHER @ in_other, rtol=1e-13)
    assert_allclose(found @ gradient, part[0] * ONE @ in_one + part[1] * OTHER @ in_other, rtol=1e-13)


def test_of_numbers_it_is_the_formula_for_numbers():
    rng = np.random.default_rng(1)
    conductivity, voxel = np.array([0.0, 1.0, 7.0]), np.repeat(np.arange(5), 3)
    fraction = rng.dirichlet(np.ones(3), 5)
    fraction[0] = [0.0, 0.4, 0.6]
    part = voxel, np.tile(np.arange(3), 5), fraction.ravel()
    spread = rng.random((5, 3, 3))
    moment = packed(spread @ spread.transpose(0, 2, 1))
    tensors = conductivity[:, None, None] * np.eye(3)
    assert_allclose(cut_tensors(part, tensors, moment), laminate_tensors(part, conductivity, moment), atol=1e-13)


def test_voxels_of_a_tensor_have_their_own():
    scene = Scene(
        (1, 1, 1),
        Material(2.0),
        [Sphere((0.5,) * 3, 0.3, Material(ONE)), Layer(2, 0.0, 0.07, Material(5.0))],
        walls={"x-": 0},
    )
    grid = voxelise(scene, (6, 5, 7), laminate=True)
    own = with_own(grid)
    inside = np.flatnonzero(grid.phase.ravel() == 1)
    assert set(own.cut) == set(grid.cut) | set(inside) and np.all(np.diff(own.cut) > 0)
    whole = np.isin(own.cut, np.setdiff1d(inside, grid.cut))
    assert whole.any() and np.all(own.tensor[whole] == packed(ONE))
    assert np.all(own.tensor[np.isin(own.cut, grid.cut)] == grid.tensor)
    # A tensor's mean says nothing of it; the others stay.
    assert grid.conductivity.tolist() == [2.0, np.trace(ONE) / 3, 5.0]


def test_turned_voxels_have_turned_tensors():
    scene = Scene((1, 1, 1), Material(2.0), [Sphere((0.4, 0.5, 0.6), 0.3, Material(ONE))], walls={"x-": 0})
    order = (2, 0, 1)
    grid = voxelise(scene, (5, 6, 7), laminate=True)
    assert_allclose(unpacked(turned(grid, order).tensors)[1], ONE[np.ix_(order, order)])
