"""Polynomials that temperatures are fitted with: all up to second order, or harmonic ones up to third.

Each is a table: what every monomial x^a y^b z^c counts in each of them.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

Powers = tuple[int, int, int]


class Polynomials(NamedTuple):
    """Polynomials in three variables; the first is 1, the next are x, y and z."""

    powers: tuple[Powers, ...]  # of the monomials
    table: np.ndarray  # (monomials, polynomials) float array

    @property
    def number(self) -> int:
        """How many they are."""
        return self.table.shape[1]

    def values(self, x: np.ndarray) -> np.ndarray:
        """Of points (..., 3), a (..., number) float array."""
        return _monomials(x, self.powers) @ self.table

    def along(self, x: np.ndarray, normal: np.ndarray) -> np.ndarray:
        """Derivatives at points (..., 3) along unit vectors (..., 3), a (..., number) float array."""
        total = np.zeros((*x.shape[:-1], self.number))
        for axis in range(3):
            factors = np.array([powers[axis] for powers in self.powers], dtype=float)
            lower = tuple(_lowered(powers, axis) for powers in self.powers)
            total += normal[..., axis, None] * (_monomials(x, lower) @ (factors[:, None] * self.table))
        return total


def _lowered(powers, axis):
    return tuple(max(power - (k == axis), 0) for k, power in enumerate(powers))


def _monomials(x, powers):
    ladder = [np.ones_like(x)]
    for _ in range(max(map(max, powers))):
        ladder.append(ladder[-1] * x)
    return np.stack([ladder[a][..., 0] * ladder[b][..., 1] * ladder[c][..., 2] for a, b, c in powers], axis=-1)


def _polynomials(*each: Mapping[str, float]) -> Polynomials:
    """Polynomials by what letters, such as xyy, count in each."""
    names = sorted({name for one in each for name in one}, key=lambda name: (len(name), name))
    powers = tuple(tuple(name.count(letter) for letter in "xyz") for name in names)
    return Polynomials(powers, np.array([[one.get(name, 0.0) for one in each] for name in names]))


LINEAR = ({"": 1.0}, {"x": 1.0}, {"y": 1.0}, {"z": 1.0})
# Up to second order: where heat is stored.
QUADRATICS = _polynomials(*LINEAR, *({name: 1.0} for name in ("xx", "xy", "xz", "yy", "yz", "zz")))
# Solid harmonics up to third order, none much larger than 1 within the unit ball: where no heat is stored.
HARMONICS = _polynomials(
    *LINEAR,
    {"xy": 1.0},
    {"xz": 1.0},
    {"yz": 1.0},
    {"xx": 1.0, "yy": -1.0},
    {"zz": 1.2, "xx": -0.6, "yy": -0.6},
    {"zzz": 1.0, "xxz": -1.5, "yyz": -1.5},
    {"xzz": 2.0, "xxx": -0.5, "xyy": -0.5},
    {"yzz": 2.0, "yyy": -0.5, "xxy": -0.5},
    {"xxz": 1.0, "yyz": -1.0},
    {"xyz": 2.0},
    {"xxx": 0.5, "xyy": -1.5},
    {"xxy": 1.5, "yyy": -0.5},
)
