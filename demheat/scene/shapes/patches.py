"""Parts of a surface of triangles between its sharp edges, and points all over each of them.

A sphere of a thousand triangles has edges of ten degrees, a cube of twelve has edges of ninety. Errors fall with twice
the power pi / (pi + angle) of the size beside an edge of a perfect conductor, 1.7 or more below 30 degrees, where
programs that make elements take surfaces for smooth, too.
"""

import numpy as np

from demheat.scene.shapes.base import ALONG
from demheat.scene.shapes.morton import morton_order
from demheat.scene.shapes.patterns import FEWEST, ROUNDS, SPREAD, lifted, nearest_of
from demheat.scene.shapes.triangles import Triangles

# Between the normals of neighbours, from which on their edge is sharp.
SHARP = np.cos(np.radians(30.0))
# The sharpest edges, which alone are told.
MOST = 64
# Samples over those that a pitch asks for, of surfaces whose triangles are smaller.
FINER = 4
# Triangles longer than this part of a pitch are halved, as cells of that side cut a surface into parts as wide.
PART = 1.25
# Length of the mean of normals from which on they point one way, more or less.
ONE_WAY = 0.5


class Patches:
    """Which triangles are one patch, and where patches meet at sharp edges."""

    def __init__(self, body: Triangles):
        from scipy.sparse import coo_matrix
        from scipy.sparse.csgraph import connected_components

        self.body = body
        ends = np.sort(body.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        order = np.lexsort(ends.T)
        self.beside, self.ends = (order // 3).reshape(-1, 2), ends[order[::2]]
        one, other = body.normals[self.beside].transpose(1, 0, 2)
        self.cosine = np.einsum("ij,ij->i", one, other)
        self.sharp = self.cosine < SHARP
        count, joined = len(body.triangles), self.beside[~self.sharp]
        joins = coo_matrix((np.ones(len(joined)), joined.T), shape=(count, count))
        self.own = connected_components(joins, directed=False)[1]

    @property
    def kinks(self) -> float:
        """Root mean square of the angle between neighbours on one patch, along their edges; 0 if there are none."""
        angle = np.arccos(np.clip(self.cosine, -1.0, 1.0))
        start, end = self.body.vertices[self.ends].transpose(1, 0, 2)
        length = np.where(self.sharp, 0.0, _size(end - start)[:, 0])
        return float(np.sqrt(np.sum(length * angle**2) / max(length.sum(), 1e-300)))

    def samples(self, pitch: float, low=-np.inf, high=np.inf):
        """Points no more than a pitch apart in a box, or nearly so, with their areas and triangles."""
        points, areas, triangle = _halved(self.body, PART * pitch, low, high)
        most = int(FINER * areas.sum() / pitch**2) + FEWEST
        if len(points) <= most:
            return points, areas, triangle
        order = _along(points, self.own[triangle])
        total = np.cumsum(areas[order])
        chosen = order[np.searchsorted(total, (np.arange(most) + 0.5) / most * total[-1]).clip(max=len(order) - 1)]
        return points[chosen], np.full(most, total[-1] / most), triangle[chosen]

    def edges(self, beside: float):
        """Points around the sharpest edges, (n, 4, 3) float array, and the angles of the wedges that they lie in."""
        found = np.flatnonzero(self.sharp)
        found = found[np.argsort(self.cosine[found], kind="stable")[:MOST]]
        one, other = self.body.normals[self.beside[found]].transpose(1, 0, 2)
        start, end = self.body.vertices[self.ends[found]].transpose(1, 0, 2)
        # Along the edge; of the wedge's two faces the first is turned into the other about it.
        along = np.cross(one, other)
        lengths = np.linalg.norm(along, axis=1, keepdims=True)
        # Of a blade both faces look apart.
        along = np.where(lengths > 1e-9, along / np.maximum(lengths, 1e-300), (end - start) / _size(end - start))
        outward = one + other
        blade = np.cross(along, one)
        outward = np.where(_size(outward) > 1e-9, outward / np.maximum(_size(outward), 1e-300), blade)
        # Out of a ridge the other face falls away, out of a groove it rises.
        apex = self.body.corners[self.beside[found, 1]].mean(axis=1) - start
        turn = np.arccos(np.clip(self.cosine[found], -1, 1)) * np.where(_dot(apex, one) < 0, 1.0, -1.0)
        inner, outer = 0.5 * (np.pi - turn), 0.5 * (np.pi + turn)
        across = np.cross(outward, along)
        at = start[:, None] + ((np.arange(ALONG) + 0.5) / ALONG)[:, None] * (end - start)[:, None]
        around = []
        # From within: half of what is inside on either side, and half of what is outside.
        for angle in (0.5 * inner, inner + 0.5 * outer, -inner - 0.5 * outer, -0.5 * inner):
            way = -np.cos(angle)[:, None] * outward + np.sin(angle)[:, None] * across
            around.append(at + beside * way[:, None])
        angles = np.repeat(np.stack([inner, outer, outer, inner], axis=1), ALONG, axis=0)
        return np.stack(around, axis=2).reshape(-1, 4, 3), angles

    def spread(self, surface, spacing: float, rng, low, high):
        """Points in the middles of their own parts of patches, half a spacing from where these meet, and normals.

        Of patches smaller than what a point stands for all are one.
        """
        samples, areas, triangle = self.samples(spacing / SPREAD, low, high)
        if not len(samples):
            return np.empty((0, 3)), np.empty((0, 3))
        each, own = np.sqrt(0.75) * spacing**2, self.own[triangle]
        small = np.bincount(own, areas)[own] < 0.5 * each
        _, own = np.unique(np.where(small, -1, own), return_inverse=True)
        counts = np.maximum(1, np.rint(np.bincount(own, areas) / each)).astype(int)
        if counts.sum() < FEWEST:
            counts = np.ceil(counts * FEWEST / counts.sum()).astype(int)
        points, mean = _lloyd(samples, areas, own, counts, rng, self.body.normals[triangle])
        distance, normal = surface(points)
        points = points - distance[:, None] * normal
        # A point stands for several triangles: the one under it alone would tilt its plane.
        length = _size(mean)
        return points, np.where(length > ONE_WAY, mean / np.maximum(length, 1e-300), surface(points)[1])

    def facets(self, points, normals, triangle, pitch: float, low, high):
        """Points moved along normals so that the plane of each holds as much as the body over its part of a patch."""
        samples, areas, sampled = self.samples(pitch, low, high)
        own, there = self.own[triangle], self.own[sampled]
        told = np.isin(there, own)
        nearest = np.empty(len(samples), int)
        nearest[told] = nearest_of(_apart(points, own, samples), _apart(samples, there, samples)[told])
        nearest[~told] = nearest_of(points, samples[~told])
        return lifted(points, normals, samples, self.body.normals[sampled], areas, nearest)

    def beside_edges(self, points, least: float) -> np.ndarray:
        """Which points are nearer to a sharp edge than a length, (n,) bool array."""
        from scipy.spatial import cKDTree

        if not (self.sharp.any() and len(points)):
            return np.zeros(len(points), bool)
        start, end = self.body.vertices[self.ends[self.sharp]].transpose(1, 0, 2)
        parts = np.ceil(np.linalg.norm(end - start, axis=1) / (0.25 * least)).astype(int) + 1
        number = np.repeat(np.arange(len(parts)), parts)
        share = (np.arange(len(number)) - np.repeat(np.cumsum(parts) - parts, parts)) / (parts[number] - 1)
        line = start[number] + share[:, None] * (end - start)[number]
        return cKDTree(line).query(points, distance_upper_bound=least)[0] < least


def _halved(body, longest, low, high):
    """Middles of triangles that are halved until they are no longer than that, with their areas and triangles."""
    corners, triangle, found = body.corners, np.arange(len(body.corners)), []
    while len(corners):
        near = np.all((corners.max(axis=1) >= low) & (corners.min(axis=1) <= high), axis=1)
        corners, triangle = corners[near], triangle[near]
        sides = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
        side, long = sides.argmax(axis=1), sides.max(axis=1, initial=0.0) > longest
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        found.append((corners.mean(axis=1)[~long], 0.5 * np.linalg.norm(across, axis=1)[~long], triangle[~long]))
        rows, side = np.flatnonzero(long), side[long]
        a, b, c = (corners[rows, (side + k) % 3] for k in range(3))
        middle = 0.5 * (a + b)
        corners = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
        triangle = np.concatenate([triangle[rows]] * 2)
    points, areas, triangle = (np.concatenate(column) for column in zip(*found, strict=True))
    inside = np.all((points >= low) & (points <= high), axis=1)
    return points[inside], areas[inside], triangle[inside]


def _lloyd(samples, areas, own, counts, rng, outward):
    """So many points of each part amid the samples nearest to them (Lloyd's algorithm), and means of normals there."""
    order = _along(samples, own)
    samples, areas, own = samples[order], areas[order], own[order]
    columns = np.concatenate([samples, outward[order]], axis=1).T
    part = np.repeat(np.arange(len(counts)), counts)
    share = (np.arange(len(part)) - np.repeat(np.cumsum(counts) - counts, counts) + rng.random()) / counts[part]
    total = np.cumsum(areas)
    ends = total[np.searchsorted(own, np.arange(len(counts)), side="right") - 1]
    starts = np.append(0.0, ends[:-1])
    points = samples[np.searchsorted(total, starts[part] + share * (ends - starts)[part]).clip(max=len(samples) - 1)]
    there = _apart(samples, own, samples)
    for _ in range(ROUNDS):
        nearest = nearest_of(_apart(points, part, samples), there)
        area = np.bincount(nearest, areas, len(points))
        sums = np.stack([np.bincount(nearest, areas * column, len(points)) for column in columns], axis=1)
        means = sums / np.maximum(area, 1e-300)[:, None]
        points = np.where(area[:, None] > 0, means[:, :3], points)
    return points, means[:, 3:]


def _apart(points, own, samples):
    """Points with a fourth coordinate, by which samples of other parts are farther than any of their own."""
    size = np.linalg.norm(np.ptp(samples, axis=0))
    return np.column_stack([points, 4.0 * size * own])


def _along(points, own):
    """Part by part, along a curve that fills space."""
    low = points.min(axis=0)
    order = morton_order(points - low, np.maximum(np.ptp(points, axis=0), 1e-300))
    return order[np.argsort(own[order], kind="stable")]


def _dot(one, other):
    return np.einsum("ij,ij->i", one, other)


def _size(vectors):
    return np.linalg.norm(vectors, axis=1, keepdims=True)
