"""How deep points lie in a union of convex shapes: beside its faces, and beside creases where two members meet."""

import numpy as np

from demheat.scene.shapes.base import Shape

# Steps to a crease, each to where the tangent planes of two faces cross; found 5 to 8 between spheres.
ROUNDS = 12
# Square of the sine of the angle between two faces below which they count as one, and have no crease.
ALIKE = 1e-6
# Where to look instead, in their distances: no direction in particular.
ASIDE = np.array([0.48, 0.6, 0.64]) / 2


def crease(points: np.ndarray, one: Shape, other: Shape) -> np.ndarray:
    """Where the surfaces of two faces cross, nearest to points or nearly so; anywhere if none is found."""
    here = points
    for _ in range(ROUNDS):
        (d, n), (e, m) = one.surface(here), other.surface(here)
        away = here - points
        p, q = np.einsum("ij,ij->i", n, away) - d, np.einsum("ij,ij->i", m, away) - e
        cosine = np.einsum("ij,ij->i", n, m)
        alike = 1.0 - cosine**2 < ALIKE
        sine2 = np.where(alike, 1.0, 1.0 - cosine**2)
        first, second = (p - cosine * q) / sine2, (q - cosine * p) / sine2
        step = points + first[:, None] * n + second[:, None] * m
        # As on the axis of two balls: from a point aside, of which the crease may be as near.
        step[alike] = here[alike] + (np.abs(d) + np.abs(e))[alike, None] * ASIDE
        if not np.any(np.abs(step - here) > 1e-14 * np.abs(step)):
            return step
        here = step
    return here
