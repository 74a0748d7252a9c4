"""The narrowest place between two surfaces, and how the gap widens around it."""

from typing import NamedTuple

import numpy as np

# Newton's steps; over what part of a length slopes are compared, and bends over it that count as none; how long a step
# may be, in radii of the bend.
STEPS, PART, FLAT, LONGEST = 30, 1e-2, 1e-6, 0.5


class Gap(NamedTuple):
    """Where two surfaces are nearest to each other."""

    place: np.ndarray  # (3,) float array, m
    normal: np.ndarray  # (3,) float array: Across the gap
    width: float  # m
    # (2,) float array, 1/m, and (2, 3) float array: Principal curvatures of the width, the larger first, and along what
    curvatures: np.ndarray
    along: np.ndarray


def narrowest(between, start, length) -> Gap | None:
    """The narrowest place of a gap near a point; None if none is found.

    `between` says of points how far they are outside of either surface, two (n,) float arrays, and its outward normals,
    two (n, 3) float arrays. The length is one over which surfaces are smooth.
    """
    place, step = np.array(start), np.inf
    for _ in range(STEPS):
        gap, slope, normal = _looked_at(between, place)
        along = _beside(normal)
        values, vectors = np.linalg.eigh(_bend(between, place, along, PART * length))
        bent = values > FLAT / length
        most = LONGEST / np.where(bent, values, np.inf)
        turned = np.clip(vectors.T @ (along @ slope) / np.where(bent, values, np.inf), -most, most)
        place = place - (vectors @ turned) @ along
        step = np.linalg.norm(turned)
        if step < 1e-9 * length:
            return Gap(place, normal, max(gap, 0.0), np.maximum(values[::-1], 0.0), vectors.T[::-1] @ along)
    return None


def _looked_at(between, place):
    """Width of a gap at a place, its slope, and the direction across it."""
    (one, two), (first, second) = between(place[None])
    across = first[0] - second[0]
    return float(one[0] + two[0]), first[0] + second[0], across / np.linalg.norm(across)


def _beside(normal):
    """Two directions beside a normal, (2, 3) float array."""
    first = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(normal, first)])


def _bend(between, place, along, step):
    """Second derivatives of the width, from normals beside the place, (2, 2) float array, 1/m."""
    _, (first, second) = between(np.concatenate([place + step * along, place - step * along]))
    slopes = (first + second) @ along.T
    bend = (slopes[:2] - slopes[2:]) / (2.0 * step)
    return 0.5 * (bend + bend.T)
