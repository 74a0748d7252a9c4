"""A slab whose faces exchange heat with surroundings, in time: modes by the roots of Biot numbers.

Source: Carslaw and Jaeger, Conduction of Heat in Solids (1959), sections 3.9-3.11. Modes cos(m x - p) with
tan p = B0 / m at the near face meet the far one where m - p - atan(B1 / m) is a multiple of pi; a held face has an
infinite Biot number, one with a flux 0.
"""

import math
from typing import NamedTuple

import numpy as np

from references.exact.responses import REST

# Least Fourier number: the modes are then some twenty thousand.
EARLIEST = 1e-8
# Of Newton's method for the roots, from below: tiny Biot numbers take a doubling for each step.
STEPS = 200


class Face(NamedTuple):
    """A face of a slab of unit length and conductivity."""

    biot: float  # Coefficient of exchange; infinite where the face is held, 0 where it has a flux
    outside: float  # Temperature of the surroundings, or of the face that is held
    flux: float  # Into the slab, where nothing is exchanged

    def phase(self, m):
        """Phase of modes at the face, atan(B / m), (k,) float array."""
        return np.full(len(m), math.pi / 2) if math.isinf(self.biot) else np.arctan2(self.biot, m)

    def drive(self, m):
        """What the face does to modes, (k,) float array: B T cos p, as B cos p is m sin p, and the flux."""
        p = self.phase(m)
        return m * np.sin(p) * self.outside + self.flux * np.cos(p)


def roots(near: Face, far: Face, count: int) -> np.ndarray:
    """Roots of m - atan(B0 / m) - atan(B1 / m) = 0, pi, 2 pi, ..., (count,) float array."""
    whole = math.pi * np.arange(count)
    # The left side grows and is concave: from below each step stays below.
    m = np.maximum(whole, 1e-12)
    for _ in range(STEPS):
        slope = np.ones(count)
        for face in (near, far):
            slope += face.biot / (m**2 + face.biot**2) if 0 < face.biot < math.inf else 0.0
        change = (whole + near.phase(m) + far.phase(m) - m) / slope
        m = m + change
        if np.all(np.abs(change) <= 4e-16 * m):
            break
    return m


def slab(x, fourier, near: Face, far: Face, heating: float):
    """Temperature of a slab of unit length, diffusivity and conductivity, 0 at the start, and its slope."""
    x = np.asarray(x, dtype=float)
    value, slope = settled(x, near, far, heating)
    m = roots(near, far, 2 + math.ceil(math.sqrt(REST / fourier) / math.pi))
    p, q = near.phase(m), far.phase(m)
    sign = np.where(np.arange(len(m)) % 2, -1.0, 1.0)
    # Integrals of a mode and of its square; at the far face it is cos q with the sign, and m - p is q and turns.
    mean = (sign * np.sin(q) + np.sin(p)) / m
    square = 0.5 + (np.sin(2 * q) + np.sin(2 * p)) / (4 * m)
    # By Green's theorem: what drives the mode, over its rate, is what it has of the settled temperature.
    weight = (near.drive(m) + sign * far.drive(m) + heating * mean) / (m**2 * square)
    weight *= np.exp(-(m**2) * fourier)
    for k, phase, w in zip(m, p, weight, strict=True):
        value -= w * np.cos(k * x - phase)
        slope += w * k * np.sin(k * x - phase)
    return value, slope


def settled(x, near: Face, far: Face, heating: float):
    """The steady temperature of the slab, and its slope."""
    # a + b x - heating x^2 / 2; a face of resistance R = 1/B: T - R times the slope inwards is the surroundings'.
    rows, right = np.zeros((2, 2)), np.zeros(2)
    if near.biot:
        rows[0], right[0] = (1.0, -1.0 / near.biot), near.outside
    else:
        rows[0], right[0] = (0.0, -1.0), near.flux
    if far.biot:
        rows[1], right[1] = (1.0, 1.0 + 1.0 / far.biot), far.outside + heating * (0.5 + 1.0 / far.biot)
    else:
        rows[1], right[1] = (0.0, 1.0), far.flux + heating
    a, b = np.linalg.solve(rows, right)
    return a + b * x - heating * x**2 / 2, b - heating * x
