"""The surface of a set that is known by its inside alone: found by bisection, kept as a table of distances.

A function whose values say how far the surface is, and whose gradient says which way, leads to it by Newton's steps. A
sign, a mask, a distance that is cut off, squared or cubed does not: only the change of its sign can be trusted. Where
neighbours on a grid differ, bisection finds the surface between them, bisection beside that the normal, and bisection
along the normal the distances of the nodes nearby. A spline between the nodes is the distance everywhere.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

# Cells along the longest side of the limits: of the table, and where a function's own values are tried.
CELLS, TRIED = 64, 16
# Cells of the table beyond the limits, and within which nodes are measured; others are right to half a cell.
BEYOND, BAND = 3, 4.0
# Halvings: of a cell to a billionth of it.
HALVINGS = 30
# Pairs of neighbours that a surface parts, over nodes inside: of a plate two cells thick 1, of cells at random 3.
ROUGH = 1.5
# In cells: where beside a point of the surface its height is taken, and how far up and down the surface is sought.
ASIDE, SOUGHT = 0.25, 0.5
# Of a tried cell, within which Newton's steps must end on the surface; the share of them that may not, and of nodes
# anywhere that may be told to lie at less than half of their distance.
ON, MISSED, UNDER = 1e-4, 0.25, 0.02
# Of a table, the share of points near the surface that may be on the other side, a quarter of a cell or more from it.
WRONG = 0.02


@dataclass(frozen=True, eq=False)
class Traced:
    """Distances to a surface at the nodes of a grid, and between them."""

    low: np.ndarray  # (3,) float array, m: The first node
    pitch: float  # m
    spline: np.ndarray  # (nx, ny, nz) float array, m: Coefficients of cubic splines
    slopes: tuple[np.ndarray, np.ndarray, np.ndarray]  # tuple of three (nx, ny, nz) float arrays: Gradient at the nodes

    def distance(self, points):
        """Distance to the surface, negative inside, (n,) float array, m."""
        from scipy.ndimage import map_coordinates

        place, beyond = self._places(points)
        return map_coordinates(self.spline, place, order=3, prefilter=False, mode="mirror") + beyond

    def normal(self, points):
        """Gradient of the distance, of length 1, (n, 3) float array."""
        from scipy.ndimage import map_coordinates

        place, _ = self._places(points)
        return unit(np.stack([map_coordinates(each, place, order=1, mode="nearest") for each in self.slopes], axis=1))

    def placed(self, shift):
        """The same surface elsewhere."""
        return replace(self, low=self.low + shift)

    def turned(self, order: Sequence[int]):
        """The same surface with axes order[0], order[1], order[2] as axes 0, 1, 2."""
        slopes = tuple(self.slopes[axis].transpose(order) for axis in order)
        return replace(self, low=self.low[list(order)], spline=self.spline.transpose(order), slopes=slopes)

    def _places(self, points):
        """In cells from the first node, of the nearest point of the grid, and how far that is, m."""
        high = self.low + self.pitch * (np.array(self.spline.shape) - 1)
        nearest = np.clip(points, self.low, high)
        return ((nearest - self.low) / self.pitch).T, np.linalg.norm(points - nearest, axis=1)


def leads(onto: Callable, inside: Callable, low, high, period=None) -> bool:
    """Whether Newton's steps along a function's gradient find its surface, which repeats if there is a period."""
    from scipy.spatial import cKDTree

    nodes, pitch, solid = _grid(low, high, TRIED, 0, inside)
    one, other = _crossed(nodes, solid)
    if not len(one):
        return True
    surface = _bisected(one, other, inside)
    near, points = np.concatenate([one, other]), nodes.reshape(-1, 3)
    feet = onto(near)
    way = unit(feet - near) * ON * pitch
    off = inside(feet - way) == inside(feet + way)
    if period is not None:
        surface = np.concatenate([surface + np.array(step) * period for step in product((-1, 0, 1), repeat=3)])
    away, _ = cKDTree(surface).query(points)
    under = np.linalg.norm(onto(points) - points, axis=1) < 0.5 * (away - np.sqrt(3) * pitch)
    return bool(off.mean() <= MISSED and under.mean() <= UNDER)


def traced(inside: Callable, low, high) -> Traced | None:
    """The surface of a set, or None if it is too rough for a grid."""
    from scipy.ndimage import distance_transform_edt, spline_filter
    from scipy.spatial import cKDTree

    nodes, pitch, solid = _grid(low, high, CELLS, BEYOND, inside)
    one, other = _crossed(nodes, solid)
    if not len(one) or len(one) > ROUGH * solid.sum():
        return None
    surface = _bisected(one, other, inside)
    normals = _normals(surface, _rough_normals(surface, nodes[0, 0, 0], pitch, solid), pitch, inside)
    # By the nearest node of the other side, half a cell too far in the mean.
    away = pitch * (np.where(solid, distance_transform_edt(solid), distance_transform_edt(~solid)).ravel() - 0.5)
    near = np.flatnonzero(away <= BAND * pitch)
    points = nodes.reshape(-1, 3)[near]
    apart, own = cKDTree(surface).query(points)
    away[near] = np.minimum(apart, _heights(points, surface[own], normals[own], pitch, inside))
    distance = np.where(solid, -1.0, 1.0) * away.reshape(solid.shape)
    table = Traced(nodes[0, 0, 0], pitch, spline_filter(distance, 3), tuple(np.gradient(distance, pitch)))
    tried = surface + pitch * np.random.default_rng(0).uniform(-1, 1, surface.shape)
    told = table.distance(tried)
    clear = np.abs(told) > 0.25 * pitch
    wrong = (told[clear] < 0) != inside(tried[clear])
    return table if len(wrong) and wrong.mean() <= WRONG else None


def unit(vectors):
    """Vectors of length 1, along x where there is none."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.divide(vectors, length, out=np.tile([1.0, 0.0, 0.0], (len(vectors), 1)), where=length > 0)


