"""Marching to the asked times: equal steps of a given size, or steps chosen by the estimated error.

Both end steps where loads jump, and start anew there: what a method remembers of the step before no longer holds.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from demheat.conduction.integrators.system import ACCOUNTS
from demheat.runtime.progress import in_parts
from demheat.scene.pace import ANY

# How large the estimated error of a step may be, for an accuracy eps at the asked time and n more steps of this size:
#     SAFETY eps (eps / USUAL)^((1 + DAMPED) / 2) n^DAMPED, in units of the temperature span.
# Errors of third order add up to one of second order, so n goes as eps^(-1/2), and eps / n as eps^(3/2). But heat
# conduction damps on the rest of the way what a step did not resolve: an early error counts less than a late one, by
# the last factor, and DAMPED / 2 in the power of eps takes that factor's own growth out again. Found with accuracies
# 1e-2 to 1e-4 on slabs heated from one wall at once (Laguerre, spheres of size ratio 10, contacts; 600 to 1e5
# particles) and under swinging loads: final errors are 0.1 to 0.8 of the accuracy asked for.
SAFETY, DAMPED, USUAL = 0.3, 0.5, 1e-3
# Step factors: cautious, and at most and least from one step to the next.
CAUTION, GROW, CUT = 0.9, 4.0, 0.2
# Give up when steps become smaller than this part of the interval, and of the first one tried: intervals far beyond the
# steady state begin with smaller ones.
TINIEST, TINIEST_OF_FIRST = 1e-12, 1e-6


@dataclass
class Ledger:
    """What was done so far, the largest linear residual, K, and the heat by side, sources last, J.

    `inflow` is what came in, less what went out; `through` adds both, step by step.
    """

    steps: int = 0
    rejected: int = 0
    stages: int = 0
    iterations: int = 0
    step: float = 0.0
    residual: float = 0.0
    inflow: np.ndarray = field(default_factory=lambda: np.zeros(ACCOUNTS))
    through: np.ndarray = field(default_factory=lambda: np.zeros(ACCOUNTS))

    def add(self, done, step, accepted):
        """Count a step."""
        self.stages += done.stages
        self.iterations += done.iterations
        if accepted:
            self.residual = max(self.residual, done.residual)
            self.steps += 1
            self.step = step
            self.inflow = self.inflow + done.inflow
            self.through = self.through + np.abs(done.inflow)
        else:
            self.rejected += 1


class Span:
    """Range of the temperatures met so far, K: the unit of errors."""

    def __init__(self, x, used):
        self.used = used
        self.low, self.high = math.inf, -math.inf
        self.widened(x)

    def widened(self, x):
        """Take in a state; returns the range."""
        here = x[self.used]
        self.low, self.high = min(self.low, float(here.min())), max(self.high, float(here.max()))
        return self.high - self.low

    def __call__(self):
        """Range so far; tiny instead of zero."""
        return max(self.high - self.low, 1e-12 * max(1.0, abs(self.high)))


def span_of(system, x):
    """Range of temperatures of a state, over particles and walls with a temperature."""
    used = np.zeros(len(x), dtype=bool)
    used[: system.particles] = True
    used[system.held] = True
    return Span(x, used)


def fixed_steps(advance, system, x, times, *, step, span, pace=ANY):
    """Equal steps of at most `step` between the asked times and breaks, from time 0."""
    ledger, memory, now, part = Ledger(), None, 0.0, in_parts("march")
    for end, asked in pace.stops(times):
        count = max(0, math.ceil((end - now) / min(step, pace.least(now, end)) * (1 - 1e-12)))
        first = now
        with part() as said:
            for k in range(count):
                size = (end - first) / count
                done = advance(x, first + k * size, size, memory, False)
                x, memory = done.x, done.memory
                ledger.add(done, size, True)
                said((first + (k + 1) * size) / times[-1])
        now = end
        _check_finite(x, ledger, now)
        if asked:
            yield end, x, ledger
        else:
            memory = None


def adaptive_steps(advance, system, x, times, *, accuracy, span, first, pace=ANY):
    """Steps whose estimated error, rms over the heat capacity in units of the span, meets the accuracy at the times."""
    ledger, memory, now, wanted, part = Ledger(), None, 0.0, first, in_parts("march")
    allowed = SAFETY * accuracy * (accuracy / USUAL) ** (0.5 * (1.0 + DAMPED))
    for end, asked in pace.stops(times):
        goal = next(time for time in times if time >= end)
        with part() as said:
            while end - now > TINIEST * end:
                size = _shared(end - now, min(wanted, pace.allowed(now)))
                done = advance(x, now, size, memory, True)
                span.widened(done.x)
                share = _size(system, done.error) / (span() * allowed * ((goal - now) / size) ** DAMPED)
                accepted = share <= 1.0
                ledger.add(done, size, accepted)
                wanted = size * min(GROW, max(CUT, CAUTION * share ** (-1 / 3) if share > 0 else GROW))
                if accepted:
                    x, memory, now = done.x, done.memory, now + size
                    said(now / times[-1])
                elif not wanted > min(TINIEST * end, TINIEST_OF_FIRST * first):
                    raise RuntimeError(
                        f"steps of {wanted:.1e} s at {now:.3e} s after {ledger.rejected} rejections: error not met"
                    )
        now = end
        _check_finite(x, ledger, now)
        if asked:
            yield end, x, ledger
        else:
            memory, wanted = None, first


def _shared(left, wanted):
    """Step of the wanted size, or the last few made equal so that they end on time."""
    return left / max(1, math.ceil(left / wanted * (1 - 1e-9))) if left < 3 * wanted else wanted


def _size(system, error):
    """Root mean square over the heat capacity; zero for a step that could not be judged, the first one."""
    if error is None:
        return 0.0
    return math.sqrt(float(np.einsum("i,i,i->", system.capacity, error, error)) / float(system.capacity.sum()))


def _check_finite(x, ledger, now):
    if not np.all(np.isfinite(x)):
        raise RuntimeError(f"temperatures are not finite at {now:.3e} s after {ledger.steps} steps")
