"""Surfaces that resist heat, on voxels whose corners have the temperatures: jumps between corners on either side.

Let b be the sum of the gradients of the shape functions of those corners of a voxel that lie in a body. Where the body
is warmer by J the gradient of the voxel is g + b J, of which only g drives heat, and J costs the heat q.b that b counts
through the resistance R over |n.b|, the body's area in the voxel over its volume, with the normal n. The energy is
least in J where 1/K gains R b b / |n.b|, so K loses K b b K / (|n.b|/R + b.K b) (static condensation of a jump that is
constant in each voxel; Sherman and Morrison).  A film smeared by its own area would leak at voxels that it hardly cuts.
The sum of |n.b| over all voxels is the surface of what the corners see, whose steps the normals smooth.
"""

from typing import NamedTuple

import numpy as np

from references.voxels.laminates import packed, unpacked
from references.voxels.slopes import CORNERS, MOST, corners, pieces, seen, slopes_behind

# Least cosine between the normal and b: a body of few voxels has no normal that they know.
LEAST = 1 / 3


class Films(NamedTuple):
    """Voxels whose corners a surface parts that resists, one row per voxel and surface."""

    index: np.ndarray  # (m,) int array: Flat index of the voxel
    phase: np.ndarray  # (m,) int array: Of the shape
    normal: np.ndarray  # (m, 3) float array
    jump: np.ndarray  # (m, 3) float array, 1/m: b, see above
    area: np.ndarray  # (m,) float array, 1/m: |n.b|, of the surface in a voxel over its volume
    resistance: np.ndarray  # (m,) float array, m2 K/W
    # (m,) float array: Of J what the phase of the voxel's centre is warmer than the mean of the corners
    share: np.ndarray


def films_of(scene, shape) -> Films:
    """Films on a grid of voxels."""
    found = [
        _parted(image, number, shape, scene)
        for number, each in enumerate(scene.inclusions, start=1)
        if each.resistance > 0
        for image in each.images(scene.size, periodic=scene.periodic)
    ]
    return Films(*(np.concatenate(column) for column in zip(*found, strict=True)))


def slopes_of(films: Films, scene, shape, fractions) -> tuple:
    """Slopes along films in each phase, and those that the corners of all voxels see."""
    volume = np.prod(scene.size)
    areas = np.bincount(films.phase, films.area, len(fractions)) * volume / np.prod(shape)
    own = slopes_behind(scene, areas, fractions * volume)
    return own, seen(scene, shape, own).reshape(-1)


def with_films(voxels, films: Films, slopes: tuple | None):
    """Voxels that conduct as films let them; `slopes_of` them where they conduct alike all round."""
    cut, tensor = _owning(voxels, films.index)
    if slopes is not None:
        whole = np.flatnonzero(~np.isin(films.index, voxels.cut))
        place = np.searchsorted(cut, films.index[whole])
        _sloping(tensor, place, films.normal[whole], _gain(voxels, films.index[whole], *slopes))
    place, rise = np.searchsorted(cut, films.index), np.zeros((len(cut), 3))
    resistance = films.resistance / films.area
    np.add.at(rise, place, (resistance * films.share)[:, None] * films.jump)
    left = np.arange(len(place))
    # One after the other where several surfaces are in a voxel.
    while len(left):
        here, first = np.unique(place[left], return_index=True)
        row = left[first]
        tensor[here] = _resisting(tensor[here], films.jump[row], resistance[row])
        left = np.delete(left, first)
    return voxels._replace(cut=cut, tensor=tensor, rise=rise)


def _parted(image, number, counts, scene):
    """Films of one image of a shape."""
    spacing = np.array(scene.size) / counts
    low, _, inside = corners(image, counts, spacing, scene)
    met = sum(piece.astype(np.int8) for piece in pieces(inside))
    places = np.argwhere((met > 0) & (met < len(CORNERS)))
    jump = sum(inside[tuple((places + corner).T)][:, None] * (2 * corner - 1) for corner in CORNERS) / (4 * spacing)
    share = met[tuple(places.T)] / len(CORNERS)
    places += low
    height, normal = image.surface((places + 0.5) * spacing)
    length = np.linalg.norm(jump, axis=1)
    area = np.maximum(np.abs(np.einsum("mi,mi->m", normal, jump)), LEAST * length)
    index = np.ravel_multi_index(places.T, counts)
    own = np.full(len(index), number), np.full(len(index), image.resistance)
    films = Films(index, own[0], normal, jump, area, own[1], (height < 0) - share)
    # Opposite corners make no jump.
    return Films(*(column[length > 0] for column in films))


def _owning(voxels, index):
    """Cut voxels and their tensors, and with them others that are whole."""
    cut = np.union1d(voxels.cut, index)
    phase = voxels.phase.reshape(-1)[cut]
    if voxels.tensors is None:
        tensor = voxels.conductivity[phase][:, None] * np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    else:
        tensor = voxels.tensors[phase]
    tensor[np.searchsorted(cut, voxels.cut)] = voxels.tensor
    return cut, tensor


def _gain(voxels, index, own, seen):
    """What whole voxels conduct along a surface, over what their phase does."""
    return np.minimum((own[voxels.phase.reshape(-1)[index]] / seen[index]) ** 2, MOST)


def _sloping(tensor, place, normal, gain):
    """Change, in place, what voxels of one phase conduct along a surface with a normal."""
    across = packed(normal[:, :, None] * normal[:, None, :])
    tensor[place] = tensor[place, :1] * (across + gain[:, None] * (np.array([1, 1, 1, 0, 0, 0]) - across))


def _resisting(tensor, jump, resistance):
    """Tensors that lose what does not pass a surface; its resistance times volume, m3 K/W."""
    along = np.einsum("mij,mj->mi", unpacked(tensor), jump)
    rest = 1 / resistance + np.einsum("mi,mi->m", along, jump)
    return tensor - packed(along[:, :, None] * along[:, None, :] / rest[:, None, None])