def _grid(low, high, cells, beyond, inside):
    """Nodes of cubes all over a box and some beyond, their side, and which nodes are inside."""
    pitch = float((high - low).max()) / cells
    counts = np.ceil((high - low) / pitch * (1 - 1e-12)).astype(int) + 1 + 2 * beyond
    first = 0.5 * (low + high) - 0.5 * pitch * (counts - 1)
    nodes = first + pitch * np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1)
    # Slice by slice: no array of points as large as the grid is asked about at once.
    return nodes, pitch, np.stack([inside(each.reshape(-1, 3)).reshape(each.shape[:2]) for each in nodes])


def _crossed(nodes, solid):
    """Neighbours on a grid of which one is inside, first those, then the others, two (n, 3) float arrays, m."""
    ends = [], []
    for axis in range(3):
        here, there = (np.moveaxis(each, axis, 0) for each in (solid, nodes))
        for into in (True, False):
            where = (here[:-1] == into) & (here[1:] != into)
            first, last = there[:-1][where], there[1:][where]
            ends[0].append(first if into else last)
            ends[1].append(last if into else first)
    return np.concatenate(ends[0]), np.concatenate(ends[1])


def _bisected(one, other, inside):
    """Where the surface is between points inside and points that are not, (n, 3) float array, m."""
    one, other = one.copy(), other.copy()
    for _ in range(HALVINGS):
        middle = 0.5 * (one + other)
        held = inside(middle)
        one[held], other[~held] = middle[held], middle[~held]
    return 0.5 * (one + other)


def _rough_normals(surface, first, pitch, solid):
    """Outward normals by how much is inside nearby."""
    from scipy.ndimage import gaussian_filter, map_coordinates

    share, place = gaussian_filter(solid.astype(float), 1.5), ((surface - first) / pitch).T
    return unit(-np.stack([map_coordinates(each, place, order=1) for each in np.gradient(share)], axis=1))


def _normals(surface, rough, pitch, inside):
    """Outward normals by the heights of the surface at four points around each; rough ones where there are none."""
    first = unit(np.cross(rough, np.eye(3)[np.argmin(np.abs(rough), axis=1)]))
    tangents = np.stack([first, np.cross(rough, first)], axis=1)
    normals, found = rough.copy(), np.ones(len(rough), bool)
    for axis in range(2):
        sides = [surface + sign * ASIDE * pitch * tangents[:, axis] for sign in (1, -1)]
        one, other = (_height(side, rough, np.zeros(len(side)), pitch, inside) for side in sides)
        slope = (one - other) / (2 * ASIDE * pitch)
        found &= np.isfinite(slope)
        normals -= np.where(np.isfinite(slope), slope, 0.0)[:, None] * tangents[:, axis]
    return np.where(found[:, None], unit(normals), rough)


def _height(points, normals, about, pitch, inside):
    """Of the surface above points along normals, near a height; NaN where it is not found, (n,) float array, m."""
    deep = points + (about - SOUGHT * pitch)[:, None] * normals
    high = points + (about + SOUGHT * pitch)[:, None] * normals
    good = inside(deep) & ~inside(high)
    height = np.full(len(points), np.nan)
    there = _bisected(deep[good], high[good], inside)
    height[good] = np.einsum("ij,ij->i", there - points[good], normals[good])
    return height


def _heights(points, feet, normals, pitch, inside):
    """Distances of points from the surface along the normals of points of it; infinite where it is not found."""
    about = np.einsum("ij,ij->i", feet - points, normals)
    return np.nan_to_num(np.abs(_height(points, normals, about, pitch, inside)), nan=np.inf)
