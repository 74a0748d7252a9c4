"""Temperatures of a network in time, under a scene's walls and sources."""

import math
from functools import partial
from numbers import Real
from typing import NamedTuple

import numpy as np

from demheat.conduction.integrators import choose, control, euler, rkl2, trbdf2
from demheat.conduction.integrators.pace import ANY, Pace, pace_of
from demheat.conduction.integrators.spectrum import spectrum as spectrum_of
from demheat.conduction.integrators.system import initial_state, load_at, loaded_areas, semi_discrete
from demheat.conduction.steady import Solution
from demheat.network.base import SIDES
from demheat.scene import Flux

# Error that an implicit solve may leave, in units of the accuracy; less for more accuracy, as steps become more.
LINEAR = 0.2
# Where loads ask for more steps than so many, solves leave so much less: what each leaves stays if little heat flows.
FEW = 4.0


def linear_tolerance(accuracy, steps=1):
    """Error that an implicit solve may leave, in units of the span, if loads ask for so many steps at least."""
    return LINEAR * accuracy * min(1.0, math.sqrt(accuracy / control.USUAL), FEW / max(steps, 1))


class State(NamedTuple):
    """Temperatures at an asked time.

    Attributes
    ----------
    time : float, s
    temperature : (n,) float array, K
    stats : dict
        See `integrate`.
    """

    time: float
    temperature: np.ndarray
    stats: dict


def capacities(network, scene):
    """Heat capacity of each particle, density times specific heat times volume, (n,) float array, J/K."""
    per_volume = np.array([material.density * material.heat_capacity for material in scene.materials])
    return per_volume[network.phase] * network.volumes


def check_request(times, integrator, accuracy, step):
    """Raise ValueError unless the asked times, integrator, accuracy and step are sensible; the times as an array."""
    array = _numbers(times)
    if array is None or not np.all(np.isfinite(array)) or array[0] < 0 or np.any(np.diff(array) <= 0):
        raise ValueError(f"times = {times!r}: must be a sequence of numbers, finite, >= 0 s and increasing")
    if integrator not in choose.INTEGRATORS:
        raise ValueError(f"integrator = {integrator!r}: must be one of {', '.join(choose.INTEGRATORS)}")
    if not (_real(accuracy) and 1e-9 <= accuracy <= 0.1):
        raise ValueError(f"accuracy = {accuracy!r}: must lie between 1e-9 and 0.1 of the temperature span")
    if step is not None and not (_real(step) and math.isfinite(step) and step > 0):
        raise ValueError(f"step = {step!r}: must be a finite number > 0 s")
    return array


def _numbers(values):
    """A sequence of numbers as a (k,) float array; None if it is anything else, or empty."""
    try:
        array = np.asarray(values)
    except ValueError:
        return None
    return array.astype(float) if array.ndim == 1 and len(array) and array.dtype.kind in "iuf" else None


def _real(value):
    return isinstance(value, Real) and not isinstance(value, bool)


def integrate(system, temperature, times, *, integrator="auto", accuracy=1e-3, step=None, pace=ANY):
    """March a system from time 0 to the asked times.

    Parameters
    ----------
    system : System
    temperature : (n,) float array, K
        At time 0.
    times : sequence of float, s
    integrator : {"auto", "euler", "rkl2", "tr-bdf2", "tr-bdf2-multigrid"}
    accuracy : float
        Of the temperature span (the range met so far): steps are chosen so that the temporal error, rms over the heat
        capacity, stays about below it. Explicit Euler, as in the papers, takes its largest stable step instead.
    step : float, s, optional
        Equal steps of at most this size instead.
    pace : Pace
        Times at which steps end as well, where loads jump, and the longest steps; equal steps heed the former only.

    Yields
    ------
    State
        With stats integrator, order, steps, rejected, stages, iterations, residual (the largest error that a linear
        solve left, by its recomputed residual, over the span),
        step (the last), step_limit (largest stable step of explicit Euler), positivity_limit, spectral_radius,
        spectral_ratio (to the mean row), heat_change (J), heat_in (J by side and "sources") and energy_error: heat
        change minus heat in, over the heat that came in, went out or moved.

    Raises
    ------
    ValueError
        If an argument is not as described, or `step` is above the stable limit of explicit Euler.
    RuntimeError
        If steps or linear solves do not converge.
    """
    times = check_request(times, integrator, accuracy, step)
    return march(system, temperature, times, integrator=integrator, accuracy=accuracy, step=step, pace=pace)


def march(system, temperature, times, *, integrator="auto", accuracy=1e-3, step=None, pace=ANY):
    """The same as `integrate` of a request that was checked before."""
    accuracy, step = float(accuracy), None if step is None else float(step)
    rates = spectrum_of(system)
    needed = pace.steps(times[-1])
    if integrator == "auto":
        integrator = choose.chosen(
            rates, float(times[-1]), accuracy, max(len(times), needed), moving=len(pace.longest) > 0
        )
    x = initial_state(system, temperature, 0.0)
    span = control.span_of(system, x)
    method = {"euler": euler, "rkl2": rkl2}.get(integrator, trbdf2)
    advance = _stepper(method, system, rates, integrator, linear_tolerance(accuracy, needed), span)
    largest = method.largest_step(rates)
    if step is not None and step > largest * (1 + 1e-12):
        raise ValueError(f"step = {step!r}: explicit Euler is unstable above {largest:.6g} s on this network")
    pace = pace if step is None else Pace(pace.breaks)
    return _marched(system, x, times, method, advance, rates, integrator, accuracy, step, span, pace)


