"""Links between neighbouring voxel centres, cut exactly where they cross a surface: harmonic means along each link."""

import numpy as np

from demheat.runtime.progress import stage
from demheat.scene import Scene
from references.voxels import kernels
from references.voxels.paint import voxelise
from references.voxels.solids import inside_parts
from references.voxels.spheres import Balls, groups, windows

# A sphere's surface nearer to a node than this part of a link is taken this far away.  It moves the surface by 2e-4 of
# a voxel in the mean (k changes by less than 0.002 % at 32^3) and saves half of the iterations at contrast 1e4, two
# thirds at 1e6, which the few links of nearly no resistance cost.
NEAREST = 0.02


def links(scene: Scene, shape, *, phase=None) -> tuple:
    """Conductivity of every link, W/(m K).

    Link i of an axis joins voxels i - 1 and i.  The first and the last pass through a face of the box: one and the
    same link in a periodic cell; mirrored in an isothermal wall, so twice its inner half; 0 in an insulated one.
    """
    resistivity = 1.0 / scene.conductivities
    change = resistivity - resistivity[scene.parents()]
    if phase is None and _rounded(scene):
        phase = voxelise(scene, shape, laminate=False).phase
    # What has no end last: the order of addition decides how sums are rounded, nothing else.
    inclusions = sorted(enumerate(scene.inclusions, start=1), key=lambda pair: pair[1].flat)
    parts = list(groups(inclusions, scene.size, periodic=scene.periodic))
    found = []
    with stage("links") as done:
        for axis in range(3):
            found.append(_resistances(scene, shape, axis, resistivity))
            for group in parts:
                _cut_group(group, found[axis], axis, change, np.array(scene.size) / shape)
                done(axis / 3)
            _finish(scene, axis, found[axis], resistivity, phase)
    return tuple(found)


def _resistances(scene, shape, axis, resistivity):
    """Those of all links along one axis in the matrix alone, or in an image."""
    counts = np.array(shape)
    counts[axis] += 1
    if scene.image is not None:
        return _halves(resistivity[scene.image.phase_on(shape)], axis)
    resistance = np.full(counts, resistivity[0])
    # Half links at both ends, where a face of the box cuts them.
    np.moveaxis(resistance, axis, 2)[:, :, [0, -1]] *= 0.5
    return resistance


def _halves(resistivity, axis):
    """Half links of the voxels on either side, one after the other."""
    resistance = np.zeros([n + (a == axis) for a, n in enumerate(resistivity.shape)])
    view, half = np.moveaxis(resistance, axis, 0), 0.5 * np.moveaxis(resistivity, axis, 0)
    view[:-1] += half
    view[1:] += half
    return resistance


def _cut_group(group, resistance, axis, change, spacing):
    """Each inclusion replaces the resistivity it was painted on."""
    if isinstance(group, Balls):
        _cut_spheres(group, resistance, axis, change, spacing)
    else:
        number, shape = group
        cut = _cut_layer if shape.flat else _cut_shape
        cut(shape, resistance, axis, change[number], spacing)


def _finish(scene, axis, resistance, resistivity, phase):
    """Make resistances conductivities, in place: faces of the box, surfaces next to nodes."""
    view = np.moveaxis(resistance, axis, 2)
    if scene.periodic:
        view[:, :, 0] += view[:, :, -1]
        view[:, :, -1] = view[:, :, 0]
    else:
        view[:, :, [0, -1]] *= 2.0
    if _rounded(scene):
        kernels.keep_off(view, np.moveaxis(phase, axis, 2), NEAREST * resistivity, scene.periodic)
    # Next to a resistivity 1e16 times as large rounding leaves nothing of the least: half a link of it at both ends.
    np.maximum(resistance, resistivity.min() / 2, out=resistance)
    np.divide(1.0, resistance, out=resistance)
    if not scene.periodic and axis != scene.axis:
        view[:, :, [0, -1]] = 0.0


def _rounded(scene):
    """Whether there are surfaces other than planes across the box."""
    return any(not shape.flat for shape in scene.inclusions)


def _cut_spheres(spheres, resistance, axis, change, spacing):
    """Add the changes of resistivity, one of each phase, of images of spheres, as `_cut_shape` does of one shape."""
    # The kernel sees the links' axis last.
    order = [a for a in range(3) if a != axis] + [axis]
    view = np.moveaxis(resistance, axis, 2)
    for block in windows(spheres, resistance.shape, spacing, whole=True):
        # Columns that are picked lie column by column: kernels would be compiled for that, too.
        center, radius = np.ascontiguousarray(block.center[:, order]), block.radius
        kernels.cut_links_by_spheres(view, change[block.number], center, radius, spacing[order])


def _cut_shape(shape, resistance, axis, change, spacing):
    """Add the change of resistivity of one image of any shape, by its distance along the links alone."""
    counts = tuple(n - (a == axis) for a, n in enumerate(resistance.shape))
    rows, inside = inside_parts(shape, counts, spacing, axis)
    np.moveaxis(resistance, axis, 2)[rows[:, 0], rows[:, 1]] += change * inside


def _cut_layer(shape, resistance, axis, change, spacing):
    """The same of a layer: by the part of a link inside it, or by where a link parallel to it lies."""
    n, h = resistance.shape[shape.axis], spacing[shape.axis]
    if axis == shape.axis:
        ends = np.clip((np.arange(n + 1) - 0.5) * h, 0.0, (n - 1) * h)
        inside = np.clip(np.minimum(shape.stop, ends[1:]) - np.maximum(shape.start, ends[:-1]), 0.0, None) / h
    else:
        middle = (np.arange(n) + 0.5) * h
        # Half-open: a link in the plane where two layers meet belongs to one of them.
        inside = ((middle >= shape.start) & (middle < shape.stop)).astype(float)
    where = [1, 1, 1]
    where[shape.axis] = -1
    whole = np.ones(resistance.shape[axis])
    if axis != shape.axis:
        whole[[0, -1]] = 0.5
    along = [1, 1, 1]
    along[axis] = -1
    resistance += change * inside.reshape(where) * (1.0 if axis == shape.axis else whole.reshape(along))
