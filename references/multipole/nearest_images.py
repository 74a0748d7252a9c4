"""How slowly the multipoles of spheres beside each other fall, by their degree.

The images of two spheres in each other end in two points, c to either side of the plane from which both look alike: the
radius of one is c / sinh(alpha), and its terms fall by exp(-2 alpha) from degree to degree. A large sphere beside a
small one falls as slowly as beside the small one's centre alone, exp(alpha) radii from its own.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from references.multipole.arrangement import wrapped

# An alpha beyond which pairs are not looked for: from one degree to the next but one no more than .0025 is left.
FAST = 1.5


class Beside(NamedTuple):
    """Pairs of spheres, images included."""

    # (k,) float arrays: Of the larger one, at most FAST and 0 where they touch; its radius over the distance of the
    # centres; the smaller radius over the larger
    alpha: np.ndarray
    reach: np.ndarray
    share: np.ndarray

    def slowest(self, below=math.inf) -> float:
        """Least alpha of pairs whose radii have a share below this."""
        return float(np.min(self.alpha[self.share < below], initial=FAST))


def beside(spheres) -> Beside:
    """All pairs among which the slowest may be."""
    radii, own, shortest = spheres.radii, np.arange(spheres.count), float(np.min(spheres.size))
    if not spheres.count:
        return Beside(*np.empty((3, 0)))
    tree = cKDTree(wrapped(spheres.centers, spheres.size), boxsize=spheres.size)
    # Of a sphere and a smaller one no centre farther than this makes less.
    found = tree.query_ball_point(tree.data[own], 2 * radii[own] * math.cosh(FAST))
    one, two = np.repeat(own, [len(each) for each in found]), np.concatenate(found).astype(np.int64)
    one, two = one[one != two], two[one != two]
    apart = spheres.centers[one] - spheres.centers[two]
    apart = np.linalg.norm(apart - spheres.size * np.round(apart / spheres.size), axis=1)
    # And each beside its own image.
    pairs = np.stack([radii[one], radii[two], apart])
    pairs = np.hstack([pairs, np.stack([radii[own], radii[own], np.full(len(own), shortest)])])
    large, small = np.maximum(*pairs[:2]), np.minimum(*pairs[:2])
    return Beside(np.minimum(alphas(*pairs), FAST), large / pairs[2], small / large)


def alphas(one, two, apart):
    """Alpha of the larger of two spheres whose centres are so far apart; 0 where they touch."""
    powers = (apart**2 - one**2 - two**2) ** 2 - 4 * one**2 * two**2
    powers = np.where(apart > one + two, np.maximum(powers, 0.0), 0.0)
    return np.arcsinh(np.sqrt(powers) / (2 * apart * np.maximum(one, two)))
