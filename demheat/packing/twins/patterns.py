"""Touch points of twins on the interfaces of a scene, closer where another interface or a wall is near."""

from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from demheat.packing.twins import surfaces_kernels as kernels
from demheat.packing.twins.interfaces import pattern_count
from demheat.runtime.limits import check_memory
from demheat.runtime.threads import shared_out

# Of twins along an interface, in mean radii of the packing; found best together with their offsets, see
# `demheat.packing.twins.conforming`.
SPACING = 1.6
# Offsets nearer to an obstacle than this would make slivers of the two cells of a pair: it is left out.
LEAST_OFFSET = 0.05
LEAST_SPACING = 4 * LEAST_OFFSET
# Spacing of the points that closer patterns are chosen from.
FINE = 0.8 * LEAST_SPACING
# Points thinned to this part of their spacing cover the surface at least as densely as an even pattern does.
THINNING = 0.75
# Digits of spacings in mean radii, and the part of them that breaks ties.
DIGITS, TIES = 9, 1e-8
# Least bytes of a twin, as a particle of the network.
BYTES = 400
# Spheres, and points to choose from, that are looked at together: bounds the scratch memory (some 100 bytes a point).
MOST_SPHERES, MOST_POINTS = 256, 1 << 20


def patterns(interfaces, radius, seed, tally, gap_spacing):
    """Touch points on all surfaces of a scene, chunk by chunk."""
    turns, leads = _Turns(seed), interfaces.stacks.leads()
    usual = np.minimum(interfaces.stacks.spacing, SPACING * radius)
    wanted = partial(_spacing, interfaces, radius, gap_spacing)
    for numbers in _chunks(interfaces.spheres, np.flatnonzero(leads[: len(interfaces.spheres)]), radius):
        found = _on_spheres(numbers, interfaces, radius, turns, tally, usual, wanted)
        columns = [np.concatenate(column) for column in zip(found, *_columns(interfaces, found), strict=True)]
        yield _taken(columns, np.argsort(columns[2], kind="stable"))
    rng = turns.after()
    for number in len(interfaces.spheres) + np.flatnonzero(leads[len(interfaces.spheres) :]):
        other = interfaces.others[number - len(interfaces.spheres)]
        found = _on_other(number, other, interfaces, radius, rng, tally, usual, wanted)
        yield found
        yield from _columns(interfaces, found)


def _columns(interfaces, found):
    """Points of the other surfaces of stacks, above and below those of the leaders."""
    return [columns[1:] for columns in interfaces.columns(*found) if len(columns[0])]


class Tally:
    """How many twins are to be expected, `twins`, and how many there would be without narrow gaps, `even`."""

    def __init__(self):
        self.twins, self.even = 0.0, 0

    def add(self, closer, sizes) -> None:
        """Count those that an even pattern becomes where it has to be closer by factors; refuse more than memory holds.

        Points thinned to THINNING of their spacing are as many as those of an even pattern with it, or a quarter
        more. Each stands for the points of so many surfaces.
        """
        self.even += 2 * int(np.sum(np.broadcast_to(sizes, closer.shape)))
        self.twins += 2 * float(np.sum(sizes * np.minimum(closer, 1.0) ** -2.0))
        check_memory("twins, most of them in narrow gaps,", int(self.twins), BYTES * self.twins)


class _Turns:
    """Random rotations, drawn from one stream and used up in order."""

    def __init__(self, seed):
        self.seed, self.used = [seed, 71], 0
        self._rng, self._drawn = np.random.default_rng(self.seed), np.empty((0, 4))

    def matrices(self, numbers):
        """Rotations of these numbers in the stream, (m, 3, 3) float array."""
        missing = numbers.max(initial=-1) + 1 - len(self._drawn)
        if missing > 0:
            self._drawn = np.concatenate([self._drawn, self._rng.normal(size=(missing + len(self._drawn), 4))])
        return Rotation.from_quat(self._drawn[numbers]).as_matrix() if len(numbers) else np.empty((0, 3, 3))

    def after(self):
        """The generator as it is when the rotations that were used have been drawn."""
        rng = np.random.default_rng(self.seed)
        rng.normal(size=(self.used, 4))
        return rng


def _chunks(spheres, numbers, radius):
    """Numbers of spheres in runs of a limited number of points to choose from."""
    total = np.cumsum(pattern_count(spheres.radii[numbers], FINE * radius))
    begin = 0
    while begin < len(numbers):
        before = total[begin - 1] if begin else 0
        end = int(np.searchsorted(total, before + MOST_POINTS, side="right"))
        end = min(max(end, begin + 1), begin + MOST_SPHERES)
        yield numbers[begin:end]
        begin = end


def _on_spheres(numbers, interfaces, radius, turns, tally, usual, wanted):
    """Pattern of some spheres.

    Each takes its turn from the stream, and one more for its closer pattern if it needs one: which turns those after it
    take, and with them which of them need one, is found by repetition. One more of them is right after each.
    """
    spheres, refined = interfaces.spheres, np.zeros(len(numbers), dtype=bool)
    while True:
        turn = turns.used + np.arange(len(numbers)) + np.cumsum(refined) - refined
        even = _inside(interfaces.scene, *spheres.pattern(numbers, usual[numbers], turns.matrices(turn)))
        spacing = wanted(*even)
        close = np.isin(numbers, even[2][spacing < usual[even[2]]])
        if np.array_equal(close, refined):
            break
        refined = close
    tally.add(spacing / usual[even[2]], interfaces.stacks.sizes()[even[2]])
    turns.used += len(numbers) + int(refined.sum())
    if not refined.any():
        return even
    chosen, matrices = numbers[refined], turns.matrices(turn[refined] + 1)
    # Fibonacci points descend along the axis of their sphere.
    side = np.minimum(FINE * radius, 0.5 * usual[chosen])
    fine = _Fine(*spheres.pattern(chosen, side, matrices), chosen, -matrices[:, :, 2])
    return _refined(interfaces, even, spacing, fine, usual, wanted)


