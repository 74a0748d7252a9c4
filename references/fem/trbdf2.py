"""TR-BDF2: half a trapezoidal step, then a backward difference; second order and L-stable, with an estimate of error.

Source: Bank et al., IEEE Trans. Electron Devices 32 (1985) 1992; as a Runge-Kutta method with three stages, the first
explicit and equal to the last of the step before: Hosea and Shampine, Appl. Numer. Math. 20 (1996) 21.
"""

import math
from typing import NamedTuple

import numpy as np

from demheat.scene.pace import ANY
from references.fem.loads import Loads

GAMMA = 2 - math.sqrt(2)  # place of the middle stage: both stages then have the same matrix
DIAGONAL = GAMMA / 2
WEIGHTS = np.array([math.sqrt(2) / 4, math.sqrt(2) / 4, DIAGONAL])
# Weights of the third-order method on the same stages (Hosea and Shampine): the difference estimates the error.
THIRD = np.array([1 - WEIGHTS[0], 1 + 3 * WEIGHTS[0], DIAGONAL]) / 3
# A step grows by at least the first factor (else all that is set up is kept) and at most the second.
GROWTH = (1.25, 4.0)
SHRINK, SAFETY = 0.2, 0.9
# The error itself needs two digits only.
ERROR_TOLERANCE = 1e-2
# Of Newton's method in a stage, where walls radiate: at most, and until tangents are those of the last temperatures.
ROUNDS, CHORDS = 40, 3
# Estimates below this part of the temperature's own size are rounding.
LEAST_SPAN = 1e-9
# Give up when steps become shorter than this part of the way, and of the first one tried: ways far beyond the steady
# state begin with shorter ones.
SHORTEST, SHORTEST_OF_FIRST = 1e-12, 1e-6


class State(NamedTuple):
    """All at one time."""

    time: float  # s
    temperature: np.ndarray  # (n,) float array, K
    rate: np.ndarray  # (n,) float array, K/s
    entering: np.ndarray  # (n,) float array, W: Heat that nodes of held walls draw in; elsewhere the residual
    rates: np.ndarray  # (m,) float array, W: Heat through each wall, from the sources, and lost by clipped sources
    heats: np.ndarray  # (m,) float array, J: The same since the start, integrated with the weights of the stages
    turnover: float  # J: Sum of the absolute values of what enters
    span: np.ndarray  # (2,) float array, K: Lowest and highest temperature so far


class Problem(NamedTuple):
    """Equations, loads and solver."""

    loads: Loads
    solver: object
    free: np.ndarray  # (m,) int array: Nodes that no wall holds


def begin(problem, temperature, time, hint) -> State:
    """State at the start, walls at their temperatures."""
    loads, free, held = problem.loads, problem.free, problem.loads.held
    loading = loads.at(time)
    y, rate = temperature.copy(), np.zeros_like(temperature)
    y[held] = loading.temperature
    # What the walls give at once to their nodes: what each weighs times its jump.
    jump = np.asarray(loads.space.mass.sum(axis=1)).ravel()
    heats = loads.shares(jump * (y - temperature), loading._replace(powers=0 * loading.powers))
    if len(held):
        soon, later = (loads.at(time + part * hint).temperature for part in (1, 2))
        rate[held] = (4 * soon - 3 * loading.temperature - later) / (2 * hint)
    given = loading.heat + loads.radiated(y, loading)
    load = given - loads.stiffness @ y - loads.space.mass @ rate
    rate[free] = problem.solver.rates(load[free])
    entering = loads.space.mass @ rate + loads.stiffness @ y - given
    span = np.array([min(temperature.min(), y.min()), max(temperature.max(), y.max())])
    rates = loads.rates(entering, y, loading)
    return State(time, y, rate, entering, rates, heats, float(np.abs(heats[:-1]).sum()), span)


def begin_again(problem, state, time, hint) -> State:
    """State a moment later, when loads have jumped."""
    new, (low, high) = begin(problem, state.temperature, time, hint), state.span
    span = np.array([min(low, new.span[0]), max(high, new.span[1])])
    return new._replace(heats=state.heats + new.heats, turnover=state.turnover + new.turnover, span=span)


def advance(problem, state, step, *, estimate):
    """One step."""
    y, tau = state.temperature, DIAGONAL * step
    if problem.loads.robin.radiates:
        problem.solver.stiffen(_tangent(problem, y))
    half = y + tau * state.rate
    middle = _stage(problem, state, state.time + GAMMA * step, tau, half, half + tau * state.rate)
    start = y + step * WEIGHTS[0] * (state.rate + middle.rate)
    slope = state.rate + (middle.rate - state.rate) / GAMMA
    last = _stage(problem, state, state.time + step, tau, start, start + tau * slope)
    stages = (state, middle, last)
    heat = [step * w * s.rates for w, s in zip(WEIGHTS, stages, strict=True)]
    new = last._replace(
        heats=state.heats + sum(heat),
        turnover=state.turnover + float(np.abs(heat)[:, :-1].sum()),
        span=np.array([min(state.span[0], last.temperature.min()), max(state.span[1], last.temperature.max())]),
    )
    return new, _error(problem, stages, step) if estimate else 0.0


def _tangent(problem, y):
    """What radiation adds to the stiffness of the free nodes."""
    tangent = problem.loads.robin.tangent(y + problem.loads.level)
    return tangent[problem.free][:, problem.free]


