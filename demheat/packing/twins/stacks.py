"""Parallel surfaces near each other: planes of layers, and spheres about one centre. Their twins form columns.

Where touch points of two faces stand above each other, the power of a point of a face relative to its own twins is the
squared distance from the touch point less a constant, and relative to those of the other face never less. So no facet
crosses a face, however far apart the columns stand: their spacing need not go with the width, cells in between are
prisms, or frusta about one centre, and layers are exact.

In a layer one particle is the twin of both faces. In a shell between radii 1 - d and 1 + d one at the harmonic mean of
the radii is off by d^2 of what the shell does, which matters from d = THICK on. Two, each at a part of the width from
its face, and facets in the middle, have no error of that order for fields of degree 1 (solved on one column: .1864 of
the width), 2 (.189) and 3 (.190).
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from demheat.scene.shapes.base import TOUCH

THICK, SHARE = 0.01, 3.0 / 16.0
# Spacing of columns about a centre, squared, over radius times offset, at most: with facets a apart the polyhedron of a
# sphere's volume touches .07 a^2 / r inside of it, and what lies beyond a facet is to lie beyond the sphere, too.
BENT = 9.6


class Stacks(NamedTuple):
    """Which surfaces of a scene form columns; most are alone, each its own leader."""

    leader: np.ndarray  # (n,) int array: Of each surface: the outermost of its spheres, the first of its planes
    # tuple of (n,) int arrays: The second surface of each leader's stack, the third and so on; -1 for none
    members: tuple[np.ndarray, ...]
    # (n, 2) float array, m: Width of the gap to the next of the stack against its normal and along it, or to the mirror
    # image in a wall; infinite without one
    apart: np.ndarray
    share: np.ndarray  # (n, 2) float array: Of that width, the offset of the twin in it
    # (n,) float array, m2: Weight of the twins of each surface beyond what others have at their offsets
    rise: np.ndarray
    # (n,) float array, m: Distance between the columns of each leader at most; infinite where they are flat
    spacing: np.ndarray

    def leads(self) -> np.ndarray:
        """Which surfaces are leaders, (n,) bool array."""
        return self.leader == np.arange(len(self.leader))

    def sizes(self) -> np.ndarray:
        """How many surfaces are in the stack of each leader, (n,) int array."""
        return np.bincount(self.leader, minlength=len(self.leader))


def stacks_of(spheres, planes, scene, close=0.0, least=0.0, closer=1.0) -> Stacks:
    """The stacks of a scene's surfaces, spheres before planes, those whose gaps are narrower than a length.

    `spheres` are (m, 4) centres and radii; `planes` None for surfaces of other kinds. Columns about a centre that would
    have to be nearer to each other than a least spacing are none. By `closer`, below 1, all shells have two twins in a
    column, so many times as near to their faces: what that changes tells the error.
    """
    count, first = len(spheres) + len(planes), len(spheres)
    apart, share = np.full((count, 2), np.inf), np.full((count, 2), 0.5)
    rise, spacing = np.zeros(count), np.full(count, np.inf)
    shells, layers = _about_centres(spheres, scene, close, least, closer), []
    for stack in shells:
        radii = spheres[stack, 3]
        apart[stack[:-1], 0] = apart[stack[1:], 1] = radii[:-1] - radii[1:]
        share[stack[:-1], 0], share[stack[1:], 1], rises = _offsets(radii, closer)
        rise[stack[1:]] = np.cumsum(rises)
        spacing[stack[0]] = _spacing(radii, closer).min()
    for axis in range(3):
        number = np.array([k for k, plane in enumerate(planes) if plane is not None and plane.axis == axis], int)
        if len(number):
            place = np.array([planes[k].position for k in number])
            gaps, runs = _along(place, scene.size[axis], scene.periodic, close)
            apart[first + number] = gaps
            layers += [first + number[run] for run in runs]
            if not scene.periodic:
                _to_walls(first + number, place, scene.size[axis], close, apart, share)
    leader = np.arange(count)
    members = tuple(np.full(count, -1) for _ in range(max(map(len, shells + layers), default=1) - 1))
    for stack in shells + layers:
        leader[stack] = stack[0]
        for column, number in zip(members, stack[1:], strict=False):
            column[stack[0]] = number
    return Stacks(leader, members, apart, share, rise, spacing)


def _about_centres(spheres, scene, close, least, closer):
    """Numbers of spheres about one centre, none of them cut by a wall, each stack from the outside in."""
    centers, radii, size = spheres[:, :3], spheres[:, 3], np.array(scene.size)
    whole = np.arange(len(radii))
    if not scene.periodic:
        room = np.minimum(centers, size - centers).min(axis=1, initial=np.inf)
        whole = np.flatnonzero(room > radii)
    if len(whole) < 2:
        return []
    places = centers[whole] % size % size if scene.periodic else centers[whole]
    tree = cKDTree(places, boxsize=size if scene.periodic else None)
    pairs = tree.query_pairs(TOUCH * size.max(), output_type="ndarray")
    near = coo_array((np.ones(len(pairs)), pairs.T), shape=(len(whole),) * 2)
    _, group = connected_components(near, directed=False)
    order = np.lexsort((-radii[whole], group))
    number, group = whole[order], group[order]
    gap = radii[number[:-1]] - radii[number[1:]]
    wide = (gap > TOUCH * size.max()) & (_spacing(radii[number], closer) > least)
    return _runs(number, (group[:-1] == group[1:]) & wide & (gap < close))


def _offsets(radii, closer):
    """Offsets from the outer and from the inner sphere over what is between them, and what that adds to weights, m2."""
    outer, inner, both = radii[:-1], radii[1:], radii[:-1] + radii[1:]
    two = (outer - inner > THICK * both) | (closer < 1.0)
    # The facets of one twin of two spheres lie on both if its weight is right for both.
    rises = np.where(two, 0.0, (outer - inner) ** 2 * (outer**2 - inner**2) / both**2)
    return np.where(two, closer * SHARE, outer / both), np.where(two, closer * SHARE, inner / both), rises


def _spacing(radii, closer):
    """Distance between the columns of spheres about one centre at most, one for each pair, m."""
    _, share, _ = _offsets(radii, closer)
    return np.sqrt(BENT * share * np.maximum(radii[:-1] - radii[1:], 0.0) * radii[:-1])


def _along(place, length, periodic, close):
    """Gaps below and above planes along an axis, in order, to others of their stacks, and the planes of each stack."""
    gap = np.append(np.diff(place), place[0] + length - place[-1] if periodic else np.inf)
    joined = gap < close
    above = np.where(joined, gap, np.inf)
    # One that begins after a gap is the first of its stack; round a periodic cell there may be none.
    begin = int(np.argmin(np.roll(joined, 1)))
    order = np.roll(np.arange(len(place)), -begin)
    return np.stack([np.roll(above, 1), above], axis=1), _runs(order, joined[order[:-1]])


def _to_walls(number, place, length, close, apart, share):
    """Note what is between planes and walls: twice as much lies between a plane and its mirror image."""
    for end, width in enumerate((2.0 * place, 2.0 * (length - place))):
        near = (width < close) & (width < apart[number, end])
        apart[number[near], end], share[number[near], end] = width[near], 0.25


def _runs(number, joined):
    """Those of some numbers that are joined to the next, two and more."""
    return [run for run in np.split(number, np.flatnonzero(~joined) + 1) if len(run) > 1]
