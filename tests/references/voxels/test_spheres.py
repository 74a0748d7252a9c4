"""Many balls at once are painted as one after the other, and no more voxels are looked at."""

import numpy as np
import pytest

from demheat.scene import Layer, Material, Scene, Sphere
from references.voxels import kernels, paint
from references.voxels.links import links
from references.voxels.spheres import Balls, Windows, groups, images, windows

SIZE, GOOD = (1.0, 1.3, 0.8), Material(7.0)


def spheres(count, largest=0.3, seed=0):
    """Balls anywhere in the box and a little beyond, numbered from 1; they may overlap."""
    rng = np.random.default_rng(seed)
    centers, radii = rng.uniform(-0.1, 1.1, (count, 3)) * SIZE, largest * rng.uniform(0.1, 1, count)
    return [(n, Sphere(tuple(c), r, GOOD)) for n, (c, r) in enumerate(zip(centers, radii, strict=True), start=1)]


def lattice(n):
    """Periodic cell with n^3 spheres a third of the distance between them in radius."""
    places = (np.stack(np.meshgrid(*[np.arange(n)] * 3, indexing="ij"), axis=-1).reshape(-1, 3) + 0.37) / n
    inclusions = [Sphere(tuple(c), 1 / (3 * n), GOOD) for c in places]
    return Scene((1.0, 1.0, 1.0), Material(1.0), inclusions, gradient=(1.0, 0.0, 0.0))


@pytest.mark.parametrize("periodic", [False, True])
def test_images_are_those_of_each_sphere(periodic):
    some = [*spheres(40), (41, Sphere((0.2, 0.3, 0.4), 0.2, GOOD)), (42, Sphere((9.0, 9.1, 9.2), 0.1, GOOD))]
    found = images(some, SIZE, periodic=periodic)
    one_by_one = [(n, image) for n, sphere in some for image in sphere.images(SIZE, periodic=periodic)]
    assert found.number.tolist() == [n for n, _ in one_by_one]
    assert np.array_equal(found.center, [image.center for _, image in one_by_one])
    assert np.array_equal(found.radius, [image.radius for _, image in one_by_one])


def test_groups_keep_the_painting_order():
    layer = Layer(0, 0.2, 0.3, GOOD)
    shapes = [*(s for _, s in spheres(3, 0.05)), layer, layer, Sphere((0.7, 0.7, 0.5), 0.1, GOOD)]
    found = list(groups(list(enumerate(shapes, start=1)), SIZE, periodic=False))
    assert [type(group) for group in found] == [Balls, tuple, tuple, Balls]
    assert found[1] == (4, layer) and found[2] == (5, layer)
    assert found[3].number.tolist() == [6]


@pytest.mark.parametrize("most", [50, 500, 10**9])
def test_windows_hold_each_voxel_of_a_sphere_once(most):
    shape, spacing = (10, 13, 8), np.full(3, 0.1)
    whole = images(spheres(20), SIZE, periodic=True)
    blocks = windows(whole, shape, spacing, most=most)
    # A block ends with the window that fills it; a window has `most` voxels, or a plane of one sphere's, 13 x 8.
    assert max(np.prod(b.high - b.low, axis=1).sum() for b in blocks) <= most + max(most, 13 * 8) or len(blocks) == 1
    parts = Windows(*(np.concatenate(column) for column in zip(*blocks, strict=True)))
    assert np.all(np.diff(parts.number) >= 0)
    counts = np.zeros((20, *shape), int)
    for number, low, high in zip(parts.number, parts.low, parts.high, strict=True):
        counts[(number - 1, *(slice(a, b) for a, b in zip(low, high, strict=True)))] += 1
    middles = (np.moveaxis(np.indices(shape), 0, -1) + 0.5) * spacing
    for number, center, radius in zip(*whole, strict=True):
        # The surface may cut voxels as far as half a diagonal from it; the window has them, too.
        inside = np.linalg.norm(middles - center, axis=-1) < radius + 0.05
        assert np.all(counts[number - 1][inside] >= 1)
    for number, sphere in spheres(20):
        images_of_it = len(sphere.images(SIZE, periodic=True))
        assert counts[number - 1].max() <= images_of_it
    assert sum(len(b.radius) for b in windows(whole, shape, spacing, whole=True, most=most)) == len(whole.radius)