def _stage(problem, state, time, tau, start, guess):
    """Solve M (y - start) / tau + K y = heat at a time."""
    loads, free = problem.loads, problem.free
    mass, stiffness, loading = loads.space.mass, loads.stiffness, loads.at(time)
    y = guess
    y[loads.held] = loading.temperature
    scale, largest = mass @ state.rate, problem.solver.tolerance * (abs(loads.level) + float(np.abs(y).max(initial=0)))
    for rounds in range(ROUNDS + 1):
        if rounds >= CHORDS:
            problem.solver.stiffen(_tangent(problem, y))
        given = loading.heat + loads.radiated(y, loading)
        load = given - stiffness @ y - mass @ ((y - start) / tau)
        change = problem.solver.solve(tau, load[free], scale=scale[free], level=y[free])
        y[free] += change
        # Without radiation once is enough; with it the tangents of the step's start are mostly near.
        if not loads.robin.radiates or np.abs(change).max(initial=0.0) <= largest:
            break
        if rounds == ROUNDS:
            raise RuntimeError(f"finite elements: radiation not met in {ROUNDS} rounds at {time:.6g} s")
    rate = (y - start) / tau
    entering = mass @ rate + stiffness @ y - loading.heat - loads.radiated(y, loading)
    return State(time, y, rate, entering, loads.rates(entering, y, loading), state.heats, 0.0, state.span)


def _error(problem, stages, step):
    """Estimated error, damped by one solve with the matrix of the stages as Hosea and Shampine do."""
    mass, free = problem.solver.mass, problem.free
    raw = step * sum(w * s.rate[free] for w, s in zip(WEIGHTS - THIRD, stages, strict=True))
    if not raw.any():
        return 0.0
    tau = DIAGONAL * step
    error = problem.solver.solve(tau, mass @ raw / tau, tolerance=ERROR_TOLERANCE)
    return math.sqrt(max(error @ (mass @ error), 0.0) / problem.loads.space.mass.sum())


class Clock:
    """Steps from asked time to asked time: given ones, or as long as the wanted accuracy and the loads allow.

    Jumps of loads lie between two breaks that are no farther apart than twice `leap`, s: what is between is left out.
    """

    def __init__(self, problem, accuracy, step=None, *, pace=ANY, leap=0.0):
        self.problem, self.accuracy, self.given, self.wanted = problem, accuracy, step, None
        self.steps, self.rejected, self.last, self.first = 0, 0, 0.0, 0.0
        # A jump right after the start has its first break there.
        at_once = len(pace.breaks) and pace.breaks[0] <= 2 * leap
        self.pace, self.leap, self.broken = pace, leap, 0.0 if at_once else -math.inf

    def run(self, state, time):
        """State at a later time."""
        if self.given is not None:
            return self._equal(state, time)
        ahead = (self.pace.breaks > state.time) & (self.pace.breaks < time)
        for stop in (*self.pace.breaks[ahead].tolist(), time):
            if stop - self.broken <= 2 * self.leap:
                state, self.wanted = begin_again(self.problem, state, stop, 1e-3 * self.first or self.leap), None
            else:
                state = self._chosen(state, stop)
            if stop in self.pace.breaks:
                self.broken = stop
        return state

    def _chosen(self, state, time):
        if self.wanted is None:
            self.wanted = self.first = first_step(state, time)
        while state.time < time:
            left, most = time - state.time, min(self.wanted, self.pace.allowed(state.time))
            step = left if most >= left * (1 - 1e-9) else min(most, left / 2)
            # What is left between two times that were asked for may be as short as they are near.
            if step < min(left, SHORTEST * time, SHORTEST_OF_FIRST * self.first):
                raise RuntimeError(
                    f"finite elements: step {step:.2e} s at {state.time:.6g} s after {self.steps} steps: the estimated "
                    "error does not fall; a load changes too fast"
                )
            new, error = advance(self.problem, state, step, estimate=True)
            if self._accepts(new, error, step):
                self.steps, self.last = self.steps + 1, float(step)
                state = new._replace(time=time) if step == left else new
            else:
                self.rejected += 1
        return state

    def _equal(self, state, time):
        count = max(1, math.ceil((time - state.time) / self.given * (1 - 1e-9)))
        begin, step = state.time, (time - state.time) / count
        for number in range(1, count + 1):
            state, _ = advance(self.problem, state, step, estimate=False)
            state = state._replace(time=time if number == count else begin + number * step)
        self.steps, self.last = self.steps + count, step
        return state

    def _accepts(self, new, error, step):
        low, high = new.span
        limit = self.accuracy * max(high - low, LEAST_SPAN * max(abs(low), abs(high), 1.0))
        factor = SAFETY * (limit / error) ** (1 / 3) if error > 0 else GROWTH[1]
        accepted = error <= limit
        if not accepted:
            self.wanted = step * max(min(factor, SAFETY), SHRINK)
        elif factor > GROWTH[0]:
            # A step cut short to end at an asked time says nothing against longer ones.
            self.wanted = max(self.wanted, step * min(factor, GROWTH[1]))
        elif factor < 1 and step == self.wanted:
            self.wanted *= factor
        return accepted


def first_step(state, time):
    """A short first step: a hundredth of the way, or what the fastest node takes for a twentieth of the span."""
    step, fastest = (time - state.time) / 100, np.abs(state.rate).max()
    span = state.span[1] - state.span[0]
    return min(step, 0.05 * span / fastest) if span > 0 and fastest > 0 else step
