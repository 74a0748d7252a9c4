"""Certain answers of convex shapes: a plane that parts two of them, or what holds all of one in the other.

How a plane is sought decides whether it is found, not whether it is right: how far a convex shape reaches along a
direction is known in closed form.
"""

from itertools import product

import numpy as np

from demheat.scene.shapes.base import Shape
from demheat.scene.shapes.periodic import nearest

# Of projections onto both shapes in turn, at most.
ROUNDS = 60


def parted(one: Shape, other: Shape, box, period, tolerance: float) -> bool:
    """Whether planes are found that part a shape from all images of another; they may touch.

    Shapes that touch, or nearly do, where neither has a corner or a face may be missed.
    """
    if not (one.convex and other.convex):
        return False
    size = period if box is None else box
    return all(_plane(one, other, shift, (size, box), tolerance) for shift in _shifts(one, other, size, period))


def nested(outer: Shape, inner: Shape, box, period, tolerance: float) -> bool:
    """Whether a convex shape surely holds another, by the planes of the one or by balls or corners around the other."""
    if not outer.convex:
        return False
    size = period if box is None else box
    # The nearest image first; of a half-space or an endless cylinder it is the only one.
    shift = next(_shifts(outer, inner, size, period))
    if outer.encloses(inner, shift):
        return True
    if (planes := outer.planes()) is not None:
        reaches = [inner.reach(normal, box) + normal @ shift for normal in planes[0]]
        return bool(np.all(np.array(reaches) <= planes[1] + tolerance))
    found = inner.hull(box)
    return found is not None and bool(np.all(outer.sure_distance(found[0] + shift) <= tolerance - found[1]))


def _shifts(one, other, size, period):
    """By what images of the other are moved that may meet the one, the nearest first; none but itself between walls."""
    if period is None:
        yield np.zeros(3)
        return
    (low, high), (start, stop) = one.bounds(), other.bounds()
    # What has no end along an axis goes on in itself.
    ends = np.isfinite(low) & np.isfinite(start)
    apart = np.where(ends, _anchor(other, size) - _anchor(one, size), 0.0)
    home = nearest(apart, period) - apart
    for shift in product(*((0, -1, 1) if end else (0,) for end in ends)):
        moved = home + np.array(shift) * period
        if not any(shift) or np.all((start + moved < high) & (low < stop + moved)):
            yield moved


def _plane(one, other, shift, room, tolerance):
    """Whether a plane is found that parts a shape from another, moved."""
    size, box = room

    def parts(direction):
        length = np.linalg.norm(direction)
        if length == 0:
            return False
        unit = direction / length
        return one.reach(unit, box) + other.reach(-unit, box) - unit @ shift <= tolerance

    here = _anchor(one, size)
    if parts(_anchor(other, size) + shift - here):
        return True
    for _ in range(ROUNDS):
        there = _foot(other, here - shift) + shift
        here = _foot(one, there)
        normals = other.normal((here - shift)[None])[0], one.normal(there[None])[0]
        if parts(there - here) or parts(-normals[0]) or parts(normals[1]):
            return True
        if np.linalg.norm(there - here) <= tolerance:
            return False
    return False


def _foot(shape, point):
    """The point of a shape that is nearest to another."""
    gap = shape.distance(point[None])[0]
    return point if gap <= 0 else point - gap * shape.normal(point[None])[0]


def _anchor(shape, size):
    """A point of a shape, the same whatever the box."""
    center = getattr(shape, "center", None)
    return np.array(center) if center is not None else shape.point_in(size, periodic=False)
