"""Conductivity that follows the temperature: by which factor, and Kirchhoff's transform, the integral of that factor.

What is linear between given temperatures is integrated, inverted and averaged exactly: no step, no iteration.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from demheat.scene.inputs import LEAST, MOST, finite, moderate, reals

VALID = (
    f"two or more pairs (temperature, factor), temperatures ascending, at most {MOST:g}, factors from {LEAST:g} to "
    f"{MOST:g}"
)


@dataclass(frozen=True)
class Dependence:
    """By which factor a conductivity differs at other temperatures: linear between those given, constant beyond.

    Parameters
    ----------
    points : sequence of (float, float)
        Temperature, in the scale of the scene's walls, and factor > 0; ascending.

    Examples
    --------
    >>> from demheat import Dependence, Material
    >>> rising = Dependence.linear(2e-3, 20.0, (0.0, 100.0))  # 1 + 0.002 (T - 20), constant beyond
    >>> iron = Material(16.0, dependence=rising)
    >>> rising.factor([20.0, 70.0, 500.0]).round(12).tolist()
    [1.0, 1.1, 1.16]
    """

    points: tuple[tuple[float, float], ...]

    def __post_init__(self):
        table = reals("Dependence.points", self.points, VALID)
        good = table.ndim == 2 and table.shape[1:] == (2,) and len(table) > 1 and np.all(np.isfinite(table))
        good = good and np.all(np.diff(table[:, 0]) > 0) and np.abs(table[:, 0]).max() <= MOST
        if not good or not all(value > 0 and moderate(value) for value in table[:, 1]):
            raise ValueError(f"Dependence.points = {self.points!r}: must be {VALID}")
        object.__setattr__(self, "points", tuple(map(tuple, table.tolist())))

    @classmethod
    def linear(cls, coefficient: float, reference: float, between: Sequence[float]) -> Dependence:
        """1 + coefficient (T - reference) between two temperatures, constant beyond: it would not stay positive.

        Parameters
        ----------
        coefficient : float, 1/K
        reference : float, K or degrees Celsius
            Where the factor is 1.
        between : (2,) sequence of float, K or degrees Celsius
        """
        coefficient = finite("coefficient", coefficient, "a finite number, 1/K")
        reference = finite("reference", reference, "a finite temperature")
        ends = reals("between", between, "two temperatures, ascending")
        if ends.shape != (2,) or not np.all(np.isfinite(ends)) or not ends[0] < ends[1]:
            raise ValueError(f"between = {between!r}: must be two temperatures, ascending")
        factors = 1.0 + coefficient * (ends - reference)
        if not np.all(factors > 0):
            raise ValueError(
                f"coefficient = {coefficient!r} about {reference!r}: makes factors {factors.tolist()} at "
                f"{ends.tolist()}; must leave both above 0"
            )
        return cls(tuple(zip(ends.tolist(), factors.tolist(), strict=True)))

    @cached_property
    def _columns(self):
        """Temperatures, factors, and the integral of the factor up to each temperature."""
        t, f = np.array(self.points).T
        return t, f, np.concatenate([[0.0], np.cumsum(np.diff(t) * (f[1:] + f[:-1]) / 2)])

    def factor(self, temperature) -> np.ndarray:
        """Factor at temperatures, any shape, K -> the same shape."""
        t, f, _ = self._columns
        return np.interp(temperature, t, f)

    def integral(self, temperature) -> np.ndarray:
        """Integral of the factor from the first temperature given, any shape, K -> the same shape, K."""
        t, f, whole = self._columns
        k = np.clip(np.searchsorted(t, temperature, side="right") - 1, 0, None)
        return whole[k] + (temperature - t[k]) * (f[k] + self.factor(temperature)) / 2

    def inverse(self, integral) -> np.ndarray:
        """Temperature at which `integral` is so much, any shape, K -> the same shape, K."""
        t, f, whole = self._columns
        k = np.clip(np.searchsorted(whole, integral, side="right") - 1, 0, None)
        rest = integral - whole[k]
        slope = np.append(np.diff(f) / np.diff(t), 0.0)[k]
        slope = np.where(rest < 0, 0.0, slope)
        return t[k] + 2 * rest / (f[k] + np.sqrt(f[k] ** 2 + 2 * slope * rest))

    def mean(self, one, other) -> np.ndarray:
        """Mean of the factor between two temperatures, any shape, K -> the same shape.

        Parameters
        ----------
        one, other : float arrays, K
        """
        t, f, whole = self._columns
        low, high = np.minimum(one, other), np.maximum(one, other)
        first, last = (np.searchsorted(t, x, side="right") - 1 for x in (low, high))
        ends = self.factor(low), self.factor(high)
        # Piece by piece: a difference of two integrals would lose digits where the two are near to each other.
        up, down = np.minimum(first + 1, len(t) - 1), np.maximum(last, 0)
        parts = (t[up] - low) * (ends[0] + f[up]) + (high - t[down]) * (ends[1] + f[down])
        total = parts / 2 + (whole[down] - whole[up])
        span = np.where(first == last, 1.0, high - low)
        return np.where(first == last, (ends[0] + ends[1]) / 2, total / span)


class Dependences:
    """Those of all phases of a scene; a phase without one has factor 1, and its temperature as the integral."""

    def __init__(self, each: Sequence[Dependence | None]):
        self.kinds = sorted({own for own in each if own is not None}, key=lambda own: own.points)
        # Of each phase the place among the kinds, one after the last if it has none.
        self.kind = np.array([len(self.kinds) if own is None else self.kinds.index(own) for own in each])

    def factor(self, phase, temperature) -> np.ndarray:
        """Factors at temperatures; as all others here of phases, (n, ...) int array, and (n, ...) float arrays, K."""
        return self._of("factor", phase, temperature, otherwise=np.ones_like)

    def integral(self, phase, temperature) -> np.ndarray:
        """Kirchhoff's transforms, see `Dependence.integral`."""
        return self._of("integral", phase, temperature)

    def inverse(self, phase, integral) -> np.ndarray:
        """Temperatures of Kirchhoff's transforms."""
        return self._of("inverse", phase, integral)

    def mean(self, phase, one, other) -> np.ndarray:
        """Mean factors between two temperatures."""
        return self._of("mean", phase, one, other, otherwise=np.ones_like)

    def _of(self, name, phase, *values, otherwise=np.copy):
        if len(self.kinds) == 1 and not self.kind.any():
            return getattr(self.kinds[0], name)(*values)
        kind, *values = np.broadcast_arrays(self.kind[phase], *np.asarray(values, dtype=float))
        found = otherwise(values[0])
        for number, own in enumerate(self.kinds):
            here = kind == number
            found[here] = getattr(own, name)(*(value[here] for value in values))
        return found
