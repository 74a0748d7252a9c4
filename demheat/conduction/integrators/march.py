"""A march in time: which integrator takes which steps, and what is said of it."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from demheat.conduction.integrators import choose, control, euler, rkl2, trbdf2
from demheat.conduction.integrators.pace import STEP
from demheat.conduction.integrators.spectrum import spectrum as spectrum_of
from demheat.conduction.integrators.system import System, initial_state
from demheat.network.base import SIDES
from demheat.runtime.limits import check_steps
from demheat.scene.inputs import LEAST, MOST, chosen, finite, moderate, reals
from demheat.scene.pace import ANY, Pace

METHODS = {"euler": euler, "rkl2": rkl2, "tr-bdf2": trbdf2, "tr-bdf2-multigrid": trbdf2}
# An implicit solve may leave an error of this part of the accuracy asked for. What solves leave adds up over the steps,
# and accuracies below `control.USUAL` take more of them: there the part falls with the root of the accuracy.
LINEAR = 0.2
# Loads that change in time may force more steps than the accuracy does. Beyond so many of them the part falls as their
# number grows: where little heat flows, nothing damps what each solve has left.
FEW = 4.0
# Least seconds that a pass over a link takes.
LINK = 5e-10


def linear_tolerance(accuracy, steps=1):
    """Error that an implicit solve may leave, in units of the temperature span."""
    return LINEAR * accuracy * min(1.0, math.sqrt(accuracy / control.USUAL), FEW / max(steps, 1))


class State(NamedTuple):
    """Temperatures at an asked time."""

    time: float  # s
    temperature: np.ndarray  # (n,) float array, K
    stats: dict  # See `integrate`


def check_request(times, integrator, accuracy, step):
    """Check what is asked of a march."""
    array = _numbers(times)
    if array is None or not all(map(moderate, array)) or array[0] < 0 or np.any(np.diff(array) <= 0):
        raise ValueError(f"times = {times!r}: must be increasing numbers, 0 or from {LEAST:g} to {MOST:g} s")
    chosen("integrator", integrator, choose.INTEGRATORS)
    finite("accuracy", accuracy, "between 1e-9 and 0.1 of the temperature span", lambda v: 1e-9 <= v <= 0.1)
    if step is not None:
        finite("step", step, "a finite number > 0 s", lambda v: v > 0)
        _check_steps(float(array[-1]), float(step), 0)
    return array


def _check_steps(end, step, links, limit=None):
    """Refuse more steps than a day holds, of a size that was asked for, or of the largest stable one."""
    if limit is None:
        check_steps("step", step, end / step, STEP + LINK * links, remedy="larger")
    else:
        what = f"explicit Euler, stable up to {limit:.3g} s"
        check_steps("times, the last", end, end / step, STEP + LINK * links, remedy=f"less, or not {what}")


def _check_stages(rates, times, accuracy, seconds):
    """Refuse more stages than a day holds, or than a step may have."""
    end, remedy = float(times[-1]), "less, or tr-bdf2 the integrator"
    work = choose.costs(rates, end, accuracy, len(times))["rkl2"]
    check_steps("times, the last", end, work, seconds, remedy=remedy)
    stages = rkl2.stages_of(end / choose.steps_of(accuracy, len(times)), rates.radius)
    if stages > rkl2.MOST:
        raise ValueError(
            f"times, the last = {end!r}: takes steps of {stages} stages, {work:.2g} in all; must be {remedy}"
        )


def _numbers(values):
    """A sequence of numbers as a (k,) float array; None if it is anything else, or empty."""
    try:
        array = reals("times", values, "numbers")
    except ValueError:
        return None
    return array.copy() if array.ndim == 1 and len(array) else None


def integrate(
    system: System,
    temperature: np.ndarray,
    times: Sequence[float],
    *,
    integrator: str = "auto",
    accuracy: float = 1e-3,
    step: float | None = None,
    pace: Pace = ANY,
):
    """March a system from time 0 to the asked times."""
    times = check_request(times, integrator, accuracy, step)
    return march(system, temperature, times, integrator=integrator, accuracy=accuracy, step=step, pace=pace)


def march(system, temperature, times, *, integrator="auto", accuracy=1e-3, step=None, pace=ANY):
    """The same as `integrate` of a request that was checked before."""
    accuracy, step = float(accuracy), None if step is None else float(step)
    if system.radiation is not None:
        choose.check_linear(integrator)
    rates, needed = spectrum_of(system.bound or system), pace.steps(times[-1])
    if integrator == "auto":
        among = {"moving": len(pace.longest) > 0, "linear": system.radiation is None}
        integrator = choose.chosen(rates, float(times[-1]), accuracy, max(len(times), needed), **among)
    method = METHODS[integrator]
    largest = method.largest_step(rates)
    if step is not None and step > largest * (1 + 1e-12):
        raise ValueError(f"step = {step!r}: explicit Euler is unstable above {largest:.6g} s on this network")
    if step is not None or not method.ESTIMATES:
        limit = None if step is not None else largest
        _check_steps(float(times[-1]), largest if step is None else step, len(system.links.indices), limit)
    elif integrator == "rkl2":
        _check_stages(rates, times, accuracy, STEP + LINK * len(system.links.indices))
    x = initial_state(system, temperature, 0.0)
    span = control.span_of(system, x)
    advance = _stepper(system, rates, integrator, linear_tolerance(accuracy, needed), span)
    known = {"integrator": integrator, "order": method.ORDER} | _limits(rates)
    # The state that was given is overwritten on the way.
    start = x.copy()
    if step is None and method.ESTIMATES:
        # The first step changes temperatures by about what it may err.
        first = min(times[-1] or 1.0, 2.0 / max(rates.radius, 1e-300))
        chosen = {"accuracy": accuracy, "span": span, "first": first, "pace": pace}
        states = control.adaptive_steps(advance, system, x, times, **chosen)
    else:
        size = min(step or math.inf, largest, times[-1] or 1.0)
        heeded = pace if step is None else Pace(pace.breaks)
        states = control.fixed_steps(advance, system, x, times, step=size, span=span, pace=heeded)
    return _reported(system, start, states, span, known)


def _stepper(system, rates, integrator, tolerance, span):
    method = METHODS[integrator]
    if method is not trbdf2:
        return method.stepper(system, rates)
    kind = "multigrid" if integrator.endswith("multigrid") else "jacobi"
    return method.stepper(system, rates, limit=lambda: tolerance * span(), preconditioner=kind)


def _reported(system, start, states, span, known):
    """Each state with what is said of it; those of the march as a whole are known."""
    for time, now, ledger in states:
        stats = known | {"unknowns": int((system.capacity > 0).sum())} | _account(system, start, now, ledger)
        stats["residual"] = ledger.residual / span()
        yield State(float(time), now[: system.particles] + system.level, stats)


def _account(system, start, now, ledger):
    """Steps done and the balance of heat."""
    moved = system.capacity * (now - start)
    change, came = float(moved.sum()), ledger.inflow
    scale = max(float(ledger.through.sum()), float(np.abs(moved).sum()))
    names = (*SIDES, "sources")
    return {
        "steps": ledger.steps,
        "rejected": ledger.rejected,
        "stages": ledger.stages,
        "iterations": ledger.iterations,
        "step": ledger.step,
        "heat_change": change,
        "heat_in": {name: float(heat) for name, heat in zip(names, came, strict=True) if heat},
        "energy_error": abs(change - float(came.sum())) / scale if scale > 0 else 0.0,
    }


def _limits(rates):
    return {
        "step_limit": rates.limit,
        "positivity_limit": rates.positivity,
        "spectral_radius": rates.radius,
        "spectral_ratio": rates.radius / rates.mean_row if rates.mean_row > 0 else 1.0,
        "spectral_iterations": rates.iterations,
    }
