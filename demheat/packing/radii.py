"""Radius distributions: small frozen objects that draw radii of mean 1."""

import hashlib
import math
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr, ndtri

from demheat.powers import exponential
from demheat.scene.inputs import finite, reals


@dataclass(frozen=True)
class Gaussian:
    """Gaussian radii cut on both sides, as in Haddad et al. (2021), who do not print their cut.

    Parameters
    ----------
    spread : float
        Standard deviation over mean before the cut; 0 gives equal spheres.
    cut : float
        Kept range in standard deviations. At 2.5 the standard deviation that remains is 0.955 of `spread`.
    """

    spread: float = 0.3
    cut: float = 2.5

    def __post_init__(self):
        finite("Gaussian.cut", self.cut, "a finite number > 0", lambda v: v > 0)
        valid = f">= 0 and < 1/cut = {1 / self.cut:.3g}, else some radii are not positive"
        finite("Gaussian.spread", self.spread, valid, lambda v: 0 <= v * self.cut < 1)

    def draw(self, number: int, rng: np.random.Generator) -> np.ndarray:
        """Draw radii of mean 1 (expectation)."""
        return 1.0 + self.spread * _cut_normal(number, self.cut, rng)


@dataclass(frozen=True)
class Uniform:
    """Uniform radii in 1 - half_width to 1 + half_width; Terreros et al. (2013) use 0.075."""

    half_width: float = 0.075

    def __post_init__(self):
        finite("Uniform.half_width", self.half_width, ">= 0 and < 1", lambda v: 0 <= v < 1)

    def draw(self, number: int, rng: np.random.Generator) -> np.ndarray:
        """Draw radii of mean 1 (expectation)."""
        return rng.uniform(1.0 - self.half_width, 1.0 + self.half_width, number)


@dataclass(frozen=True)
class Lognormal:
    """Lognormal radii, cut on both sides."""

    spread: float = 0.3  # Standard deviation of the logarithm of the radius, before the cut
    cut: float = 2.5  # Kept range of the logarithm in standard deviations

    def __post_init__(self):
        finite("Lognormal.spread", self.spread, "a finite number >= 0", lambda v: v >= 0)
        finite("Lognormal.cut", self.cut, "a finite number > 0", lambda v: v > 0)

    def draw(self, number: int, rng: np.random.Generator) -> np.ndarray:
        """Draw radii of mean 1 (expectation)."""
        s, c = self.spread, self.cut
        # E[exp(s z)] over |z| < c is exp(s^2/2) [ndtr(c - s) - ndtr(-c - s)] / [ndtr(c) - ndtr(-c)].
        mean = math.exp(s * s / 2) * (ndtr(c - s) - ndtr(-c - s)) / (ndtr(c) - ndtr(-c))
        return exponential(s * _cut_normal(number, c, rng)) / mean


@dataclass(frozen=True)
class Bidisperse:
    """Two sizes.

    Parameters
    ----------
    ratio : float
        Large radius over small radius, >= 1.
    fraction : float
        Fraction of the particles, by number, that are large. Each draw has exactly round(fraction * number).
    """

    ratio: float = 1.4
    fraction: float = 0.5

    def __post_init__(self):
        finite("Bidisperse.ratio", self.ratio, "a finite number >= 1", lambda v: v >= 1)
        finite("Bidisperse.fraction", self.fraction, "a number between 0 and 1", lambda v: 0 <= v <= 1)

    def draw(self, number: int, rng: np.random.Generator) -> np.ndarray:
        """Draw radii of mean 1 (within the rounding of the fraction)."""
        radii = np.ones(number)
        radii[: round(self.fraction * number)] = self.ratio
        return rng.permutation(radii) / (1.0 + self.fraction * (self.ratio - 1.0))


@dataclass(frozen=True, repr=False)
class Listed:
    """Radii given one by one, used in random order; only their ratios count."""

    values: tuple[float, ...]

    def __post_init__(self):
        values = reals("Listed.values", self.values, "a list of finite numbers > 0")
        if values.ndim != 1 or len(values) == 0 or not np.all(np.isfinite(values)) or np.any(values <= 0):
            raise ValueError(f"Listed.values of shape {values.shape}: must be a list of finite numbers > 0")
        object.__setattr__(self, "values", tuple(values.tolist()))

    def __repr__(self):
        """Name the list by a digest: a million numbers are no name."""
        digest = hashlib.sha256(np.array(self.values).tobytes()).hexdigest()
        return f"Listed({len(self.values)} values, sha256={digest})"

    def draw(self, number: int, rng: np.random.Generator) -> np.ndarray:
        """Put the listed radii, divided by their mean, in random order."""
        if number != len(self.values):
            raise ValueError(f"Listed.values: {len(self.values)} radii for {number} particles; must be one each")
        return rng.permutation(np.array(self.values) / np.mean(self.values))


def distribution(radii):
    """A radius distribution as it is, or the list of radii that an array is; raises ValueError for anything else."""
    valid = "a distribution such as Gaussian(0.3), or numbers > 0"
    if isinstance(radii, type):
        raise ValueError(f"radii = {radii.__name__}: must be {valid}; this is a class, not one of its distributions")
    if hasattr(radii, "draw"):
        return radii
    values = reals("radii", radii, valid)
    try:
        return Listed(tuple(values.tolist()))
    except (TypeError, ValueError) as error:
        raise ValueError(f"radii = {radii!r}: must be {valid}") from error


def _cut_normal(number, cut, rng):
    """Standard normal numbers given that they lie within +-cut, by inversion."""
    return ndtri(rng.uniform(ndtr(-cut), ndtr(cut), number))
