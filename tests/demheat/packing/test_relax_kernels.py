"""Only here: forces of the relaxation that are no slope of an energy, beside sums over all pairs."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from demheat.packing import relax_kernels as kernels

pytestmark = pytest.mark.twin
DOMAINS = [(0, 0, 0), (0, 1, 1), (1, 1, 1)]


def some_spheres(across, number=40, seed=0):
    """Overlapping spheres, some of them held, and their domain, across which the second axis of a box is periodic."""
    rng, across = np.random.default_rng(seed), np.array(across, dtype=float)
    size = np.full(3, 5.0) if across.any() else np.array([4.0, 5.0, 6.0])
    points = np.column_stack((rng.random((number, 3)) * size, rng.uniform(0.3, 1.0, number)))
    mobility = np.where(np.arange(number) < 5, 0.0, rng.uniform(0.5, 2.0, number))
    spheres = kernels.Spheres(points, rng.standard_normal((number, 3)), mobility)
    return spheres, kernels.Box(size, size * (0, 1, 0) * (1 - across), across)


def all_pairs(number):
    return np.arange(0, number * number, number - 1)[: number + 1], np.nonzero(1 - np.eye(number))[1].astype(np.uint32)


def overlaps(points, box):
    """Overlap of all pairs, (n, n), and the direction in which each pushes the first, (n, n, 3)."""
    offsets = points[:, None, :3] - points[None, :, :3]
    offsets -= np.where(box.period > 0, box.period * np.rint(offsets / np.where(box.period > 0, box.period, 1.0)), 0.0)
    distance = np.linalg.norm(offsets, axis=2) + np.eye(len(points))
    pairs = np.maximum(points[:, 3] + points[:, None, 3] - distance, 0.0) * (1 - np.eye(len(points)))
    return pairs, offsets / distance[..., None]


def wall_overlaps(points, box):
    """Overlap with each wall, (n, walls), and the direction in which it pushes, (n, walls, 3)."""
    x, r, found, pushed = points[:, :3], points[:, 3], [], []
    for axis in np.flatnonzero((box.period == 0) & (box.across == 0)):
        for sign, depth in ((1.0, x[:, axis]), (-1.0, box.size[axis] - x[:, axis])):
            found.append(r - depth)
            pushed.append(np.broadcast_to(sign * np.eye(3)[axis], x.shape))
    if box.across.any():
        off = (x - box.size / 2) * box.across
        away = np.linalg.norm(off, axis=1)
        found.append(away + r - box.size[box.across > 0][0] / 2)
        pushed.append(-off / away[:, None])
    return np.maximum(np.stack(found, axis=1), 0.0), np.stack(pushed, axis=1)


@pytest.mark.parametrize("across", DOMAINS)
def test_forces(across):
    spheres, box = some_spheres(across)
    force, sums = np.empty((40, 3)), np.empty((1, kernels.SUMS))
    kernels.forces(spheres, *all_pairs(40), box, force, sums)
    (pairs, apart), (walls, inward) = overlaps(spheres.points, box), wall_overlaps(spheres.points, box)
    expected = np.einsum("ij,ijk->ik", pairs, apart) + np.einsum("ij,ijk->ik", walls, inward)
    # Rounding, and the order of summation: forces are of order 1.
    assert_allclose(force, expected * spheres.mobility[:, None], atol=1e-13)
    mobility, free = spheres.mobility[:, None], spheres.mobility > 0
    work = [
        np.sum((expected * spheres.velocity)[free]),
        np.sum((mobility * expected**2)[free]),
        np.sum(spheres.velocity[free] ** 2 / mobility[free]),
        # A wall's overlap counts from both sides, as a pair's does.
        pairs.sum() + 2 * walls.sum(),
        np.count_nonzero(pairs) + 2 * np.count_nonzero(walls),
        max(pairs.max(), walls.max()),
    ]
    assert_allclose(sums[0], work, rtol=1e-12)
    assert np.count_nonzero(walls) > 5 < np.count_nonzero(pairs)


def test_sums_are_by_chunk_and_twins_part():
    """Pairs of spheres far from all others; one pair at one place is pushed along x, each its way."""
    number = 2 * kernels.CHUNK
    points = np.full((number, 4), 0.5)
    points[:, 0], points[1::2, 0] = 4.0 * np.repeat(np.arange(number // 2), 2), 4.0 * np.arange(number // 2) + 0.75
    points[1, 0] = points[0, 0]
    spheres = kernels.Spheres(points, np.zeros((number, 3)), np.ones(number))
    box = kernels.Box(np.full(3, 1e4), np.full(3, 1e4), np.zeros(3))
    rows = np.arange(number + 1), (np.arange(number) ^ 1).astype(np.uint32)
    force, sums = np.empty((number, 3)), np.empty((2, kernels.SUMS))
    kernels.forces(spheres, *rows, box, force, sums)
    assert_allclose(force[2:, 0], np.tile([-0.25, 0.25], number // 2 - 1), rtol=1e-9)  # coordinates up to 1e3
    # Overlap of all but 1e-6 of the two radii.
    assert_allclose(force[:2, 0], [-1.0, 1.0], rtol=1e-5)
    assert_array_equal(sums[:, kernels.COUNT], kernels.CHUNK)
    assert_allclose(sums[:, kernels.WORST], [1.0, 0.25], rtol=1e-5)
    assert_allclose(sums[:, kernels.OVERLAP], [0.25 * (kernels.CHUNK - 2) + 2.0, 0.25 * kernels.CHUNK], rtol=1e-5)


@pytest.mark.parametrize("across", DOMAINS)
def test_forces_are_the_slope_of_the_energy(across):
    spheres, box = some_spheres(across)
    force, sums = np.empty((40, 3)), np.empty((1, kernels.SUMS))
    kernels.forces(spheres, *all_pairs(40), box, force, sums)

    def energy(points):
        """Half the squared overlaps of all pairs and walls."""
        return np.sum(overlaps(points, box)[0] ** 2) / 4 + np.sum(wall_overlaps(points, box)[0] ** 2) / 2

    h, slope = 1e-6, np.empty((40, 3))
    for i, axis in np.ndindex(40, 3):
        up, down = spheres.points.copy(), spheres.points.copy()
        up[i, axis] += h
        down[i, axis] -= h
        slope[i, axis] = (energy(up) - energy(down)) / (2 * h)
    # Central differences of an energy of about 10: rounding 1e-15 * 10 / h.
    assert_allclose(force, -slope * spheres.mobility[:, None], atol=1e-7)


def test_move():
    rng, number = np.random.default_rng(1), 2 * kernels.CHUNK + 88
    points, velocity, force = rng.random((number, 4)), rng.random((number, 3)), rng.random((number, 3))
    start, expected = points[:, :3].copy(), 0.3 * velocity + 0.2 * force
    farthest, moved = np.empty(3), points.copy()
    spheres = kernels.Spheres(moved, velocity, np.ones(number))
    kernels.move(spheres, start, force, kernels.Step(0.3, 0.2, 0.5), farthest)
    assert_allclose(velocity, expected, rtol=1e-14)
    assert_allclose(moved[:, :3], start + 0.5 * expected, rtol=1e-14)
    squares = ((0.5 * expected) ** 2).sum(axis=1)
    assert_allclose(farthest, np.maximum.reduceat(squares, [0, kernels.CHUNK, 2 * kernels.CHUNK]), rtol=1e-12)
    assert_array_equal(moved[:, 3], points[:, 3])