def _stepper(method, system, rates, integrator, tolerance, span):
    if method is not trbdf2:
        return method.stepper(system, rates)
    kind = "multigrid" if integrator.endswith("multigrid") else "jacobi"
    return method.stepper(system, rates, limit=lambda: tolerance * span(), preconditioner=kind)


def _marched(system, x, times, method, advance, rates, integrator, accuracy, step, span, pace):
    start = x.copy()
    if step is None and method.ESTIMATES:
        # The first step changes temperatures by about what it may err.
        first = min(times[-1] or 1.0, 2.0 / max(rates.radius, 1e-300))
        chosen = {"accuracy": accuracy, "span": span, "first": first, "pace": pace}
        states = control.adaptive_steps(advance, system, x, times, **chosen)
    else:
        size = min(step or math.inf, method.largest_step(rates), times[-1] or 1.0)
        states = control.fixed_steps(advance, system, x, times, step=size, span=span, pace=pace)
    for time, now, ledger in states:
        stats = {"integrator": integrator, "order": method.ORDER, "unknowns": int((system.capacity > 0).sum())}
        stats |= _account(system, start, now, ledger) | _limits(rates)
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


def evolve(network, scene, times, *, capacity=None, power=None, passes=(), pinned=None, accuracy=1e-3, **knobs):
    """Temperatures, wall temperatures and wall heat of a network at the asked times.

    Parameters
    ----------
    network : Network
        Of any law.
    scene : Scene
        Its walls and initial temperature.
    times : sequence of float, s
    capacity : (n,) float array, J/K, optional
        Default `capacities`.
    power : callable (time, s) -> (n,) float array, W, optional
        Heat sources.
    passes : sequence of (start, s, stop, s, crossing, s)
        Of moving sources, see `demheat.conduction.sources.passes`; steps heed them.
    pinned : (n,) bool array, optional
        Particles held at the temperature of the wall they touch.
    integrator, accuracy, step
        As in `integrate`.

    Yields
    ------
    time : float, s
    Solution
        Its stats are those of `integrate`.

    Raises
    ------
    ValueError, RuntimeError
        As in `integrate`.
    """
    start = initial_temperature(scene, network.centers)
    capacity = capacities(network, scene) if capacity is None else capacity
    system = semi_discrete(network, scene, capacity, power=power, pinned=pinned, level=float(start.mean()))
    pace = pace_of(changing_loads(scene), passes, float(times[-1]), accuracy)
    for state in march(system, start, times, accuracy=accuracy, pace=pace, **knobs):
        yield state.time, Solution(state.temperature, np.zeros(3), *_walls(network, scene, system, state), state.stats)


def changing_loads(scene):
    """Loads of walls that are functions of time, (time, s) -> float; what is not finite is an error."""
    return [
        partial(load_at, name, load)
        for name, load in (scene.walls or {}).items()
        if callable(load.value if isinstance(load, Flux) else load)
    ]


def initial_temperature(scene, points):
    """Temperature at time 0, (n, 3) float array, m -> (n,) float array, K."""
    if not callable(scene.initial):
        return np.full(len(points), float(scene.initial))
    values = np.asarray(scene.initial(points))
    if values.shape != (len(points),) or values.dtype.kind not in "iuf":
        what = f"shape {values.shape} of {values.dtype}"
        raise ValueError(f"Scene.initial: gives {what} for {len(points)} points; must be real numbers, (n,)")
    odd = np.flatnonzero(~np.isfinite(values))
    if len(odd):
        where = points[odd[0]].tolist()
        raise ValueError(f"Scene.initial = {values[odd[0]]} at {where} m: must be finite at all points of the body")
    return values.astype(float)


def try_functions(scene):
    """Raise ValueError unless the functions of a scene give numbers at time 0, in the middle of the body and near it.

    What they give elsewhere and later is checked where they are asked for.
    """
    for load in changing_loads(scene):
        load(0.0)
    # Within a sphere inscribed in the box as well.
    initial_temperature(scene, np.array(scene.size) * [[0.5, 0.5, 0.5], [0.4, 0.5, 0.6], [0.7, 0.4, 0.5]])


def _walls(network, scene, system, state):
    """Temperature and entering heat of each wall facet at a time."""
    here = state.temperature[network.wall_particle]
    temperature, heat = here.copy(), np.zeros(len(here))
    pinned = np.isin(network.wall_particle, system.held)
    given = _given_on(network, system, state) if pinned.any() else None
    for name, load in (scene.walls or {}).items():
        value, at = load_at(name, load, state.time), network.wall_side == SIDES.index(name)
        conductance = network.wall_conductance[at]
        if name in scene.wall_temperatures:
            temperature[at] = value
            heat[at] = conductance * (value - here[at])
            if pinned.any():
                held = at & pinned
                heat[held] = given[network.wall_particle[held]]
        else:
            heat[at] = value * loaded_areas(network, scene, name)
            temperature[at] += np.divide(heat[at], conductance, out=np.zeros_like(conductance), where=conductance > 0)
    return temperature, heat


def _given_on(network, system, state):
    """Heat that each held particle passes on to its neighbours, (n,) float array, W."""
    ties = system.ties
    flow = ties.conductance * (_tied(system, state) - state.temperature[ties.row])
    return np.bincount(ties.node, flow, minlength=len(network.volumes))


def _tied(system, state):
    """Temperature of the held node of each tie."""
    x = np.zeros(len(system.capacity))
    system.hold(x, state.time)
    return x[system.ties.node] + system.level
