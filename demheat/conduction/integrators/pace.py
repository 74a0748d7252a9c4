"""How moving sources and functions of time pace the steps: a step must not outrun the one nor pass over the other."""

import math

from demheat.runtime.limits import check_steps
from demheat.scene.pace import paced, sampled

# Least seconds that a step takes.
STEP = 1e-5
# Steps as parts of the time in which a source crosses its own diameter: at an accuracy of 1e-3, and at most. The part
# goes with the root of the accuracy, as errors of second order do.
CROSSING, LONGEST = 0.1, 0.25


def pace_of(functions, transits, end, accuracy):
    """What functions of time and moving sources ask of steps."""
    breaks, windows = [], []
    for start, stop, crossing in transits:
        breaks += [start, stop]
        part = min(LONGEST, CROSSING * math.sqrt(accuracy / 1e-3))
        count = max(min(stop, end) - max(start, 0.0), 0.0) / (part * crossing)
        remedy = "slower or wider, or the last time earlier"
        check_steps("Scene.sources: diameter over velocity, s", crossing, count, STEP, remedy=remedy)
        windows += [(start, stop, part * crossing)] if math.isfinite(crossing) else []
    for function in functions:
        jumps, limits = sampled(function, end) if end > 0 else ([], [])
        breaks += jumps
        windows += limits
    return paced(breaks, windows, end)
