"""What voxels conduct at least and at most: nowhere more, and nowhere less, than spheres and layers of a scene do.

A voxel that lies in one phase has that one's conductivity. One that may lie in several is cut into 8 x 8 x 8 parts, and
a part that may still lie in several conducts as the worst of them, for a lower bound, or as the best. Which phases may
be there is asked of the part's nearest and farthest points: spheres and layers are convex, so the answer is sure.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import singledispatch
from typing import NamedTuple

import numpy as np

from demheat.scene import Layer, Shape, Sphere
from references.bracket.voxels.voxel_kernels import Cells

# Parts of a voxel's edge.
PARTS = 8
# Voxels that are cut at a time: 30 MB.
BLOCK = 4096
# Of the box: rounding of coordinates that users type or work out. A face of a layer so near to one of voxels is on it.
GRAIN = 1e-12


class Painted(NamedTuple):
    """Voxels of a scene."""

    conducting: Cells  # Of conductivities, nowhere less than the scene's
    resisting: Cells  # Of resistivities, nowhere less than the scene's


class Boxes(NamedTuple):
    """Boxes by their corners along each axis, of shapes that broadcast against one another."""

    low: tuple  # tuple of three float arrays, m
    high: tuple  # tuple of three float arrays, m


def painted(conductivity: np.ndarray, images: Sequence[tuple[int, Shape]], shape, spacing) -> Painted:
    """Put shapes on a grid."""
    edges = [np.arange(n + 1) * h for n, h in zip(shape, spacing, strict=True)]
    grain = GRAIN * max(edge[-1] for edge in edges)
    least, greatest = _coarse(conductivity, images, edges, grain)
    cut = np.flatnonzero(least != greatest)
    row = np.full(shape, -1, np.int32)
    row.flat[cut] = np.arange(len(cut))
    across, along = np.empty((len(cut), 3, 3, 3)), np.empty((len(cut), 3, 3))
    for first in range(0, len(cut), BLOCK):
        which = cut[first : first + BLOCK]
        low, high = _parts(conductivity, images, np.unravel_index(which, shape), edges, grain)
        across[first : first + BLOCK] = _across(high)
        along[first : first + BLOCK] = _along(1 / low)
    return Painted(Cells(greatest, row, across), Cells(1 / least, row, along))


def _coarse(conductivity, images, edges, grain):
    """Least and greatest conductivity of each voxel."""
    shape = tuple(len(edge) - 1 for edge in edges)
    least, greatest = np.full(shape, conductivity[0]), np.full(shape, conductivity[0])
    for phase, image in images:
        window = tuple(_window(edge, a, b) for edge, a, b in zip(edges, *image.bounds(), strict=True))
        mine = [edge[part.start : part.stop + 1] for edge, part in zip(edges, window, strict=True)]
        boxes = Boxes(np.ix_(*(edge[:-1] for edge in mine)), np.ix_(*(edge[1:] for edge in mine)))
        _paint(image, boxes, conductivity[phase], least[window], greatest[window], grain)
    return least, greatest


def _window(edge, low, high):
    """Voxels along an axis that reach between two coordinates, and one more either way."""
    count = len(edge) - 1
    first, last = np.searchsorted(edge, [low, high])
    return slice(max(int(first) - 2, 0), min(int(last) + 1, count))


def _parts(conductivity, images, place, edges, grain):
    """Least and greatest conductivity of the parts of some voxels, (m, 8, 8, 8) float arrays."""
    count = len(place[0])
    low, high = [], []
    for axis, (index, edge) in enumerate(zip(place, edges, strict=True)):
        form = [count, 1, 1, 1]
        form[axis + 1] = PARTS
        width = (edge[index + 1] - edge[index])[:, None] / PARTS
        corners = edge[index][:, None] + width * np.arange(PARTS + 1)
        corners[:, -1] = edge[index + 1]
        low.append(corners[:, :-1].reshape(form))
        high.append(corners[:, 1:].reshape(form))
    least = np.full((count, PARTS, PARTS, PARTS), conductivity[0])
    greatest = least.copy()
    for phase, image in images:
        near = _meeting(image, low, high)
        if not len(near):
            continue
        boxes = Boxes(tuple(each[near] for each in low), tuple(each[near] for each in high))
        below, above = least[near], greatest[near]
        _paint(image, boxes, conductivity[phase], below, above, grain)
        least[near], greatest[near] = below, above
    return least, greatest


def _meeting(image, low, high):
    """Which voxels reach into a shape's bounds."""
    inside = True
    for begin, end, one, other in zip(*image.bounds(), low, high, strict=True):
        ones, others = one.reshape(len(one), -1)[:, 0], other.reshape(len(other), -1)[:, -1]
        inside &= (others >= begin) & (ones <= end)
    return np.flatnonzero(inside)


