"""Harmonics turned so that a direction becomes z, and back: see `axes`."""

from functools import lru_cache

import numpy as np

from references.multipole.axes import sphere_points
from references.multipole.sums import harmonics


@lru_cache(maxsize=128)
def exchange_of(degree):
    """Exchange of the axes y and z for one degree, (2 l + 1, 2 l + 1) float array, its own inverse.

    From and to real parts of m = 0, ..., l, then imaginary ones of m = 1, ..., l.
    """
    points, weights = sphere_points(degree)
    rows = slice(degree * (degree + 1) // 2, (degree + 1) * (degree + 2) // 2)
    here, there = harmonics(points, degree)[:, rows], harmonics(points[:, [0, 2, 1]], degree)[:, rows]
    onto = ((2 * degree + 1) * weights[:, None] * here.conj()).T
    both = np.where(np.arange(degree + 1) == 0, 1.0, 2.0)
    full = np.hstack([onto @ (both * there.real), (onto @ (-both * there.imag))[:, 1:]])
    return np.vstack([full.real, full.imag[1:]])


def turned(tables, angles, *, back=False):
    """Tables, each for a direction that becomes z, or that z becomes.

    tables : (k, entries) complex array
    angles : (k, 2) float array; polar angle and azimuth of the directions
    """
    order = int(np.sqrt(2 * tables.shape[1])) - 1
    polar, azimuth = angles.T[:, :, None]
    first, second = (-polar, azimuth) if not back else (polar, -azimuth)
    result = np.empty_like(tables)
    for degree in range(order + 1):
        rows = slice(degree * (degree + 1) // 2, (degree + 1) * (degree + 2) // 2)
        m, part, exchange = np.arange(degree + 1), tables[:, rows], exchange_of(degree)
        if back:
            part = _exchanged(part, exchange) * np.exp(1j * m * first)
            result[:, rows] = _exchanged(part, exchange) * np.exp(1j * m * second)
        else:
            part = _exchanged(part * np.exp(1j * m * second), exchange) * np.exp(1j * m * first)
            result[:, rows] = _exchanged(part, exchange)
    return result


def _exchanged(part, exchange):
    n = part.shape[1]
    both = np.hstack([part.real, part.imag[:, 1:]]) @ exchange.T
    imaginary = np.hstack([np.zeros((len(part), 1)), both[:, n:]])
    return both[:, :n] + 1j * imaginary
