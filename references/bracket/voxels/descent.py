"""Conjugate gradients that lower an energy; whatever they leave, the energy where they stop is that of their field."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

# Share of the iterations whose decreases of the energy, together, say how far it is from its least; the fewest.
LAST, FEWEST = 8, 2
# Of the energy: the square of a slope that is rounding. Of a slope squared: what projections of it leave by rounding,
# where most of it is no slope for fields that may change; beyond that, iterations would follow rounding.
NOTHING, BLURRED = 1e-28, 1e-13


class Found(NamedTuple):
    """Where the descent stopped."""

    field: np.ndarray  # float array
    iterations: int


def descend(
    slope: Callable, inverse: Callable, start: np.ndarray, *, loaded: tuple, tolerance: float, most: int, done: Callable
) -> Found:
    """Lower a quadratic energy from a field on, by what an inverse takes its slope to."""
    field, residual, energy = start, -loaded[0], loaded[1]
    direction, before, decreases = None, 0.0, []
    while len(decreases) < most:
        step = inverse(residual)
        along = _dot(residual, step)
        if not along > max(NOTHING * energy, BLURRED * _dot(residual, residual)):
            break
        direction = step if direction is None else step + along / before * direction
        before, turned = along, slope(direction)
        curvature = _dot(direction, turned)
        if not curvature > 0:
            break
        field += along / curvature * direction
        residual -= along / curvature * turned
        decreases.append(along**2 / curvature)
        energy -= decreases[-1]
        last = sum(decreases[-max(FEWEST, len(decreases) // LAST) :])
        if len(decreases) >= FEWEST and last <= tolerance * energy:
            break
        done(min(1.0, tolerance * energy / last))
    return Found(field, len(decreases))


def _dot(one, other):
    return float(np.einsum("i,i->", one.ravel(), other.ravel()))
