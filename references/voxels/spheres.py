"""Spheres of a scene as arrays, all images of them, in pieces that kernels go through within a part of a second."""

from collections.abc import Iterator, Sequence
from itertools import groupby, product
from typing import NamedTuple

import numpy as np

from demheat.scene import Shape, Sphere

# Voxels that one call of a kernel looks at, but for one sphere's plane: 0.1 s where surfaces are integrated.
MOST_LOOKED_AT = 2**20


class Balls(NamedTuple):
    """Images of spheres as they meet the box, in painting order."""

    number: np.ndarray  # (n,) int64 array: Phase
    center: np.ndarray  # (n, 3) float array, m
    radius: np.ndarray  # (n,) float array, m


class Windows(NamedTuple):
    """Pieces of spheres with the voxels that each may fill or cut, as kernels read them."""

    # number, center, radius: As in `Balls`, of the sphere that each is a piece of
    number: np.ndarray
    center: np.ndarray
    radius: np.ndarray
    # low, high: (n, 3) int64 arrays: Voxels to look at, low <= index < high
    low: np.ndarray
    high: np.ndarray


def groups(inclusions: Sequence[tuple[int, Shape]], size, *, periodic: bool) -> Iterator[Balls | tuple[int, Shape]]:
    """Inclusions that meet the box: spheres that follow one another as arrays, images of other shapes one by one."""
    for spheres, group in groupby(inclusions, key=lambda pair: pair[1].fills_ball):
        if spheres:
            yield images(list(group), size, periodic=periodic)
        else:
            yield from ((n, image) for n, shape in group for image in shape.images(size, periodic=periodic))


def images(spheres: Sequence[tuple[int, Sphere]], size, *, periodic: bool) -> Balls:
    """All images of spheres, as `Shape.images` finds them one by one."""
    number = np.array([n for n, _ in spheres], np.int64)
    center, radius = np.array([s.center for _, s in spheres]), np.array([s.radius for _, s in spheres])
    size = np.array(size, dtype=float)
    shifts = np.array(list(product((0, -1, 1), repeat=3)) if periodic else [(0, 0, 0)])
    centers = (center % size if periodic else center)[:, None] + shifts * size
    gap = np.maximum(0.0, np.maximum(-centers, centers - size))
    which, shift = np.nonzero(gap[..., 0] ** 2 + gap[..., 1] ** 2 + gap[..., 2] ** 2 < radius[:, None] ** 2)
    return Balls(number[which], centers[which, shift], radius[which])


def windows(
    spheres: Balls, shape, spacing, *, whole: bool = False, most: int = MOST_LOOKED_AT, planes=None
) -> list[Windows]:
    """The voxels that spheres may fill or cut, in blocks of not many voxels."""
    first, last, radius = np.zeros(3, np.int64), np.array(shape), spheres.radius[:, None]
    if planes is not None:
        first[0], last[0] = planes
    low = np.clip(np.floor((spheres.center - radius) / spacing) - 1, first, last).astype(np.int64)
    high = np.clip(np.ceil((spheres.center + radius) / spacing) + 1, first, last).astype(np.int64)
    across = high[:, 0] - low[:, 0]
    pieces = np.clip(-(-np.prod(high - low, axis=1) // most), 1, 1 if whole else np.maximum(across, 1))
    which = np.repeat(np.arange(len(pieces)), pieces)
    part = np.arange(len(which)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    begin, low, high = low[which, 0], low[which], high[which]
    low[:, 0] = begin + across[which] * part // pieces[which]
    high[:, 0] = begin + across[which] * (part + 1) // pieces[which]
    found = Windows(*(column[which] for column in spheres), low, high)
    block = np.cumsum(np.prod(high - low, axis=1)) // most
    ends = [0, *(np.flatnonzero(np.diff(block)) + 1), len(block)]
    return [Windows(*(column[a:b] for column in found)) for a, b in zip(ends, ends[1:], strict=False) if b > a]
