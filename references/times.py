"""The times at which transients are asked for, checked once."""

from __future__ import annotations

import numpy as np

from demheat.scene.inputs import reals


def checked_times(times) -> list[float]:
    """Times as floats.

    Raises
    ------
    ValueError
        Unless they are finite numbers >= 0, increasing, one at least.
    """
    valid = "increasing numbers >= 0, in seconds, one at least"
    array = np.atleast_1d(reals("times", times, valid))
    good = array.ndim == 1 and array.size and np.all(np.isfinite(array)) and array[0] >= 0
    if not good or not np.all(np.diff(array) > 0):
        raise ValueError(f"times = {times!r}: must be {valid}")
    return array.tolist()
