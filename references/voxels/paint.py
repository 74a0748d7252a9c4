"""A scene on a regular grid of voxels: phases by the voxel centre, or a conductivity tensor in voxels that are cut.

The laminate rule gives a cut voxel the conductivity of a laminate of its phases with the interface's normal n:
arithmetic mean A in the tangent plane, harmonic mean H along the normal, K = A (I - n n) + H n n.  On a curved or a
second interface n n is its average over the surface inside the voxel (trace 1).  Sources: the composite voxels of
Gelebart and Ouaki, J. Comput. Phys. 294 (2015) 90-95, and Kabel, Merkert and Schneider, Comput. Methods Appl. Mech.
Engrg. 294 (2015) 168-188.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from demheat.runtime.progress import stage
from demheat.scene import Scene
from references.voxels import kernels
from references.voxels.cut import laminate_tensors, phase_parts
from references.voxels.films import films_of, slopes_of, with_films
from references.voxels.laminates import cut_tensors, packed
from references.voxels.planes import kept, reaches
from references.voxels.solids import cut_voxels, window
from references.voxels.spheres import Balls, groups, windows

# Phases are kept as 16-bit numbers, flat voxel indices of one axis fit 32 bits.
MOST_PHASES = 2**16
MOST_VOXELS = 2**31 - 1
# Axes of the entries of a tensor.
PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))


class Voxels(NamedTuple):
    """A scene on a regular grid."""

    spacing: np.ndarray  # (3,) float array, m
    phase: np.ndarray  # (nx, ny, nz) uint16 array: Phase number at the centre of each voxel
    # (1 + number of inclusions,) float array, W/(m K): Of each phase; of a tensor its mean over directions
    conductivity: np.ndarray
    cut: np.ndarray  # (m,) int array: Flat indices of the voxels that have a tensor of their own, ascending
    tensor: np.ndarray  # (m, 6) float array, W/(m K): Their conductivities, order xx, yy, zz, yz, xz, xy
    # (1 + number of inclusions,) float array: Volume fraction of each phase, parts of voxels included
    fractions: np.ndarray
    # (1 + number of inclusions, 6) float array, W/(m K), optional: Of each phase, where that of one is a tensor; see
    # `references.voxels.laminates`
    tensors: np.ndarray | None = None
    # (m, 3) float array, m2 K/W, optional: Times the flux against Fourier's direction, how much warmer the phase of
    # each cut voxel's centre is than the mean of its corners, where surfaces resist (`references.voxels.films`)
    rise: np.ndarray | None = None


class Medium(NamedTuple):
    """A material property of every voxel, as kernels read it."""

    phase: np.ndarray  # (nx, ny, nz) uint16 array
    scalar: np.ndarray  # (phases,) float array: The property in whole voxels
    # (nx * ny + 1,) int64 array: Cut voxels of row (i, j) of voxels are start[i * ny + j] to start[i * ny + j + 1]
    start: np.ndarray
    place: np.ndarray  # (m,) int32 array: Last index of each cut voxel
    tensor: np.ndarray  # (m, 6) float array: The property in cut voxels, order xx, yy, zz, yz, xz, xy


class Cuts(NamedTuple):
    """Voxels cut by the inclusions' surfaces, one row per voxel and surface, in painting order."""

    index: np.ndarray  # (m,) int64 array: Flat index of the voxel
    fraction: np.ndarray  # (m,) float array: Part of it inside
    # (m, 6) float array, m2: Integral of n n over the surface inside the voxel, order xx, yy, zz, yz, xz, xy
    moment: np.ndarray
    phase: np.ndarray  # (m,) int64 array: Number of the inclusion


def grid_shape(scene: Scene, voxels, usual: int | None = None) -> tuple[int, int, int]:
    """Voxels along each side."""
    if scene.image is None:
        return _counted(scene, usual if voxels is None else voxels)
    own = scene.image.shape
    shape = own if voxels is None else _counted(scene, voxels)
    if any(n % m for n, m in zip(shape, own, strict=True)):
        raise ValueError(
            f"voxels = {voxels!r}: must be those of the image, {own}, or split each of them into equal parts, or be "
            "left out"
        )
    return shape


