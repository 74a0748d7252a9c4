"""Transient conduction by finite elements: tetrahedra or bricks in space, TR-BDF2 in time."""

import time as clock
from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np

from demheat.field import Field
from demheat.runtime.limits import check_steps
from demheat.runtime.process_state import one_blas_thread
from demheat.scene import Scene, check_scene
from demheat.scene.functions import changing_loads, initial_at
from demheat.scene.inputs import chosen, finite, whole
from demheat.scene.pace import SHARP, paced, sampled
from references.fem.bricks import EDGES as BRICKS
from references.fem.bricks import checked_size, hexahedra
from references.fem.estimate import estimated
from references.fem.implicit import Shifted
from references.fem.loads import Loads
from references.fem.sources import check_sources
from references.fem.space import tetrahedra
from references.fem.trbdf2 import Clock, Problem, begin
from references.mesh import make, make_round, split
from references.times import checked_times

# Cube root of the body's volume over the default edge: 2.5e4 unknowns at either order, each solved some hundred times.
EDGES = {1: 30, 2: 16}
# Or if that is more, this times the cube root of the number of spheres, or other bounded inclusions.
EDGES_APART = 8
# That a step takes, of the smallest mesh.
LEAST_SECONDS = 5e-4


def evolve(
    scene: Scene,
    times: Sequence[float],
    *,
    order: int | None = None,
    size: float | None = None,
    elements: str = "tetrahedra",
    step: float | None = None,
    accuracy: float = 2e-5,
    tolerance: float = 1e-9,
) -> Iterator[Field]:
    """Let a scene evolve from its initial temperature.

    The mass matrix is consistent. Where a wall's temperature jumps, temperatures a node or two away overshoot at first
    by some per cent of the jump, in elements longer than the heat has come; TR-BDF2 damps that.

    Parameters
    ----------
    scene : Scene
        A box with its inclusions, or a round body without; no pores.
    times : sequence of float, s
        At which a Field is wanted: increasing, the first not negative.
    order : {1, 2}, optional
        Linear or quadratic (and on curved surfaces curved) tetrahedra. Default: 2; bricks are trilinear, order 1.
    size : float, m, optional
        Longest wanted edge. Default: the cube root of the body's volume over 16 (order 2), 30 (order 1), 32 (bricks).
    elements : {"tetrahedra", "hexahedra"}
        The latter are the bricks of a grid, for boxes with layers at most, or the voxels of an image.
    step : float, s, optional
        Longest time step; steps are then equal between two asked times. Default: by the estimated error and by where
        loads jump or change fast, of which a thousand parts of the run tell: a shorter pulse needs asked times.
    accuracy : float
        Largest estimated error of one step, root mean square over the body, as a part of the span of all temperatures
        so far; unused if a step is given.
    tolerance : float
        Largest relative residual of the linear equations, scaled to a unit diagonal.

    Yields
    ------
    Field
        `wall_heat` is what enters at that very time. `stats` counts, in J since time 0, `heat_in` by wall and
        "sources", with the weights of the integrator, `heat_change` of the body, and what clipped sources lost,
        `heat_lost`; `energy_error` is the difference of the first two as a part of all heat moved. A wall that starts
        at another temperature than the body gives its nodes the difference at time 0: that counts as entered.

    Raises
    ------
    ValueError
        If an argument is not as described, the scene lacks what a transient needs, or a source leaves the body.
    NotImplementedError
        For pores, inclusions or moving sources in round bodies, hexahedra where they do not fit or surfaces resist,
        touching surfaces.
    RuntimeError
        If meshing fails, the residual stays above the tolerance, or the step shrinks to nothing.

    Examples
    --------
    >>> from demheat import gallery, Material, Scene
    >>> from references import fem, series
    >>> scene = Scene((0.1, 0.02, 0.02), gallery.HADDAD, walls={"x-": 25.0, "x+": 35.0}, initial=25.0)
    >>> (field,), (right,) = fem.evolve(scene, [0.1], elements="hexahedra", size=0.01), series.evolve(scene, [0.1])
    >>> point = [0.075, 0.01, 0.01]
    >>> print(f"{field.temperature_at(point)[0]:.2f} {right.temperature_at(point)[0]:.2f}")
    29.29 29.15
    """
    check_scene(scene)
    takes = ("resistance", "exchange", "image")
    scene.require("in time finite elements know one number for each phase", steady=False, takes=takes)
    scene.require("heat would not move in pores; transients do without", pores=False, takes=takes)
    times = checked_times(times)
    order = _checked_order(order, elements)
    for name, value in (("accuracy", accuracy), ("tolerance", tolerance)):
        finite(name, value, "a number between 0 and 1", lambda v: 0 < v < 1)
    if step is not None:
        finite("step", step, "a finite number > 0 s", lambda v: v > 0)
        check_steps("step", step, times[-1] / step, LEAST_SECONDS, remedy="larger")
    check_sources(scene, times[-1])
    if elements == "hexahedra":
        checked_size(scene, size)
    else:
        scene.require("in time tetrahedra follow shapes; use elements='hexahedra'", takes=takes[:2])
    knobs = {"step": step, "accuracy": accuracy, "tolerance": tolerance}
    return _alone(_fields(scene, times, {"elements": elements, "order": order, "size": size}, **knobs))


