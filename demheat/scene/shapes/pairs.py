"""Which pairs of shapes a scene takes: disjoint, touching, or one inside the other and painted after it."""

import math
from collections.abc import Sequence
from itertools import product
from typing import NamedTuple

import numpy as np

from demheat.scene.shapes.base import TOUCH, Shape
from demheat.scene.shapes.bins import ball_bins, candidates
from demheat.scene.shapes.holders import bounding_balls
from demheat.scene.shapes.parted import nested, parted
from demheat.scene.shapes.periodic import nearest

# Of a thousand: what touches is taken.
ROUNDING = 1e-6


class _Cell(NamedTuple):
    size: np.ndarray  # (3,) m
    period: np.ndarray | None  # (3,) m
    tolerance: float  # m

    @property
    def box(self):
        """The box whose walls end all there is, none in a periodic cell."""
        return self.size if self.period is None else None


def check_pairs(shapes: Sequence[Shape], size: Sequence[float], *, periodic: bool) -> None:
    """Refuse shapes that overlap partially, and shapes that later ones hide.

    Exact for spheres, layers and what fills its bounds, and for one of these or a half-space beside a shape whose
    distance is exact. Of other convex shapes it takes those pairs that a plane is found to part, or of which one holds
    balls or corners around the other; of what is not convex, those whose bounds are apart or in the other, and balls in
    it or beside it; of unions each member for itself. What it takes is certain, what it refuses may only be too near to
    tell.
    """
    box = np.array(size)
    cell = _Cell(box, box if periodic else None, TOUCH * box.max())
    centers, radii = bounding_balls(shapes)
    close = _close(shapes, centers, radii, cell)
    for i, j in close:
        _check_pair(shapes, i, j, cell, lambda: _shrunk(shapes, centers, radii, close, cell))


def _close(shapes, centers, radii, cell):
    """Pairs of shapes whose balls overlap, in order: those of two balls by bins, those with an endless shape all."""
    ends = np.isfinite(radii)
    ball = np.flatnonzero(ends)
    # Where two balls overlap, the centre of the smaller one lies in the larger one made twice as large.
    bins = ball_bins(centers[ball], 2.0 * radii[ball], cell.size, periodic=cell.period is not None)
    one, other = (ball[part] for part in candidates(bins, centers[ball]))
    offsets = nearest(centers[one] - centers[other], cell.period)
    close = np.sqrt(np.einsum("ij,ij->i", offsets, offsets)) < radii[one] + radii[other] - cell.tolerance
    found = [np.stack([one[close], other[close]])]
    for number in np.flatnonzero(~ends):
        # A ball beside an endless shape, which most are, is apart from it.
        near = ~ends
        near[ball] = shapes[number].sure_distance(centers[ball], period=cell.period) < radii[ball] - cell.tolerance
        others = np.flatnonzero(near)
        found.append(np.stack([np.full(len(others), number), others]))
    pairs = np.sort(np.concatenate(found, axis=1), axis=0)
    return np.unique(pairs[:, pairs[0] < pairs[1]], axis=1).T.tolist()


def _shrunk(shapes, centers, radii, close, cell):
    """What to add where smaller spheres would all be disjoint or nested: by how much smaller, to three digits."""
    balls = np.array([shape.fills_ball for shape in shapes])
    i, j = np.array([pair for pair in close if balls[pair].all()]).reshape(-1, 2).T
    apart = np.linalg.norm(nearest(centers[i] - centers[j], cell.period), axis=1)
    sums, differences = radii[i] + radii[j], np.abs(radii[i] - radii[j])
    inside = apart <= differences + cell.tolerance
    factor = math.floor(1000 * np.min((apart / sums)[~inside], initial=1.0) + ROUNDING) / 1000
    # What lies in another one moves closer to its surface.
    good = 0 < factor < 1 and np.all(apart[inside] <= factor * differences[inside])
    return f"; spheres of {factor:g} times their radii would be" if good else ""