def _counted(scene, voxels):
    """Voxels along each side, as asked for."""
    message = f"voxels = {voxels!r}: must be a whole number >= 1, or three of them"
    try:
        counts = np.array(voxels if np.ndim(voxels) else [voxels])
    except ValueError:
        raise ValueError(message) from None
    if np.ndim(voxels) and any(isinstance(count, bool) for count in voxels):
        raise ValueError(message)
    if counts.dtype.kind not in "iu" or counts.shape not in ((1,), (3,)) or counts.min() < 1:
        raise ValueError(message)
    if len(counts) == 1:
        size = np.array(scene.size)
        counts = np.maximum(1, np.rint(size / size.max() * counts[0]))
    shape = tuple(int(n) for n in counts)
    if shape[0] * shape[1] * shape[2] > MOST_VOXELS:
        raise ValueError(f"voxels = {voxels!r}: a grid of {shape} has more than {MOST_VOXELS} voxels")
    return shape


def voxelise(scene: Scene, shape, *, laminate: bool, planes=None) -> Voxels:
    """Put a scene on a grid, or on some planes of it."""
    spacing = np.array(scene.size) / shape
    if len(scene.inclusions) >= MOST_PHASES:
        raise ValueError(f"Scene.inclusions: {len(scene.inclusions)} are more than the {MOST_PHASES - 1} a grid takes")
    if scene.image is not None:
        return _of_image(scene, shape, planes)
    # The system gives memory to what is written only: of some planes to them.
    phase = np.zeros(shape, dtype=np.uint16)
    cuts = _paint(scene, phase, spacing, laminate, planes)
    phase, cuts = kept(phase, cuts, planes)
    conductivity = scene.mean_conductivities
    tensors = _tensors(scene)
    count = kernels.count(phase.ravel(), len(conductivity))
    if not laminate:
        uncut = np.empty(0, np.int64), np.empty((0, 6))
        return Voxels(spacing, phase, conductivity, *uncut, count / phase.size, tensors)
    parent = scene.parents()
    cut, first, rank = np.unique(cuts.index, return_index=True, return_inverse=True)
    part = phase_parts(len(conductivity), rank, cuts, parent, parent[cuts.phase[first]])
    count = count - np.bincount(phase.ravel()[cut], minlength=len(conductivity))
    fractions = (count + np.bincount(part[1], part[2], minlength=len(conductivity))) / phase.size
    moment = np.stack([np.bincount(rank, column, len(cut)) for column in cuts.moment.T], axis=1)
    films = films_of(scene, shape) if scene.resistances.any() else None
    if scene.anisotropic:
        own, slopes = cut_tensors(part, scene.tensors, moment), None
    else:
        slopes = films and slopes_of(films, scene, shape, fractions)
        own = laminate_tensors(part, conductivity, moment, slopes and (slopes[0], slopes[1][cut]))
    voxels = Voxels(spacing, phase, conductivity, cut, own, fractions, tensors)
    return with_films(voxels, films, slopes) if films else voxels


def _of_image(scene, shape, planes):
    """Its own voxels or equal parts of them, all of them whole."""
    none, conductivity = (np.empty(0, np.int64), np.empty((0, 6))), scene.mean_conductivities
    phase, fractions = scene.image.phase_on(shape), scene.image.fractions
    if planes is not None:
        phase = phase[slice(*planes)]
        fractions = kernels.count(phase.ravel(), len(conductivity)) / phase.size
    phase = np.ascontiguousarray(phase, dtype=np.uint16)
    return Voxels(np.array(scene.size) / shape, phase, conductivity, *none, fractions, _tensors(scene))


def _tensors(scene):
    return packed(scene.tensors) if scene.anisotropic else None


def turned(voxels: Voxels, order: Sequence[int]) -> Voxels:
    """The same voxels with axes order[0], order[1], order[2] as axes 0, 1, 2."""
    if tuple(order) == (0, 1, 2):
        return voxels
    phase = np.ascontiguousarray(voxels.phase.transpose(order))
    place = np.unravel_index(voxels.cut, voxels.phase.shape)
    cut = np.ravel_multi_index([place[axis] for axis in order], phase.shape)
    ascending = np.argsort(cut)
    columns = [PAIRS.index(tuple(sorted((order[a], order[b])))) for a, b in PAIRS]
    tensor = voxels.tensor[np.ix_(ascending, columns)]
    tensors = None if voxels.tensors is None else voxels.tensors[:, columns]
    rise = None if voxels.rise is None else voxels.rise[np.ix_(ascending, list(order))]
    turned = {"spacing": voxels.spacing[list(order)], "phase": phase, "cut": cut[ascending], "tensor": tensor}
    return voxels._replace(**turned, tensors=tensors, rise=rise)


def centers(shape, spacing) -> list:
    """Coordinates of the voxel centres along each axis, m."""
    return [(np.arange(n) + 0.5) * h for n, h in zip(shape, spacing, strict=True)]


