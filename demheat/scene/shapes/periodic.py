"""Periodic images of shapes and of points."""

from itertools import product

import numpy as np


def shifts(shape, period: np.ndarray | None) -> list[np.ndarray]:
    """By what the images beside a shape are moved, m: along axes along which it ends; none without a period."""
    if period is None:
        return []
    steps = product(*((-1, 0, 1) if end else (0,) for end in np.isfinite(shape.bounds()[0])))
    return [np.array(step) * period for step in steps if any(step)]


def nearest(offsets: np.ndarray, period: np.ndarray | None) -> np.ndarray:
    """Offsets to the nearest periodic image."""
    return offsets if period is None else offsets - period * np.round(offsets / period)
