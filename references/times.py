"""The times at which transients are asked for, checked once."""

import numpy as np

from demheat.scene.inputs import LEAST, MOST, moderate, reals


def checked_times(times) -> list[float]:
    """Times as floats."""
    valid = f"increasing numbers, 0 or from {LEAST:g} to {MOST:g} s, one at least"
    array = np.atleast_1d(reals("times", times, valid))
    good = array.ndim == 1 and array.size and all(map(moderate, array)) and array[0] >= 0
    if not good or not np.all(np.diff(array) > 0):
        raise ValueError(f"times = {times!r}: must be {valid}")
    return array.tolist()
