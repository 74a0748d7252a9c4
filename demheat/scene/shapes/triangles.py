"""A closed surface of triangles: whether it is one, what it holds, and how far from it points are."""

from functools import cached_property

import numpy as np

from demheat.scene.beats import beat
from demheat.scene.shapes.bins import runs

# Along a ray no face of a body that is drawn along its axes stands on edge.
TURN = np.linalg.qr(np.array([[0.91, -0.27, 0.31], [0.36, 0.88, -0.29], [-0.21, 0.38, 0.90]]))[0]
# Points, and pairs of triangles, that are looked at together.
BLOCK, PAIRS = 1 << 15, 1 << 18
# Pieces by which near triangles are found: of the diagonal at most so long; how many of them are looked at.
PIECE, NEAREST = 1 / 80, 12
# Twice the least area of a triangle, of the square of its longest edge: below it is a line.
THIN = 1e-12


class Triangles:
    """What a closed surface holds: odd numbers of its sheets lie above it; and the nearest of its points.

    Distances are exact where they are shorter than a piece is long, elsewhere too long by a piece at most.
    """

    def __init__(self, vertices: np.ndarray, triangles: np.ndarray):
        self.vertices, self.triangles = vertices, triangles
        self.corners = vertices[triangles]
        across = np.cross(self.corners[:, 1] - self.corners[:, 0], self.corners[:, 2] - self.corners[:, 0])
        self.areas = 0.5 * np.linalg.norm(across, axis=1)
        self.normals = across / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-300)

    @property
    def volume(self) -> float:
        """What it encloses, m3: by the divergence theorem."""
        a, b, c = np.moveaxis(self.corners, 1, 0)
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)

    def holds(self, points: np.ndarray) -> np.ndarray:
        """Which points lie inside, (n,) bool array."""
        low, cell, start, entries, turned, planes = self._columns
        count = len(start) - 1
        side = int(np.sqrt(count))
        found = np.zeros(len(points), bool)
        for begin in range(0, len(points), BLOCK):
            beat("points in a mesh")
            own = points[begin : begin + BLOCK] @ TURN
            place = np.floor((own[:, :2] - low) / cell).astype(int)
            within = np.flatnonzero(np.all((place >= 0) & (place < side), axis=1))
            key = place[within, 0] * side + place[within, 1]
            many = start[key + 1] - start[key]
            point, triangle = np.repeat(within, many), entries[runs(start[key], many)]
            above = _under(own[point], turned, self.triangles[triangle], planes[triangle])
            found[begin : begin + len(own)] = np.bincount(point[above], minlength=len(own)) % 2 == 1
        return found

    def heights(self, point: np.ndarray) -> np.ndarray:
        """How far along a generic direction through a point, and back, the surface is met, ascending, m."""
        *_, turned, planes = self._columns
        own = np.broadcast_to(np.array([*(point @ TURN)[:2], -np.inf]), (len(self.triangles), 3))
        met = planes[_under(own, turned, self.triangles, planes)]
        return np.sort(met @ [*(point @ TURN)[:2], 1.0] - (point @ TURN)[2])

    def feet(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The nearest point of the surface to each, (n, 3) float array, and its triangle."""
        tree, parents = self._pieces
        feet, own = np.empty((len(points), 3)), np.empty(len(points), int)
        for begin in range(0, len(points), BLOCK):
            beat("points beside a mesh")
            part = points[begin : begin + BLOCK]
            near = parents[tree.query(part, min(NEAREST, len(parents)))[1].reshape(len(part), -1)]
            feet[begin : begin + len(part)], own[begin : begin + len(part)] = self._nearest_of(part, near)
        return feet, own

    def _nearest_of(self, points, near):
        """The nearest point of some triangles of each point, (n, few) int array, the first of equals; and whose it is.

        Pieces of one triangle are side by side: of a large one nearly all are, which is looked at once.
        """
        new = np.ones(near.shape, bool)
        for number in range(1, near.shape[1]):
            new[:, number] = np.all(near[:, :number] != near[:, number, None], axis=1)
        rows, columns = np.nonzero(new)
        there = _nearest_in(points[rows], *np.moveaxis(self.corners[near[rows, columns]], 1, 0))
        away = np.full(near.shape, np.inf)
        away[rows, columns] = np.sum((there - points[rows]) ** 2, axis=1)
        best = np.argmin(away, axis=1)
        place = np.empty(near.shape, int)
        place[rows, columns] = np.arange(len(rows))
        each = np.arange(len(points))
        return there[place[each, best]], near[each, best]

    @cached_property
    def _columns(self):
        """Columns that triangles stand in, along a generic direction: cells, what is in them, points and planes."""
        turned = self.vertices @ TURN
        flat = turned[self.triangles]
        low, high = turned[:, :2].min(axis=0), turned[:, :2].max(axis=0)
        side = max(1, int(np.sqrt(len(self.triangles))))
        cell = (high - low) * (1 + 1e-9) / side
        first, last = (np.floor((f(flat[:, :, :2], axis=1) - low) / cell).astype(int) for f in (np.min, np.max))
        first, last = np.clip(first, 0, side - 1), np.clip(last, 0, side - 1)
        span = last - first + 1
        many = span.prod(axis=1)
        triangle, number = np.repeat(np.arange(len(flat)), many), runs(np.zeros(len(flat), int), many)
        x = first[triangle, 0] + number // span[triangle, 1]
        y = first[triangle, 1] + number % span[triangle, 1]
        key = x * side + y
        order = np.argsort(key, kind="stable")
        start = np.concatenate([[0], np.cumsum(np.bincount(key, minlength=side * side))])
        return low, cell, start, triangle[order], turned, _planes(flat)

    @cached_property
    def _pieces(self):
        """Tree of the middles of pieces of triangles, and whose they are."""
        from scipy.spatial import cKDTree

        longest = np.sqrt(np.max(np.sum((self.corners - np.roll(self.corners, 1, axis=1)) ** 2, axis=2), axis=1))
        limit = PIECE * np.linalg.norm(np.ptp(self.vertices, axis=0))
        parts = np.maximum(1, np.ceil(longest / limit)).astype(int)
        middles, parents = [], []
        for n in np.unique(parts):
            mine = np.flatnonzero(parts == n)
            weights = _middles(int(n))
            middles.append(np.einsum("pk,mkx->mpx", weights, self.corners[mine]).reshape(-1, 3))
            parents.append(np.repeat(mine, len(weights)))
        return cKDTree(np.concatenate(middles)), np.concatenate(parents)


def _planes(flat):
    """Heights of triangles over a plane, as a x + b y + c, (m, 3) float array; not-a-number on edge."""
    one, other = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
    normal = np.cross(one, other)
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = -normal[:, :2] / normal[:, 2:]
    return np.column_stack([slope, flat[:, 0, 2] - np.sum(slope * flat[:, 0, :2], axis=1)])


def _under(points, vertices, triangles, planes):
    """Which points lie below their triangle: each edge is asked in one way, whichever triangle it is of."""
    within = np.zeros(len(points), bool)
    for a, b in ((0, 1), (1, 2), (0, 2)):
        first, last = np.sort(triangles[:, [a, b]], axis=1).T
        one, other = vertices[first], vertices[last]
        beside = (one[:, 1] > points[:, 1]) != (other[:, 1] > points[:, 1])
        rise = np.where(beside, other[:, 1] - one[:, 1], 1.0)
        at = one[:, 0] + (points[:, 1] - one[:, 1]) / rise * (other[:, 0] - one[:, 0])
        within ^= beside & (points[:, 0] < at)
    with np.errstate(invalid="ignore"):
        height = planes[:, 0] * points[:, 0] + planes[:, 1] * points[:, 1] + planes[:, 2]
        return within & (height > points[:, 2])


def _middles(n):
    """Barycentric coordinates of the middles of the n * n equal parts of a triangle."""
    i, j = (each.ravel() for each in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    up, down = i + j < n, i + j < n - 1
    a = np.concatenate([i[up] + 1 / 3, i[down] + 2 / 3]) / n
    b = np.concatenate([j[up] + 1 / 3, j[down] + 2 / 3]) / n
    return np.column_stack([a, b, 1 - a - b])


def _nearest_in(points, a, b, c):
    """The nearest point of each triangle: by its plane if that falls into it, else by its sides."""
    ab, ac, ap = b - a, c - a, points - a
    d00, d01, d11 = (np.sum(u * v, axis=-1) for u, v in ((ab, ab), (ab, ac), (ac, ac)))
    d20, d21 = np.sum(ap * ab, axis=-1), np.sum(ap * ac, axis=-1)
    area = np.maximum(d00 * d11 - d01 * d01, 1e-300)
    v, w = (d11 * d20 - d01 * d21) / area, (d00 * d21 - d01 * d20) / area
    best = a + v[..., None] * ab + w[..., None] * ac
    outside = (v < 0) | (w < 0) | (v + w > 1)
    least = np.where(outside, np.inf, 0.0)
    for one, other in ((a, b), (b, c), (c, a)):
        side = other - one
        part = np.sum((points - one) * side, axis=-1) / np.maximum(np.sum(side * side, axis=-1), 1e-300)
        there = one + np.clip(part, 0.0, 1.0)[..., None] * side
        away = np.sum((points - there) ** 2, axis=-1)
        nearer = outside & (away < least)
        best, least = np.where(nearer[..., None], there, best), np.where(nearer, away, least)
    return best
