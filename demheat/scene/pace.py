"""Where loads ask steps to end and how long steps may be, besides what the estimated error says.

An estimated error sees a load at the stages of a step only: a pulse between two of them is not in it.
"""

import math
from typing import NamedTuple

import numpy as np

# Functions of time are sampled at so many equal parts of the run; neighbours that differ by this part of the range are
# looked at for a jump between them, which is then known to this part of the run.
SAMPLES, STEEP, SHARP = 1000, 0.02, 1e-9
# A jump has this part of a difference in one half of its interval, at every halving down to a quarter at least.
MAJOR = 0.75
# A step takes in no more than this part of a function's range, and no more than this part of the run.
TAKEN, WIDEST = 0.2, 0.05
# More steps than this are not counted beforehand.
COUNTED = 10_000


class Pace(NamedTuple):
    """Times at which steps end, and windows of time with the longest step in each."""

    # (b,) float array, s: Increasing; something changes at once there, so that methods start anew
    breaks: np.ndarray = np.empty(0)
    # start, stop, longest: (m,) float arrays, s
    start: np.ndarray = np.empty(0)
    stop: np.ndarray = np.empty(0)
    longest: np.ndarray = np.empty(0)

    def allowed(self, now):
        """Longest step from a time on, s: up to the start of a window, or its own longest step."""
        ahead = self.stop > now
        return float(np.min(np.maximum(self.start - now, self.longest)[ahead], initial=math.inf))

    def least(self, now, end):
        """Longest step that suits all windows between two times."""
        met = (self.stop > now) & (self.start < end)
        return float(np.min(self.longest[met], initial=math.inf))

    def stops(self, times):
        """Times at which steps end, as pairs (time, asked for); breaks after the last time are left out."""
        asked = set(map(float, times))
        return [(end, end in asked) for end in sorted(asked | {t for t in self.breaks.tolist() if 0 < t < times[-1]})]

    def steps(self, end):
        """Number of steps that are needed until a time at least, up to 10000."""
        now, count = 0.0, len(self.breaks)
        while now < end and count < COUNTED:
            now, count = now + self.allowed(now), count + 1
        return count


ANY = Pace()


def paced(breaks, windows, end) -> Pace:
    """What breaks, and windows as rows of start, stop and longest step, ask of a run until a time."""
    inside = sorted({t for t in breaks if 0 < t < end})
    return Pace(np.array(inside, dtype=float), *np.array(windows, dtype=float).reshape(-1, 3).T)


def sampled(function, end):
    """Both sides of each jump of a function of time, and windows of its longest steps."""
    times = np.linspace(0.0, end, SAMPLES + 1)
    values = np.array([function(time) for time in times.tolist()])
    reach, spacing = float(np.ptp(values)), end / SAMPLES
    # Rounding is no change.
    if not reach > 1e-12 * float(np.abs(values).max()):
        return [], []
    change = np.abs(np.diff(values))
    jumps = []
    for k in np.flatnonzero(change > STEEP * reach):
        found = _jump(function, (times[k], times[k + 1]), (values[k], values[k + 1]), SHARP * end)
        if found:
            jumps += found
            change[k] = 0.0
    longest = spacing * np.clip(TAKEN * reach / np.maximum(change, 1e-300), 1.0, WIDEST * SAMPLES)
    strict = np.flatnonzero(longest < WIDEST * end * (1 - 1e-12))
    windows = list(zip(times[strict], times[strict + 1], longest[strict], strict=True))
    return jumps, [(0.0, end, WIDEST * end), *windows]


def _jump(function, at, values, sharp):
    """Both sides of a jump between two times, by halving; None if the function has a slope there."""
    (low, high), (left, right) = map(float, at), values
    wide = high - low
    while high - low > sharp:
        middle = 0.5 * (low + high)
        here = function(middle)
        if abs(here - left) < MAJOR * abs(right - left) and abs(right - here) < MAJOR * abs(right - left):
            break
        if abs(here - left) > abs(right - here):
            high, right = middle, here
        else:
            low, left = middle, here
    return [low, high] if high - low <= wide / 4 else None
