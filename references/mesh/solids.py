"""How fine a mesh must be beside the surfaces of shapes other than spheres and layers, by samples of them."""

from functools import partial
from itertools import product

import numpy as np

from demheat.scene.shapes.base import Shape
from demheat.scene.shapes.directions import across
from demheat.scene.shapes.periodic import shifts
from demheat.scene.shapes.samples import surface_points

# Samples of a surface along its least length, at least, and along the longest edge of the box, at most.
ALONG, FINEST = 4, 200
# Steps downhill, to where two surfaces are nearest.
ROUNDS = 60
# Cosine from which on a wall faces a surface rather than cuts it.
FACING = 0.9


def known(shape: Shape) -> bool:
    """Whether a shape has a volume of OpenCASCADE."""
    return type(shape).cad is not Shape.cad


def sized(scene, size: float, planes, rules) -> np.ndarray:
    """Balls in which edges must be short beside the surfaces of solids, and between them and others."""
    found = [np.zeros((0, 5))]
    for number, shape in enumerate(scene.inclusions):
        if known(shape) and not (shape.flat or shape.fills_ball):
            found.append(_beside(scene, number, planes, rules, size))
    rows = np.concatenate(found)
    if scene.periodic and len(rows):
        shifts = np.array(list(product((0, -1, 1), repeat=3))) * scene.size
        centers = (rows[:, :3] % scene.size + shifts[:, None]).reshape(-1, 3)
        rows = np.column_stack([centers, np.tile(rows[:, 3:], (len(shifts), 1))])
    outside = np.maximum(0, np.maximum(-rows[:, :3], rows[:, :3] - scene.size))
    return rows[np.linalg.norm(outside, axis=1) < rows[:, 3] + size]


def _beside(scene, number, planes, rules, size):
    """Rows of one shape."""
    on, in_gap, far, narrowest = rules
    shape, box = scene.inclusions[number], np.array(scene.size)
    least = _least(shape, box)
    pitch = max(least / ALONG, box.max() / FINEST)
    low, high = shape.bounds()
    low, high = np.where(np.isfinite(low), low, 0.0), np.where(np.isfinite(high), high, box)
    if not scene.periodic:
        low, high = np.maximum(low, 0.0), np.minimum(high, box)
    points, _ = surface_points(shape, low - 1e-3 * pitch, high + 1e-3 * pitch, pitch)
    gap = np.full(len(points), np.inf)
    for other_number, other in enumerate(scene.inclusions):
        if not other.flat:
            gap = np.minimum(gap, _to_other(scene, (number, other_number), points, narrowest, far * least))
    gap = np.minimum(gap, _to_planes(scene, shape, points, planes, narrowest))
    width = np.sqrt(gap * least)
    # Flat faces need no more than a layer does: one element through it.
    along = min((2.0 if _faceted(part) else on) * _least(part, box) for part in shape.parts)
    edge = np.minimum(along, np.where(gap < far * least, in_gap * width, np.inf))
    return _thinned(points, edge, size)


def _thinned(points, edge, size):
    """Of points in each cell about as wide as the edges wanted there one, with the shortest: few, and dense enough."""
    kept = np.flatnonzero(edge < size)
    kept = kept[np.argsort(edge[kept], kind="stable")]
    wide = 2.0 ** np.floor(np.log2(edge[kept]))
    _, first = np.unique(np.column_stack([np.floor(points[kept] / wide[:, None]), wide]), axis=0, return_index=True)
    kept = kept[first]
    return np.column_stack([points[kept], wide[first], edge[kept]])


def _to_other(scene, numbers, points, narrowest, reach):
    """Distance of points of one surface to another, or to its own images; refused if they touch.

    Where nothing is nearer than a reach, none can.
    """
    shape, other = (scene.inclusions[number] for number in numbers)
    own = numbers[0] == numbers[1]
    # In a periodic cell another one is the nearest of its images.
    period, moved = (None, shifts(shape, scene.period)) if own else (scene.period, [np.zeros(3)])
    least = np.full(len(points), np.inf)
    for shift in moved:
        gap = _away(other, shift, period, points)
        least = np.minimum(least, gap)
        if gap.min() > reach:
            continue
        x, narrow = _narrowest(scene, shape, points[np.argmin(gap)], partial(_away, other, shift, period))
        if narrow < narrowest * max(scene.size) and _in_box(scene, x):
            raise NotImplementedError(
                f"a {shape.kind}, Scene.inclusions[{numbers[0]}], and [{numbers[1]}] touch at {x}: the cusp between "
                "touching surfaces has no valid elements; leave a gap"
            )
    return least


def _away(shape, shift, period, points):
    """Distance to the surface of a shape that is moved."""
    return np.abs(shape.distance(points - shift, period=period))


def _narrowest(scene, shape, x, distance):
    """Where on a surface another one is nearest, by smaller and smaller steps downhill, and how near it is."""
    step, gap = 0.1 * _least(shape, np.array(scene.size)), distance(x[None])[0]
    angle = np.pi * np.arange(8) / 4
    for _ in range(ROUNDS):
        normal = shape.normal(x[None])[0]
        one, other = across(normal)
        around = x + step * (np.outer(np.cos(angle), one) + np.outer(np.sin(angle), other))
        away, outward = shape.surface(around)
        around -= away[:, None] * outward
        gaps = distance(around)
        best = int(np.argmin(gaps))
        if gaps[best] < gap:
            x, gap = around[best], gaps[best]
        else:
            step /= 2
    return x, gap


def _to_planes(scene, shape, points, planes, narrowest):
    """Distance of points to planes that face the surface there."""
    normals, least = shape.normal(points), np.full(len(points), np.inf)
    low, high = shape.bounds()
    for axis in range(3):
        facing, length = np.abs(normals[:, axis]) > FACING, scene.size[axis]
        for at in planes[axis]:
            ends = np.array([low[axis], high[axis]]) - at
            ends -= length * np.round(ends / length) if scene.periodic and np.isfinite(low[axis]) else 0.0
            # Faces may lie in planes.
            if np.abs(ends).min() < narrowest * max(scene.size) and not _faceted(shape):
                raise NotImplementedError(
                    f"a {shape.kind} at {shape.center} touches the plane {'xyz'[axis]} = {at:.6g} m: the cusp between "
                    "touching surfaces has no valid elements; leave a gap"
                )
            gap = np.abs(points[:, axis] - at)
            least = np.minimum(least, np.where(facing & (gap > narrowest * max(scene.size)), gap, np.inf))
    return least


def _in_box(scene, x):
    return scene.periodic or bool(np.all((x >= 0) & (x <= scene.size)))


def _least(shape, box):
    """Least length that a mesh must follow, m: half the width of what has one."""
    return shape.depth if np.isfinite(shape.depth) else float(box.max())


def _faceted(shape):
    """Whether it ends, and all its faces are planes."""
    return shape.bounded and shape.planes() is not None
