"""Links between neighbouring voxel centres, cut exactly where they cross a surface: harmonic means along each link."""

from __future__ import annotations

import numpy as np

from demheat.scene import Layer, Scene
from references.voxels import kernels
from references.voxels.paint import parents, voxelise

# A sphere's surface nearer to a node than this part of a link is taken this far away.  It moves the surface by 2e-4 of
# a voxel in the mean (k changes by less than 0.002 % at 32^3) and saves half of the iterations at contrast 1e4, two
# thirds at 1e6, which the few links of nearly no resistance cost.
NEAREST = 0.02


def links(scene: Scene, shape, *, phase=None) -> tuple:
    """Conductivity of every link, W/(m K).

    Link i of an axis joins voxels i - 1 and i.  The first and the last pass through a face of the box: one and the
    same link in a periodic cell; mirrored in an isothermal wall, so twice its inner half; 0 in an insulated one.

    Parameters
    ----------
    scene : Scene
        All conductivities positive.
    shape : (3,) tuple of int
        Voxels along each side.
    phase : (nx, ny, nz) uint16 array, optional
        Phase number at the centre of each voxel, if it is known already.

    Returns
    -------
    tuple of three float arrays
        Shapes (nx + 1, ny, nz), (nx, ny + 1, nz) and (nx, ny, nz + 1).
    """
    resistivity = 1.0 / scene.conductivities
    change = resistivity - resistivity[parents(scene)]
    if phase is None and scene.images():
        phase = voxelise(scene, shape, laminate=False).phase
    return tuple(_along(scene, shape, axis, resistivity, change, phase) for axis in range(3))


def _along(scene, shape, axis, resistivity, change, phase):
    """Conductivities of the links along one axis; each inclusion replaces the resistivity it was painted on."""
    counts = np.array(shape)
    spacing = np.array(scene.size) / counts
    counts[axis] += 1
    resistance = np.full(counts, resistivity[0])
    # The kernel sees the links' axis last.
    view = np.moveaxis(resistance, axis, 2)
    view[:, :, [0, -1]] *= 0.5
    order = [a for a in range(3) if a != axis] + [axis]
    for number, sphere in scene.images():
        center = np.array(sphere.center)[order]
        kernels.cut_links(view, change[number], center, sphere.radius, spacing[order])
    for number, inclusion in enumerate(scene.inclusions, start=1):
        if isinstance(inclusion, Layer):
            _cut_by_layer(resistance, axis, change[number], inclusion, spacing)
    if scene.periodic:
        view[:, :, 0] += view[:, :, -1]
        view[:, :, -1] = view[:, :, 0]
    else:
        view[:, :, [0, -1]] *= 2.0
    if scene.images():
        kernels.keep_off(view, np.moveaxis(phase, axis, 2), NEAREST * resistivity, scene.periodic)
    conductivity = np.divide(1.0, resistance, out=resistance)
    if not scene.periodic and axis != scene.axis:
        np.moveaxis(conductivity, axis, 2)[:, :, [0, -1]] = 0.0
    return conductivity


def _cut_by_layer(resistance, axis, change, layer, spacing):
    """Add a layer's change of resistivity: by the part of a link inside it, or by where a parallel link lies."""
    n, h = resistance.shape[layer.axis], spacing[layer.axis]
    if axis == layer.axis:
        ends = np.clip((np.arange(n + 1) - 0.5) * h, 0.0, (n - 1) * h)
        inside = np.clip(np.minimum(layer.stop, ends[1:]) - np.maximum(layer.start, ends[:-1]), 0.0, None) / h
    else:
        middle = (np.arange(n) + 0.5) * h
        # Half-open: a link in the plane where two layers meet belongs to one of them.
        inside = ((middle >= layer.start) & (middle < layer.stop)).astype(float)
    where = [1, 1, 1]
    where[layer.axis] = -1
    whole = np.ones(resistance.shape[axis])
    if axis != layer.axis:
        whole[[0, -1]] = 0.5
    along = [1, 1, 1]
    along[axis] = -1
    resistance += change * inside.reshape(where) * (1.0 if axis == layer.axis else whole.reshape(along))
