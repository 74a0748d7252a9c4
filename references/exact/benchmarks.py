"""Exact solutions of three published benchmarks of heat conduction.

Source: The Standard NAFEMS Benchmarks (1990), T2 (a bar that radiates at its end), T3 (a bar whose end swings in time)
and T4 (a plate that convects at two edges); by a quartic, by separation of variables, by roots of a Biot number.
"""

import math

import numpy as np

from references.exact.responses import REST
from references.exact.robin import Face, roots

# Of Newton's method on a quartic, from above.
STEPS = 100


def radiating_end(length, conductivity, hot, black, around) -> float:
    """Temperature of the radiating end of a bar whose other end is held: k (T_h - T) / L = b (T^4 - T_a^4)."""
    slope, T = conductivity / length, max(hot, around)
    for _ in range(STEPS):
        change = (slope * (T - hot) + black * (T**4 - around**4)) / (slope + 4.0 * black * T**3)
        T -= change
        if abs(change) <= 1e-15 * T:
            break
    return T


def swinging_end(x, time, *, diffusivity, rate) -> np.ndarray:
    """Temperature of a slab of unit length, 0 at the start and at x = 0, whose end x = 1 is at sin(rate time)."""
    x = np.asarray(x, dtype=float)
    wave = np.sqrt(1j * rate / diffusivity)
    value = np.imag(np.sinh(wave * x) / np.sinh(wave) * np.exp(1j * rate * time))
    for n in range(1, 3 + math.ceil(math.sqrt(REST / (diffusivity * time)) / math.pi)):
        decay = diffusivity * (n * math.pi) ** 2
        share = 2.0 * (-1) ** (n + 1) / (n * math.pi) * rate * decay / (decay**2 + rate**2)
        value = value + share * math.exp(-decay * time) * np.sin(n * math.pi * x)
    return value


def convecting_plate(x, y, *, width, height, film) -> np.ndarray:
    """Temperature of a plate over that of its base, y = 0, insulated at x = 0, with a film to 0 at its other edges."""
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    count = 3 + math.ceil(REST * width / (math.pi * float(y.min())))
    value = np.zeros(np.broadcast(x, y).shape)
    for root in roots(Face(0.0, 0.0, 0.0), Face(film * width, 0.0, 0.0), count):
        m = root / width
        # The base's temperature in cosines that meet the film at x = width.
        weight = 2.0 * math.sin(root) / (root + math.sin(root) * math.cos(root))
        # cosh and sinh of m (height - y), over those of m height, by their larger halves.
        back = (m - film) / (m + film)
        along = (np.exp(-m * y) + back * np.exp(-m * (2 * height - y))) / (1.0 + back * math.exp(-2 * m * height))
        value += weight * np.cos(m * x) * along
    return value
