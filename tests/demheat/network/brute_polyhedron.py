"""A convex polyhedron by brute force: where three planes meet is a corner if it lies within all the others."""

from itertools import combinations

import numpy as np

# Points this near to a plane lie on it: far above rounding, far below the facets that tests look at.
NEAR = 1e-10


def corners(normals, distances):
    """Points of the polyhedron normal.x <= distance in which three planes or more meet, (k, 3) float array."""
    triples = np.array(list(combinations(range(len(normals)), 3)))
    matrices = normals[triples]
    proper = np.abs(np.linalg.det(matrices)) > 1e-9
    points = np.linalg.solve(matrices[proper], distances[triples[proper]][..., None])[..., 0]
    return points[np.all(points @ normals.T <= distances + NEAR, axis=1)]


def measured(normals, distances):
    """Facet areas, one for each plane, and the volume; nothing for planes that do not touch the polyhedron."""
    points, areas = corners(normals, distances), np.zeros(len(normals))
    for f, (normal, distance) in enumerate(zip(normals, distances, strict=True)):
        rim = points[np.abs(points @ normal - distance) < 2 * NEAR]
        if len(rim) >= 3:
            areas[f] = _area(rim, normal)
    return areas, float(areas @ distances / 3)


def _area(rim, normal):
    """Area of the convex polygon of some points in a plane, in whatever order."""
    across = np.cross(normal, [1.0, 0.0, 0.0] if abs(normal[0]) < 0.9 else [0.0, 1.0, 0.0])
    across /= np.linalg.norm(across)
    away = rim - rim.mean(axis=0)
    x, y = away @ across, away @ np.cross(normal, across)
    order = np.argsort(np.arctan2(y, x))
    x, y = x[order], y[order]
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
