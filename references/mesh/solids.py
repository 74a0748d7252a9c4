"""Cylinders, ellipsoids, boxes, half-spaces and unions as gmsh makes them, and how fine a mesh must be beside them."""

from __future__ import annotations

from functools import partial, singledispatch
from itertools import product

import numpy as np

from demheat.scene import Box, Cylinder, Ellipsoid, HalfSpace, Shape, Sphere, Union
from demheat.scene.shapes.base import shifts
from demheat.scene.shapes.directions import across
from demheat.scene.shapes.samples import surface_points
from references.mesh.turns import GENERIC

# What has a solid here, spheres and layers aside.
KNOWN = (Cylinder, Ellipsoid, Box, HalfSpace, Union)
# Samples of a surface along its least length, at least, and along the longest edge of the box, at most.
ALONG, FINEST = 4, 200
# Steps downhill, to where two surfaces are nearest.
ROUNDS = 60
# Cosine from which on a wall faces a surface rather than cuts it.
FACING = 0.9


@singledispatch
def add(shape: Shape, occ, box, scale: float) -> int:
    """Add a shape to the geometry; see `references.mesh.cad.solid`."""
    raise NotImplementedError(f"meshes around inclusions of shape {type(shape).__name__}: not known here")


@add.register
def _(shape: Cylinder, occ, box, scale):
    points, _ = shape.hull(box * scale) if shape.length is None else (_ends(shape), 0.0)
    start, stop = points / scale
    tag = occ.addCylinder(*start, *(stop - start), shape.radius / scale)
    # Its seam off the planes of symmetry, which may be faces of the box.
    occ.rotate([(3, tag)], *start, *shape.axis, GENERIC[3])
    return tag


@add.register
def _(shape: Ellipsoid, occ, box, scale):
    tag = occ.addSphere(0, 0, 0, 1)
    occ.rotate([(3, tag)], 0, 0, 0, *GENERIC)
    occ.dilate([(3, tag)], 0, 0, 0, *(np.array(shape.semi_axes) / scale))
    return _placed(occ, tag, shape.rotation, np.array(shape.center) / scale)


@add.register
def _(shape: Box, occ, box, scale):
    sides = np.array(shape.sides) / scale
    tag = occ.addBox(*(-sides / 2), *sides)
    return _placed(occ, tag, shape.rotation, np.array(shape.center) / scale)


@add.register
def _(shape: HalfSpace, occ, box, scale):
    wide = 2 * np.linalg.norm(box)
    tag = occ.addBox(-wide, -wide, -2 * wide, 2 * wide, 2 * wide, 2 * wide)
    normal = np.array(shape.outward)
    # The point of its plane that is nearest to the middle: the box is then wide enough around it.
    middle = box / 2 - shape.distance(scale * box[None] / 2)[0] / scale * normal
    return _placed(occ, tag, np.stack([*across(normal), normal], axis=1), middle)


@add.register
def _(shape: Sphere, occ, box, scale):
    # Of a union: its poles off the planes of symmetry.
    center = np.array(shape.center) / scale
    tag = occ.addSphere(*center, shape.radius / scale)
    occ.rotate([(3, tag)], *center, *GENERIC)
    return tag


@add.register
def _(shape: Union, occ, box, scale):
    first, *rest = ((3, add(member, occ, box, scale)) for member in shape.shapes)
    pieces, _ = occ.fuse([first], rest)
    if len(pieces) != 1:
        raise NotImplementedError(
            f"a union of shapes at {shape.center} is {len(pieces)} pieces: meshes know one; give each piece for itself"
        )
    return pieces[0][1]


def sized(scene, size: float, planes, rules) -> np.ndarray:
    """Balls in which edges must be short beside the surfaces of solids, and between them and others."""
    found = [np.zeros((0, 5))]
    for number, shape in enumerate(scene.inclusions):
        if isinstance(shape, KNOWN):
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
    along = min(min(part.sides) if isinstance(part, Box) else on * _least(part, box) for part in shape.parts)
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
            if np.abs(ends).min() < narrowest * max(scene.size) and not isinstance(shape, Box):
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
    if isinstance(shape, Union):
        return min(_least(member, box) for member in shape.shapes)
    if shape.fills_ball:
        return shape.ball()[1]
    if isinstance(shape, Cylinder):
        return shape.radius if shape.length is None else min(shape.radius, shape.length / 2)
    if isinstance(shape, Ellipsoid):
        return min(shape.semi_axes)
    return min(shape.sides) / 2 if isinstance(shape, Box) else float(box.max())


def _ends(shape):
    half = 0.5 * shape.length * np.array(shape.axis)
    return np.array(shape.center) + np.array([-half, half])


def _placed(occ, tag, rotation, center):
    """Turn a body at the origin and move it."""
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_matrix(np.array(rotation)).as_rotvec()
    angle = float(np.linalg.norm(turn))
    if angle > 0:
        occ.rotate([(3, tag)], 0, 0, 0, *(turn / angle), angle)
    occ.translate([(3, tag)], *center)
    return tag