@pytest.mark.twin
def test_paint_and_cut_spheres():
    shape, spacing = (10, 13, 8), np.full(3, 0.1)
    (block,) = windows(images(spheres(8), SIZE, periodic=True), shape, spacing)
    grid, expected = np.zeros(shape, np.uint16), np.zeros(shape, np.uint16)
    count, rows = kernels.paint_spheres(grid, block, spacing), []
    cuts = paint.Cuts(np.full(count, -1), np.empty(count), np.empty((count + 1, 6)), np.full(count, -1))
    n = kernels.cut_spheres(np.array(shape), block, spacing, cuts)
    for number, center, radius, low, high in zip(*block, strict=True):
        one = kernels.paint_sphere(expected, number, center, radius, spacing, low, high)
        index, part, moment = np.empty(one, np.int64), np.empty(one), np.empty((one + 1, 6))
        found = kernels.cut_sphere(np.array(shape), center, radius, spacing, low, high, index, part, moment)
        rows += [(index[k], part[k], moment[k], number) for k in range(found)]
    assert np.array_equal(grid, expected)
    assert n == len(rows) and np.all(cuts.phase[n:] == -1)
    for column, slow in zip(cuts, zip(*rows, strict=True), strict=True):
        assert np.array_equal(column[:n], slow)


@pytest.mark.twin
def test_cut_links_by_spheres():
    spacing, rng = np.array([0.1, 0.1, 0.1]), np.random.default_rng(0)
    fast = rng.random((10, 13, 9))
    slow, change = fast.copy(), rng.random(6)
    some = images(spheres(6), SIZE, periodic=False)
    kernels.cut_links_by_spheres(fast, change[some.number - 1], some.center, some.radius, spacing)
    for number, center, radius in zip(*some, strict=True):
        kernels.cut_links(slow, change[number - 1], center, radius, spacing)
    assert np.array_equal(fast, slow)


def test_large_spheres_in_pieces_change_nothing(monkeypatch):
    inclusions = [Sphere((0.5, 0.1, 0.4), 0.35, GOOD), Sphere((0.5, 0.1, 0.4), 0.2, Material(0.3))]
    scene = Scene(SIZE, Material(1.0), inclusions, gradient=(1.0, 0.0, 0.0))
    whole = paint.voxelise(scene, (20, 21, 22), laminate=True), links(scene, (20, 21, 22))
    small = windows.__kwdefaults__ | {"most": 300}
    monkeypatch.setattr(windows, "__kwdefaults__", small)
    pieces = paint.voxelise(scene, (20, 21, 22), laminate=True), links(scene, (20, 21, 22))
    for one, other in zip((*whole[0], *whole[1]), (*pieces[0], *pieces[1]), strict=True):
        assert np.array_equal(one, other)


def test_voxels_looked_at_do_not_grow_with_the_number_of_spheres():
    """Of a fixed part of the volume: beside the spheres themselves a shell of two voxels, which does grow."""
    shape, spacing = (64, 64, 64), np.full(3, 1 / 64)
    for n in (2, 4, 8):
        scene = lattice(n)
        (found,) = groups(list(enumerate(scene.inclusions, start=1)), scene.size, periodic=True)
        looked_at = sum(np.prod(b.high - b.low, axis=1).sum() for b in windows(found, shape, spacing))
        across = 2 * 64 / (3 * n)
        # Cubes around the spheres, and up to two voxels more on each side; those of images overlap at the faces.
        assert looked_at <= n**3 * (across + 4) ** 3 * (1 + 2 / n)