def _on_other(number, surface, interfaces, radius, rng, tally, usual, wanted):
    """Pattern of a surface that is not a sphere."""

    def pattern(spacing):
        points, normals = surface.pattern(spacing, rng)
        return points, normals, np.full(len(points), number)

    even = _inside(interfaces.scene, *pattern(SPACING * radius))
    spacing = wanted(*even)
    tally.add(spacing / (SPACING * radius), interfaces.stacks.sizes()[number])
    if np.all(spacing >= SPACING * radius):
        return even
    points, normals = surface.choice(FINE * radius, SPACING * radius, partial(_wanted_of, number, wanted), rng)
    if not len(points):
        return even
    own = np.full(len(points), number)
    longest = np.eye(3)[[np.argmax(np.ptp(points, axis=0))]]
    fine = _Fine(points, normals, own, np.array([number]), longest)
    return _refined(interfaces, even, spacing, fine, usual, wanted)


def _wanted_of(number, wanted, points, normals):
    return wanted(points, normals, np.full(len(points), number))


class _Fine(NamedTuple):
    points: np.ndarray  # (n, 3) m, to choose from
    normals: np.ndarray  # (n, 3) unit vectors
    own: np.ndarray  # (n,) ascending
    numbers: np.ndarray  # (m,) of the surfaces, ascending
    axes: np.ndarray  # (m, 3) unit vectors, along which its points are sought


def _refined(interfaces, even, spacing, fine, usual, wanted):
    """An even pattern where its spacing is not too wide, elsewhere what is chosen from a fine one."""
    more = _inside(interfaces.scene, *fine[:3])
    wanted = wanted(*more)
    narrow = np.flatnonzero(wanted < usual[more[2]])
    even, more = _taken(even, np.flatnonzero(spacing >= usual[even[2]])), _taken(more, narrow)
    # Small spheres keep points all round.
    wanted = np.minimum(wanted[narrow], interfaces.widest_spacing(more[2]))
    # Equal ones come at random, the same in any unit: in their own order a third more would be chosen.
    wanted *= 1.0 + TIES * np.random.default_rng(0).random(len(narrow))
    chosen = np.zeros(len(narrow), dtype=bool)
    start, there = (_starts(own, fine.numbers) for own in (more[2], even[2]))
    where = (start, more[0], THINNING * wanted), (there, even[0]), fine.axes, chosen
    shared_out(thinned, len(start), *where, piece=1)
    columns = [np.concatenate(pair) for pair in zip(even, _taken(more, np.flatnonzero(chosen)), strict=True)]
    return _taken(columns, np.argsort(columns[2], kind="stable"))


def thinned(first, last, fine, even, axes, chosen) -> None:
    """Mark points of surfaces from first to last that keep their distance, see `surfaces_kernels.thin`.

    `fine` are (where those of each surface begin and end, points, what they keep), `even` are (where, points) that are
    there already. Points are sought along the axis of their surface, faster where they ascend already.
    """
    (spans, points, least), (taken_spans, taken) = fine, even
    some = slice(first, last)
    for (begin, end), (low, high), axis in zip(spans[some], taken_spans[some], axes[some], strict=True):
        if begin == end:
            continue
        here, there = points[begin:end], taken[low:high]
        along, order = _along(here, axis), _ascending(least[begin:end])
        way_up = place = np.arange(end - begin)
        if np.any(along[1:] < along[:-1]):
            way_up, place = _ascending(along), np.empty_like(place)
            place[way_up] = np.arange(end - begin)
            along = along[way_up]
        beside = _along(there, axis)
        below = np.searchsorted(along, beside - least[begin:end].max())
        free = np.ones(end - begin, dtype=bool)
        found = order, way_up, place, along, there, beside, below, free, chosen[begin:end]
        kernels.thin(here, least[begin:end], *found)


def _along(points, axis):
    return points[:, 0] * axis[0] + points[:, 1] * axis[1] + points[:, 2] * axis[2]


def _ascending(values):
    order = np.empty(len(values), np.int64)
    kernels.ascending(values, np.zeros(len(values) + 1, np.int64), order)
    return order


def _taken(columns, places):
    return [column.take(places, axis=0) for column in columns]


def _starts(own, numbers):
    """Where the points of each of some surfaces begin and end, (m, 2) int array; owners ascend."""
    return np.stack([np.searchsorted(own, numbers), np.searchsorted(own, numbers, side="right")], axis=1)


def _inside(scene, points, normals, own):
    """The points that lie in the box, where it has walls."""
    if scene.periodic:
        return points, normals, own
    good = np.all((points > 0) & (points < scene.size), axis=1)
    return points[good], normals[good], own[good]


def _spacing(interfaces, radius, gap_spacing, points, normals, own):
    """Distance between twins at points of surfaces: no more than the width of the narrowest gap at a column asks."""
    width = interfaces.width(points, normals, own)
    for there, *others in interfaces.columns(points, normals, own):
        width[there] = np.minimum(width[there], interfaces.width(*others))
    # Where a gap is equally wide all round, as in a coat, rounding must not say which points come first.
    spacing = np.clip(np.round(gap_spacing * width / radius, DIGITS), LEAST_SPACING, SPACING)
    return spacing * radius
