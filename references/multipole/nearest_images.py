"""How slowly the multipoles of spheres beside each other fall, by their degree.

The images of two spheres in each other end in two points, c to either side of the plane from which both look alike: the
radius of one is c / sinh(alpha), and its terms fall by exp(-2 alpha) from degree to degree. A large sphere beside a
small one falls as slowly as beside the small one's centre alone, exp(alpha) radii from its own.
"""

import math
from typing import NamedTuple

import numpy as np

from references.multipole.arrangement import near

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
    # Of a sphere and a smaller one no centre farther than this makes less.
    here, there, way = near(spheres, 2 * math.cosh(FAST) * spheres.radii[: spheres.count])
    pairs = np.stack([spheres.radii[here], spheres.radii[there], np.linalg.norm(way, axis=1)])
    large, small = np.maximum(*pairs[:2]), np.minimum(*pairs[:2])
    return Beside(np.minimum(alphas(*pairs), FAST), large / pairs[2], small / large)


def alphas(one, two, apart):
    """Alpha of the larger of two spheres whose centres are so far apart; 0 where they touch."""
    powers = (apart**2 - one**2 - two**2) ** 2 - 4 * one**2 * two**2
    powers = np.where(apart > one + two, np.maximum(powers, 0.0), 0.0)
    return np.arcsinh(np.sqrt(powers) / (2 * apart * np.maximum(one, two)))