def medium(voxels: Voxels, scalar, tensor, dtype) -> Medium:
    """A property given per phase and per cut voxel, laid out for kernels."""
    nx, ny, nz = voxels.phase.shape
    start = np.searchsorted(voxels.cut, np.arange(nx * ny + 1) * nz)
    place = (voxels.cut % nz).astype(np.int32)
    return Medium(voxels.phase, scalar.astype(dtype), start, place, np.ascontiguousarray(tensor, dtype=dtype))


def _paint(scene, grid, spacing, cutting, planes):
    """Paint the inclusions in order; return the voxels that their surfaces cut, none if they are not asked for."""
    found, inclusions = [_none()], list(enumerate(scene.inclusions, start=1))
    with stage("voxels") as done:
        for group in groups(inclusions, scene.size, periodic=scene.periodic):
            if isinstance(group, Balls):
                found += _paint_spheres(group, grid, spacing, cutting, lambda n: done(n / len(inclusions)), planes)
                continue
            number, shape = group
            if reaches(shape, planes, spacing[0]):
                paint = _paint_layer if shape.flat else _paint_shape
                found.append(paint(shape, grid, spacing, number, cutting))
            done(number / len(inclusions))
    return Cuts(*(np.concatenate(column) for column in zip(*found, strict=True)))


def _paint_spheres(spheres, grid, spacing, cutting, done, planes=None):
    """Paint images of spheres in order; the voxels that their surfaces cut, block by block."""
    found = []
    for block in windows(spheres, grid.shape, spacing, planes=planes):
        count = kernels.paint_spheres(grid, block, spacing)
        if cutting:
            # One more row of moments: voxels that turn out not to be cut are integrated there, too.
            cuts = Cuts(np.empty(count, np.int64), np.empty(count), np.empty((count + 1, 6)), np.empty(count, np.int64))
            n = kernels.cut_spheres(np.array(grid.shape), block, spacing, cuts)
            found.append(Cuts(*(column[:n].copy() for column in cuts)))
        done(block.number[-1])
    return found


def _none():
    return Cuts(np.empty(0, np.int64), np.empty(0), np.empty((0, 6)), np.empty(0, np.int64))


def _paint_shape(shape, grid, spacing, number, cutting):
    """Paint one image of any shape, and find the voxels that its surface cuts, by its distance and normal alone."""
    _fill(shape, grid, spacing, number)
    if not cutting:
        return _none()
    index, fraction, moment = cut_voxels(shape, grid.shape, spacing)
    cut = (fraction > kernels.FULL) & (fraction < 1 - kernels.FULL)
    return Cuts(index[cut], fraction[cut], moment[cut], np.full(int(cut.sum()), number))


def _fill(shape, grid, spacing, number):
    """Paint the voxels whose centres lie in one image of a shape."""
    low, high = window(shape, np.array(grid.shape), spacing, clipped=True)
    y, z = (np.arange(low[axis], high[axis]) for axis in (1, 2))
    # Slice by slice: no array of points as large as the grid.
    for x in range(low[0], high[0]):
        points = np.stack(np.meshgrid([x], y, z, indexing="ij"), axis=-1).reshape(-1, 3)
        inside = shape.contains((points + 0.5) * spacing)
        grid[tuple(points[inside].T)] = number


def _paint_layer(shape, grid, spacing, number, cutting):
    """Paint a layer, exactly."""
    axis, h = shape.axis, spacing[shape.axis]
    planes = np.arange(grid.shape[axis])
    middle = (planes + 0.5) * h
    inside = np.clip((np.minimum(shape.stop, (planes + 1) * h) - np.maximum(shape.start, planes * h)) / h, 0.0, 1.0)
    whole = [slice(None)] * 3
    whole[axis] = (middle >= shape.start) & (middle <= shape.stop)
    if cutting:
        # What is thinner than rounding cuts no voxel, and fills none.
        whole[axis] &= inside > kernels.FULL
    grid[tuple(whole)] = number
    if not cutting:
        return _none()
    cut = np.flatnonzero((inside > kernels.FULL) & (inside < 1 - kernels.FULL))
    places = [np.arange(n) for n in grid.shape]
    places[axis] = cut
    index = np.ravel_multi_index(np.ix_(*places), grid.shape)
    part = np.broadcast_to(np.expand_dims(inside[cut], [a for a in range(3) if a != axis]), index.shape)
    moment = np.zeros((index.size, 6))
    moment[:, axis] = np.prod(np.delete(spacing, axis))
    return Cuts(index.ravel(), part.ravel(), moment, np.full(index.size, number))