def _alone(fields):
    """With one thread of BLAS while a field is made, see `solve`; between them it has those of before."""
    while True:
        with one_blas_thread():
            field = next(fields, None)
        if field is None:
            return
        yield field


def _fields(scene, times, cells, *, coarser=1.0, step, accuracy, tolerance):
    space, kind = _space(scene, **cells, coarser=coarser), "curved" if cells["order"] == 2 else "linear"
    initial = initial_at(scene, space.points)
    level = float(np.mean(initial))
    loads = Loads(scene, space, level=level)
    free = np.setdiff1d(np.arange(len(initial)), loads.held)
    blocks = (matrix[free][:, free] for matrix in (space.mass, loads.stiffness))
    # Robin's condition makes the equations of the axes more than sums of products.
    inverse = space.separable(free) if space.separable and len(free) and not loads.robin.walls else None
    solver = Shifted(*blocks, space.quadratic(free), tolerance, inverse)
    problem = Problem(loads, solver, free)
    ticks = Clock(problem, accuracy, step, pace=_pace(scene, times[-1]), leap=SHARP * times[-1])
    begun = clock.perf_counter()
    # A thousandth of the first step asked for, or of the time to the first field.
    hint = 1e-3 * (step or max(times[0], times[-1]) / 100 or 1.0)
    state = begin(problem, initial - level, 0.0, hint)
    for time in times:
        if time > state.time:
            state = ticks.run(state, time)
        stats = {"steps": ticks.steps, "rejected": ticks.rejected, "step": ticks.last, "unknowns": len(free)}
        stats |= {"iterations": solver.iterations, "residual": solver.residual, "setups": solver.setups}
        stats |= {"solve_s": clock.perf_counter() - begun}
        again = partial(_at, scene, float(time), cells, step=step, accuracy=accuracy, tolerance=tolerance)
        estimator = partial(estimated, again=again, kind=kind, steps=accuracy)
        yield _field(scene, problem, state, initial - level, space.stats | stats, estimator)


def _pace(scene, end):
    """Where loads jump until a time, and how long steps may be."""
    found = [sampled(function, end) for function in changing_loads(scene)] if end > 0 else []
    return paced(*([part for each in found for part in each[which]] for which in range(2)), end)


def _at(scene, time, cells, coarser=1.0, size=None, **knobs):
    """The field at one time, on longer elements, or on some of another size."""
    cells = cells if size is None else cells | {"size": size}
    with one_blas_thread():
        (field,) = _fields(scene, [time], cells, coarser=coarser, **knobs)
    return field


def _field(scene, problem, state, initial, stats, estimator):
    loads, space = problem.loads, problem.loads.space
    solution = space.view(state.temperature + loads.level)
    change = float(np.sum(space.mass @ (state.temperature - initial)))
    heats = dict(zip(loads.names, state.heats.tolist(), strict=True))
    lost = heats.pop("lost")
    error = abs(change - sum(heats.values())) / state.turnover if state.turnover else abs(change)
    rates = dict(zip(loads.names, state.rates.tolist(), strict=True))
    walls = dict(loads.at(state.time).wall_temperature)
    for name in (*scene.wall_fluxes, *scene.wall_exchanges):
        weights = space.walls[name].weights
        walls[name] = float(weights @ state.temperature / weights.sum()) + loads.level
    return Field(
        scene=scene,
        mean_flux=solution.mean_flux(),
        fractions=space.fractions,
        sampler=one_blas_thread()(solution.samples),
        temperature_at=one_blas_thread()(solution.temperature_at),
        flux_at=one_blas_thread()(solution.flux_at),
        wall_temperature=walls,
        wall_heat={name: rates[name] for name in scene.walls},
        estimator=estimator,
        stats=stats | {"heat_in": heats, "heat_lost": lost, "heat_change": change, "energy_error": error},
        time=state.time,
    )


def _space(scene, elements, order, size, coarser):
    if elements == "hexahedra" and scene.image is not None:
        return hexahedra(scene, size)
    if elements == "hexahedra":
        return hexahedra(scene, coarser * (scene.volume ** (1 / 3) / BRICKS if size is None else size))
    if size is None:
        bounded = sum(not shape.flat for shape in scene.inclusions)
        size = scene.volume ** (1 / 3) / max(EDGES[order], EDGES_APART * bounded ** (1 / 3))
    if scene.domain == "box":
        return tetrahedra(scene, split(scene, make(scene, size=size, order=order, coarser=coarser)))
    mesh = make_round(scene, size=coarser * size, order=order)
    return tetrahedra(scene, mesh)


def _checked_order(order, elements):
    chosen("elements", elements, ("tetrahedra", "hexahedra"))
    valid = (1, 2) if elements == "tetrahedra" else (1,)
    if order is None:
        return valid[-1]
    return whole("order", order, f"{' or '.join(map(str, valid))} with {elements}", lambda v: v in valid)
