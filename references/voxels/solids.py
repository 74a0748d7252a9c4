"""Voxels and links that the surface of any shape cuts, by its distance and normal alone.

A cut voxel is taken apart into smaller ones, in each of which the surface is the plane that is nearest to its middle.
What that lacks of a bent surface is its sagitta there, of second order in the small voxel's side, and of one sign where
the shape is convex: where the volume is known, the surface is moved by the one small length that makes it right.
"""

import math

import numpy as np

from demheat.scene.shapes.base import Shape
from demheat.scene.shapes.samples import SLACK
from demheat.scene.shapes.sections import below

# Smaller voxels along a side of a cut one, down to one where there are so many cut ones that they are small themselves.
PIECES = ((200_000, 3), (1_000_000, 2), (math.inf, 1))
# Axes of the entries of a moment.
PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
# Steps to the offset of the right volume, and its relative error from which on it is right.
STEPS, RIGHT = 6, 1e-12
# Of a shape over the grid, from which on what lies beyond the grid is left out.
WIDEST = 3.0
# Steps to where a link crosses the surface, and to where it is deepest within.
CROSSING, DEEPEST = 16, 24
# Nodes of links that are looked at together: bounds the scratch memory.
BLOCK = 2**18


def window(shape: Shape, counts, spacing, *, clipped: bool) -> tuple[np.ndarray, np.ndarray]:
    """First voxel of a shape's bounds along each axis, and the one after the last, two (3,) int arrays."""
    low, high = shape.bounds()
    first, last = np.floor(low / spacing), np.ceil(high / spacing)
    ends = np.isfinite(low) & ~clipped
    # In voxels, not in metres: so many times a spacing over the spacing may be a bit more than so many.
    first, last = (np.where(ends, each, np.clip(each, 0, counts)) for each in (first, last))
    return first.astype(int), last.astype(int)