def _check_pair(shapes, i, j, cell, mended):
    first, second = shapes[i], shapes[j]
    if _crossed(first, second):
        raise ValueError(f"Scene.inclusions[{i}], [{j}]: layers along different axes cross each other")
    if all(_apart(one, other, cell) for one in first.parts for other in second.parts):
        return
    if _holds_all(second, first, cell):
        raise ValueError(f"Scene.inclusions[{i}] is hidden by inclusions[{j}]: list the outer one first")
    if not _holds_all(first, second, cell):
        raise ValueError(
            f"Scene.inclusions[{i}] and [{j}] overlap partially{_unsure(first, second)}: inclusions must be disjoint, "
            f"touching or fully nested{mended() if first.fills_ball and second.fills_ball else ''}"
        )


def _unsure(first, second):
    """What to add where the shapes might be apart all the same."""
    return "" if _told(first, second) else ", or are too near for their bounds and bounding balls to tell them apart"


def _told(first, second):
    """Whether bounds and balls tell all of two shapes."""
    return all(_is_ball(shape) or shape.fills_bounds for shape in (first, second))


def _is_ball(shape):
    center, radius = shape.ball()
    # Of two lengths that are equal but for rounding.
    return shape.bounded and -shape.sure_distance(center[None])[0] >= radius * (1 - 1e-9)


def _crossed(first, second):
    """Whether both end along one axis only, and not along the same."""
    ends = [np.isfinite(shape.bounds()[0]) for shape in (first, second)]
    return all(e.sum() == 1 for e in ends) and np.any(ends[0] != ends[1])


def _apart(first, second, cell):
    for one, other in ((first, second), (second, first)):
        center, radius = one.ball()
        if one.bounded and other.sure_distance(center[None], period=cell.period)[0] >= radius - cell.tolerance:
            return True
    beside = any(
        all(d <= a + cell.tolerance or b <= c + cell.tolerance for a, b in before for c, d in after)
        for before, after in zip(_spans(first, cell), _spans(second, cell), strict=True)
    )
    return beside or (not _told(first, second) and parted(first, second, cell.box, cell.period, cell.tolerance))


def _holds_all(outer, inner, cell):
    """Whether each part of a shape lies in one part of another."""
    return all(any(_holds(one, other, cell) for one in outer.parts) for other in inner.parts)


def _holds(outer, inner, cell):
    if outer.fills_bounds and all(
        _covers(a, b, cell.tolerance) for a, b in zip(_spans(outer, cell), _spans(inner, cell), strict=True)
    ):
        return True
    if not _told(outer, inner) and nested(outer, inner, cell.box, cell.period, cell.tolerance):
        return True
    if not inner.bounded:
        return False
    center, radius = inner.ball()
    if outer.sure_distance(center[None], period=cell.period)[0] <= cell.tolerance - radius:
        return True
    return outer.convex and outer.bounded and _holds_corners(outer, inner, cell)


def _holds_corners(outer, inner, cell):
    """Whether a bounded shape holds the corners of another's bounds, and so, convex, all of it."""
    (middle, _), (center, _) = outer.ball(), inner.ball()
    corners = np.array(list(product(*zip(*inner.bounds(), strict=True)))) - center
    # By the image whose middle is nearest to the middle of the outer one, not corner by corner.
    here = middle + nearest(center - middle, cell.period) + corners
    return bool(np.all(outer.distance(here) <= cell.tolerance))


def _spans(shape, cell):
    """Intervals of the box that a shape takes along each axis; two if it crosses a periodic face."""
    found = []
    for low, high, length in zip(*shape.bounds(), cell.size, strict=True):
        if cell.period is not None and np.isfinite(low):
            turns = np.floor(0.5 * (low + high) / length) * length
            low, high = low - turns, high - turns
        spans = [(max(low, 0.0), min(high, length))]
        if cell.period is not None and np.isfinite(low):
            spans += [(low + length, length)] if low < -cell.tolerance else []
            spans += [(0.0, high - length)] if high > length + cell.tolerance else []
        found.append(spans)
    return found


def _covers(outer, inner, tolerance):
    return all(any(a <= c + tolerance and d <= b + tolerance for a, b in outer) for c, d in inner)