def _paint(image, boxes, conductivity, least, greatest, grain):
    """Paint a shape over what boxes conduct at least and at most, in place."""
    some, all_ = _held(image, boxes, grain)
    np.copyto(least, np.minimum(least, conductivity), where=some)
    np.copyto(greatest, np.maximum(greatest, conductivity), where=some)
    np.copyto(least, conductivity, where=all_)
    np.copyto(greatest, conductivity, where=all_)


@singledispatch
def _held(image: Shape, boxes, grain):
    """Whether some of each box may lie, and whether all of it surely lies, in a shape, but for what has no volume."""
    raise NotImplementedError(f"bounds on voxels are known of spheres and layers, not of a {image.kind}")


@_held.register
def _(layer: Layer, boxes, grain):
    low, high = boxes.low[layer.axis], boxes.high[layer.axis]
    some = (high > layer.start + grain) & (low < layer.stop - grain)
    return some, (low >= layer.start - grain) & (high <= layer.stop + grain)


@_held.register
def _(sphere: Sphere, boxes, grain):
    near = far = 0.0
    for low, high, middle in zip(boxes.low, boxes.high, sphere.center, strict=True):
        near = near + np.maximum(0.0, np.maximum(low - middle, middle - high)) ** 2
        far = far + np.maximum(high - middle, middle - low) ** 2
    return near < (sphere.radius + grain) ** 2, far <= max(sphere.radius - grain, 0.0) ** 2


def _shapes():
    """Means over each part of an edge, times its length, of products of the two linear shapes, (8, 3) float array."""
    x = np.arange(PARTS + 1) / PARTS
    falling = -((1 - x) ** 3) / 3
    both, rising = x**2 / 2 - x**3 / 3, x**3 / 3
    return np.diff(np.stack([falling, both, rising], axis=1), axis=0)


def _across(property_):
    """Products of a property with shapes along the two other axes, for each axis, (m, 3, 3, 3) float array."""
    shapes, found = _shapes(), []
    for axis in range(3):
        mean = property_.mean(axis=axis + 1)
        found.append(np.einsum("myz,ye,zf->mef", mean, shapes, shapes, optimize=True))
    return np.stack(found, axis=1)


def _along(property_):
    """Products of a property with shapes along each axis, (m, 3, 3) float array."""
    shapes = _shapes()
    means = [property_.mean(axis=tuple(a + 1 for a in range(3) if a != axis)) for axis in range(3)]
    return np.stack([mean @ shapes for mean in means], axis=1)


def mirrored(images: Sequence[tuple[int, Shape]], size, doubled: Sequence[bool]) -> list[tuple[int, Shape]]:
    """Shapes of a box and of its mirror images across the far faces of some axes, in painting order.

    Nothing of a shape that reaches out of the box is where another phase is: its mirror image covers that.
    """
    found = list(images)
    for axis in np.flatnonzero(doubled):
        found += [(phase, image) for phase, each in found for image in _mirror(each, axis, 2 * size[axis])]
    return sorted(found, key=lambda pair: pair[0])


@singledispatch
def _mirror(shape: Shape, axis, twice) -> Iterator[Shape]:
    center = list(shape.center)
    center[axis] = twice - center[axis]
    yield replace(shape, center=tuple(center))


@_mirror.register
def _(shape: Layer, axis, twice):
    # Across another axis a layer goes on.
    if shape.axis == axis:
        yield replace(shape, start=twice - shape.stop, stop=twice - shape.start)
