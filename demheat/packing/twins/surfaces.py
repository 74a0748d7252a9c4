"""What `surfaces_kernels` does, of few points by NumPy: to compile it takes longer than most solves."""

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from demheat.scene.shapes.bins import candidates

# Points, and normals of few spheres, up to which that is as fast.
FEW, FEW_NORMALS, FEW_SPHERES = 4096, 512, 2
# Corners of polyhedra beyond so many radii of the sphere in them say that they have no end.
WIDEST = 4.0


def turned_patterns(start, turns, balls):
    """Points of turned Fibonacci patterns and their normals; where each begins, rotations, centres and radii."""
    own = np.repeat(np.arange(len(balls)), np.diff(start))
    k = np.arange(start[-1]) - start[own] + 0.5
    z = 1.0 - 2.0 * k / np.diff(start)[own]
    angle, ring = np.pi * (1.0 + np.sqrt(5.0)) * k, np.sqrt(1.0 - z * z)
    normals = np.einsum("kij,kj->ki", turns[own], np.stack([ring * np.cos(angle), ring * np.sin(angle), z], axis=1))
    return balls[own, :3] + balls[own, 3:] * normals, normals


def nearest_gaps(points, own, kin, balls, bins, reach):
    """Distance of points to the nearest spherical surface but their own, see the kernel of that name."""
    point, ball = candidates(bins, points)
    other = kin[ball] != own[point]
    point, ball = point[other], ball[other]
    way = points[point] - balls[ball, :3]
    if bins.periodic:
        way -= bins.size * np.rint(way / bins.size)
    gaps = np.full(len(points), np.inf)
    np.minimum.at(gaps, point, np.abs(np.sqrt(np.einsum("ij,ij->i", way, way)) - balls[ball, 3]))
    gaps[gaps > reach] = np.inf
    return gaps


def circumscribed_volume(normals):
    """Volume of the polyhedron of the planes normal.x <= 1, exact to rounding; NaN where it has no end.

    Its vertices are the poles of the triangles of the convex hull of the normals. Each triangle and each of its edges
    make two signed tetrahedra with corners in the middle, a tangent point, the edge's nearest point and the vertex.
    """
    try:
        hull = ConvexHull(normals)
    except QhullError:
        return np.nan
    a, b, c = (normals[corner] for corner in hull.simplices.T)
    pole = np.cross(b - a, c - a)
    flip = np.einsum("ij,ij->i", pole, a) < 0  # counter-clockwise seen from outside
    b, c = np.where(flip[:, None], c, b), np.where(flip[:, None], b, c)
    vertex = pole / np.einsum("ij,ij->i", pole, a)[:, None]
    if np.any(hull.equations[:, 3] >= 0.0) or np.einsum("ij,ij->i", vertex, vertex).max() > 1.0 + WIDEST**2:
        return np.nan
    total = 0.0
    for p, q in ((a, b), (b, c), (c, a)):
        near = (p + q) / (1.0 + np.einsum("ij,ij->i", p, q))[:, None]
        total += np.einsum("ij,ij->", np.cross(p, near) + np.cross(near, q), vertex)
    return total / 6.0