def cut_voxels(shape: Shape, counts, spacing) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Voxels of a grid that the surface of one image of a shape cuts."""
    box, (low, high) = np.array(counts) * spacing, shape.bounds()
    # Of what reaches far beyond the grid only what is on it is looked at, and its volume is as planes have it.
    clipped = bool(np.any(np.isfinite(low) & (high - low > WIDEST * box)))
    places, whole = _near(shape, counts, spacing, clipped)
    pieces = next(number for most, number in PIECES if len(places) <= most)
    small = spacing / pieces
    steps = (np.stack(np.meshgrid(*[np.arange(pieces)] * 3, indexing="ij"), axis=-1).reshape(-1, 3) + 0.5) / pieces
    points = ((places[:, None] + steps) * spacing).reshape(-1, 3)
    height, normal = shape.surface(points)
    volume, offset = None if clipped else _volume(shape, box), 0.0
    for _ in range(STEPS):
        part, area = below(normal, height + offset, small)
        excess = math.prod(small) * part.sum() + math.prod(spacing) * whole - (volume or 0.0)
        if volume is None or abs(excess) <= RIGHT * volume or not area.any():
            break
        offset += excess / area.sum()
    on_grid = np.all((places >= 0) & (places < counts), axis=1)
    fraction = part.reshape(len(places), -1).mean(axis=1)[on_grid]
    moment = np.stack([(area * normal[:, a] * normal[:, b]).reshape(len(places), -1).sum(axis=1) for a, b in PAIRS], 1)
    index = np.ravel_multi_index(places[on_grid].T, counts).astype(np.int64)
    order = np.argsort(index)
    return index[order], fraction[order], moment[on_grid][order]


def _near(shape, counts, spacing, clipped):
    """Voxels that the surface may cut, also beyond the grid, and the number of those that are all inside."""
    low, high = window(shape, np.array(counts), spacing, clipped=clipped)
    half, found, whole = 0.5 * np.linalg.norm(spacing), [np.empty((0, 3), int)], 0
    for x in range(low[0], high[0]):
        grid = np.meshgrid([x], np.arange(low[1], high[1]), np.arange(low[2], high[2]), indexing="ij")
        places = np.stack(grid, axis=-1).reshape(-1, 3)
        distance = shape.distance((places + 0.5) * spacing)
        near = np.abs(distance) <= SLACK * half
        whole += int(np.sum(~near & (distance < 0)))
        found.append(places[near])
    return np.concatenate(found), whole


def _volume(shape, box):
    """Volume of all that was looked at; None if it is unknown."""
    if shape.bounded:
        return shape.volume
    low, high = shape.bounds()
    try:
        # Where it ends, all of it is looked at.
        return shape.volume_in(np.where(np.isfinite(low), high - low, box), periodic=True)
    except NotImplementedError:
        return None


def inside_parts(shape: Shape, counts, spacing, axis: int) -> tuple[np.ndarray, np.ndarray]:
    """What lies in a shape of the links along an axis between middles of voxels, and of the halves at both ends."""
    others = [a for a in range(3) if a != axis]
    low, high = window(shape, np.array(counts), spacing, clipped=True)
    grid = np.meshgrid(*(np.arange(low[a], high[a]) for a in others), indexing="ij")
    rows = np.stack([each.ravel() for each in grid], axis=1)
    n, h = counts[axis], spacing[axis]
    nodes = np.clip((np.arange(n + 2) - 0.5) * h, 0.0, n * h)
    blocks = np.array_split(rows, max(1, len(rows) * n // BLOCK))
    inside = [_row_parts(shape, block, nodes, others, (axis, spacing)) / h for block in blocks]
    return rows, np.concatenate(inside)


def _row_parts(shape, rows, nodes, others, way):
    """Lengths inside of the pieces between nodes along some rows of links, (rows, nodes - 1) float array, m."""
    axis, spacing = way

    def distance(row, x):
        points = np.empty((len(row), 3))
        points[:, others] = (rows[row] + 0.5) * spacing[others]
        points[:, axis] = x
        return shape.distance(points)

    number = np.repeat(np.arange(len(rows)), len(nodes))
    gap = distance(number, np.tile(nodes, len(rows))).reshape(len(rows), -1)
    first, last = gap[:, :-1], gap[:, 1:]
    length = np.diff(nodes)
    inside = np.where((first <= 0) & (last <= 0), length, 0.0)
    row, piece = np.nonzero((first <= 0) != (last <= 0))
    x = _crossed(lambda x: distance(row, x), nodes[piece], nodes[piece + 1], first[row, piece], last[row, piece])
    inside[row, piece] = np.where(first[row, piece] <= 0, x - nodes[piece], nodes[piece + 1] - x)
    # Out at both ends, but not so far that nothing between can be in.
    row, piece = np.nonzero((first > 0) & (last > 0) & (first + last < length))
    deep, least = _deepest(lambda x: distance(row, x), nodes[piece], nodes[piece + 1])
    row, piece, deep, least = (column[least < 0] for column in (row, piece, deep, least))
    ends = [_crossed(lambda x: distance(row, x), nodes[end], deep, gap[row, end], least) for end in (piece, piece + 1)]
    inside[row, piece] = ends[1] - ends[0]
    return inside


def _crossed(distance, one, other, first, last):
    """Where a distance of two signs is 0 between two coordinates (false position, Illinois)."""
    one, other, first, last = (np.array(column, dtype=float) for column in (one, other, first, last))
    for _ in range(CROSSING):
        total = last - first
        x = np.where(total != 0, other - last * (other - one) / np.where(total != 0, total, 1.0), other)
        here = distance(x)
        same = (here <= 0) == (last <= 0)
        one, first = np.where(same, one, other), np.where(same, 0.5 * first, last)
        other, last = x, here
    return other


def _deepest(distance, low, high):
    """Where a distance is least between two coordinates, if it has one least value, and that."""
    low, high = np.array(low, dtype=float), np.array(high, dtype=float)
    for _ in range(DEEPEST):
        one, other = low + (high - low) / 3, high - (high - low) / 3
        nearer = distance(one) < distance(other)
        low, high = np.where(nearer, low, one), np.where(nearer, other, high)
    middle = 0.5 * (low + high)
    return middle, distance(middle)
