"""Voxels conduct nowhere more, and nowhere less, than they are told to; and no more than parts of a voxel off."""

import numpy as np
import pytest

from demheat import gallery
from demheat.scene import Layer, Material, Scene, Sphere
from references.bracket.voxels import painting

SHAPE = (6, 5, 7)


def scenes():
    core, coat = Material(20.0), Material(0.2)
    nested = [
        Layer(2, 0.05, 0.1231, Material(3.0)),
        Sphere((0.1, 0.4, 0.45), 0.25, coat),
        Sphere((0.12, 0.4, 0.43), 0.15, core),
        Sphere((0.6, 0.85, 0.7), 0.2, core),
    ]
    yield Scene((1.0, 1.2, 0.9), Material(1.0), nested, gradient=(1.0, 0.0, 0.0))
    # One voxel holds all of a sphere, others parts of several.
    small = [
        Sphere((0.25, 0.5, 0.5), 0.02, core),
        Sphere((0.6, 0.5, 0.5), 0.1, core),
        Sphere((0.8, 0.5, 0.5), 0.1, coat),
    ]
    yield Scene((1.0, 1.0, 1.0), Material(1.0), small, gradient=(1.0, 0.0, 0.0))


def table_of(values, axis, form):
    """Entries of a voxel's table by the midpoints of many parts of it."""
    count = values.shape[0]
    x = (np.arange(count) + 0.5) / count
    shapes = np.stack([(1 - x) ** 2, x * (1 - x), x**2], axis=1) / count
    if form == "along":
        return values.mean(axis=tuple(a for a in range(3) if a != axis)) @ shapes
    return shapes.T @ values.mean(axis=axis) @ shapes


@pytest.mark.parametrize("scene", list(scenes()), ids=["nested", "small"])
def test_bounds_of_voxels_hold(scene):
    spacing, fine = np.array(scene.size) / SHAPE, 16
    found = painting.painted(scene.conductivities, scene.images(), SHAPE, spacing)
    cut = np.argwhere(found.conducting.row >= 0)
    assert len(cut) > 10
    inner = np.stack(np.meshgrid(*[(np.arange(fine) + 0.5) / fine] * 3, indexing="ij"), axis=-1)
    for place in np.ndindex(SHAPE):
        points = ((inner + place) * spacing).reshape(-1, 3)
        values = scene.conductivities[scene.phase_at(points)].reshape((fine,) * 3)
        row = found.conducting.row[place]
        if row < 0:
            assert np.all(values == found.conducting.scalar[place])
            assert np.all(1 / values == found.resisting.scalar[place])
            continue
        for axis in range(3):
            for cells, property_, form in (
                (found.conducting, values, "across"),
                (found.resisting, 1 / values, "along"),
            ):
                true, told = table_of(property_, axis, form), cells.table[row, axis]
                # Shapes are positive: so are the differences, but for the midpoints of 16 parts, a 256th of the
                # largest value's 1/12 by the rule's error of products of shapes, and what of it is the surface's.
                assert np.all(told > true - 0.01 * property_.max())
                assert told.sum() >= true.sum() - 0.002 * property_.max()


def test_a_voxel_is_told_little_too_much():
    """An eighth of a voxel is in doubt about a surface: half of that on average, on flat parts of it."""
    scene = gallery.simple_cubic(10.0, fraction=0.3)
    k, n = scene.conductivities, 12
    found = painting.painted(k, scene.images(), (n,) * 3, np.array(scene.size) / n)
    means = found.conducting.scalar.copy()
    weights = np.array([1.0, 2.0, 1.0])
    means[found.conducting.row >= 0] = np.einsum("mef,e,f->m", found.conducting.table[:, 0], weights, weights)
    surface, side = 4 * np.pi * (0.3 * 3 / (4 * np.pi)) ** (2 / 3), 1 / (n * painting.PARTS)
    true = 0.7 * k[0] + 0.3 * k[1]
    excess = (means.mean() - true) / ((k[1] - k[0]) * surface * side)
    # Of parts that a plane cuts, on average over its directions 1.5 layers; half of them in doubt are outside.
    assert 0.5 < excess < 1.0


def test_layers_on_the_grid_cut_nothing():
    scene = gallery.laminate()
    found = painting.painted(scene.conductivities, scene.images(), (8, 8, 8), np.array(scene.size) / 8)
    assert not len(found.conducting.table)
    # By a ten-thousandth of a voxel off, one plane of voxels for each of two faces of two layers.
    moved = [Layer(s.axis, s.start + 1e-5 * 0.1, s.stop - 1e-5 * 0.1, s.material) for s in scene.inclusions]
    moved = Scene(scene.size, scene.matrix, moved, walls=scene.walls)
    found = painting.painted(moved.conductivities, moved.images(), (8, 8, 8), np.array(scene.size) / 8)
    assert len(found.conducting.table) == 4 * 64


def test_mirror_images():
    sphere, layer = Sphere((0.1, 0.4, 0.9), 0.2, Material(2.0)), Layer(0, 0.5, 0.6, Material(3.0))
    found = painting.mirrored([(1, sphere), (2, layer)], (1.0, 1.0, 1.0), (True, False, True))
    centers = {each.center for phase, each in found if phase == 1}
    assert centers == {(0.1, 0.4, 0.9), (1.9, 0.4, 0.9), (0.1, 0.4, 1.1), (1.9, 0.4, 1.1)}
    assert [(each.start, each.stop) for phase, each in found if phase == 2] == [(0.5, 0.6), (1.4, 1.5)]
    assert [phase for phase, _ in found] == sorted(phase for phase, _ in found)
