"""Steady conduction on voxels by either of the two schemes."""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache, partial

import numpy as np

from demheat.field import Field
from demheat.runtime.deadline import budget
from demheat.runtime.limits import check_memory
from demheat.runtime.progress import announced
from demheat.scene import Scene
from demheat.scene.perfect import as_good
from demheat.scene.turned import turned as turned_scene
from demheat.tensor import axis_loads
from references.fft import cg, eyre_milton
from references.fft.checks import LAMINATED, PRECISIONS, check_grid, check_load, check_scheme, checked, rule_of
from references.fft.estimate import estimated, extrapolated
from references.fft.grid import Grid
from references.fft.interpolation import asker, flux_at, samples, temperature_at
from references.fft.memory import expected
from references.fft.perfect import check_perfect, check_rule, check_spans
from references.fft.problem import SolvedGrid
from references.fft.rules import warn_of_thin
from references.fft.units import direction, linear_part, mean_flux, order_of, problem_of, units_of, wall_heat
from references.threads import Team
from references.voxels.bodies import bodies, settle
from references.voxels.paint import grid_shape, turned, voxelise

MIB = 2**20
# Voxels along the longest side, where an image does not say.
USUAL = 128
# Knobs that a field's `stats` leaves out.
UNSAID = ("max_iterations", "threads")
SOLVERS = {"cg": cg.solve, "eyre-milton": eyre_milton.solve}


def solve(
    scene: Scene,
    *,
    voxels: int | Sequence[int] | None = None,
    scheme: str = "cg",
    rule: str = "auto",
    precision: str = "float64",
    threads: int | None = 2,
    tolerance: float | None = None,
    max_iterations: int = 5000,
    seconds: float | None = None,
) -> Field:
    """Solve a periodic cell, or a box between two opposite isothermal walls with four insulated sides.

    Memory per voxel, less what its spheres' surfaces take: 52 bytes with "eyre-milton" (7 GB at 512^3), 35 with "cg"
    and a laminate, half of it in single precision; more when fields are asked for.

    Parameters
    ----------
    scene : Scene
    voxels : int or (3,) sequence of int, optional
        Voxels along the longest side, the others as nearly cubic as they can be; or along each side. Default: 128, or
        the voxels of an image, which may be split into equal parts and are all whole: to it a laminate is plain, and
        links have halves of both.  With
        laminates the error goes as a h + c h^3 in the voxel's size h where spheres keep apart: a fifth of them by
        volume, contrast 7.7, 85 voxels across: 0.02 %, and below 0.01 % extrapolated from half of that (`richardson`).
    scheme : {"cg", "eyre-milton"}
        Conjugate gradients on one temperature per voxel (`cg`), or Eyre and Milton's iteration on the flux and
        the gradient with the continuous Green operator (`eyre_milton`).
    rule : {"auto", "plain", "laminate", "links"}
        What a voxel cut by an interface conducts: the phase of its centre; a laminate of its phases; for "cg" also
        seven-point differences with links cut where they cross the interface.  "auto" chooses by contrast.
    precision : {"float64", "float32"}
    threads : int or None
        None takes one per processor.
    tolerance : float, optional
        Relative error at which the iteration stops.  "cg": of the flux's equilibrium, and of the solution in the
        energy norm, 1e-5 by default.  "eyre-milton": of equilibrium and compatibility together, 1e-6 by default.
        From the rounding of the precision, 2.2e-16 or 1.2e-7, up; near it nothing may converge.
        The conductivity is then within 1e-6 of the grid's own limit; for that alone 1e-3 suffices with "cg".
    max_iterations : int
    seconds : float, s, optional
        That it may take, see `demheat.budget`; then TimeoutError. What is asked of the result is not in it.

    Returns
    -------
    Field
        `stats` holds unknowns, iterations, residual (the equilibrium error, relative to the mean flux, recomputed),
        scheme, rule, voxels and precision; for "eyre-milton" also equilibrium and compatibility; iteration_s, wall
        seconds of all iterations, and transform_s, those of them in Fourier transforms (mean over the threads).

    Raises
    ------
    ValueError
        If an argument is not as described, or the grid has too few voxels for the scheme or for links.
    NotImplementedError
        If the load is another, or the scheme or rule cannot do with a zero conductivity that leaves heat a way.
    RuntimeError
        If the iteration does not converge.

    Warns
    -----
    UserWarning
        If an inclusion around another is a coat thinner than a voxel, or an inclusion smaller than a voxel, but for
        layers in laminates; or a gap between two good conductors, or two bad ones, little wider than a voxel.

    Examples
    --------
    >>> from demheat import gallery
    >>> from references import fft
    >>> print(f"{fft.solve(gallery.sphere_in_cube(5.0), voxels=32).conductivity:.2f}")  # exactly 42.640
    42.65
    """
    with budget(seconds):
        knobs = checked(scheme, rule, precision, tolerance, max_iterations, threads)
        check_load(scene)
        return _solved([scene], voxels, knobs)[0]


def solve_axes(
    scene: Scene,
    *,
    voxels: int | Sequence[int] | None = None,
    scheme: str = "cg",
    rule: str = "auto",
    precision: str = "float64",
    threads: int | None = 2,
    tolerance: float | None = None,
    max_iterations: int = 5000,
    seconds: float | None = None,
) -> tuple[Field, Field, Field]:
    """Solve a scene on voxels for loads along x, y and z: painted once, and in a periodic cell planned once.

    The fields are those that `solve` finds for the scenes of `demheat.tensor.axis_loads`, between walls to the rounding
    of the voxels' laminates.
    """
    with budget(seconds):
        knobs = checked(scheme, rule, precision, tolerance, max_iterations, threads)
        loads = axis_loads(scene)
        check_load(scene)
        return tuple(_solved(loads, voxels, knobs))


def _solved(scenes, voxels, knobs):
    """The Field of each of some scenes that differ in their loads only."""
    if not scenes[0].perfect:
        return _finite(scenes, voxels, knobs)
    for scene in scenes:
        check_perfect(scene, knobs.scheme, knobs.precision)
    fields = _finite([as_good(scene) for scene in scenes], voxels, knobs, np.isinf(scenes[0].conductivities))
    return [replace(field, scene=scene) for field, scene in zip(fields, scenes, strict=True)]


def _finite(scenes, voxels, knobs, perfect=None):
    """The same of finite conductivities, some of which stand for infinity."""
    grid, orders = grid_shape(scenes[0], voxels, USUAL), [order_of(scene) for scene in scenes]
    boxes = [turned_scene(scene, order) for scene, order in zip(scenes, orders, strict=True)]
    shapes = [tuple(grid[a] for a in order) for order in orders]
    knobs = rule_of(scenes[0], grid, knobs)
    if perfect is not None:
        check_rule(scenes[0], perfect, knobs.rule)
    for box, shape in zip(boxes, shapes, strict=True):
        check_grid(box, knobs.rule, shape)
    itemsize = np.dtype(PRECISIONS[knobs.precision]).itemsize
    how = {"loads": len(scenes), "anisotropic": scenes[0].anisotropic}
    needed = expected(knobs.scheme, knobs.rule, itemsize, **how) * math.prod(grid)
    check_memory("voxels", voxels or grid, needed, power=3)
    with announced("FFT", needed):
        # Links do not use the laminates, but their fractions are cut as finely and their fields ask which voxels are.
        painted = voxelise(boxes[0], shapes[0], laminate=LAMINATED[knobs.rule])
        if scenes[0].inclusions:
            warn_of_thin(boxes[0], knobs.rule, shapes[0])
        if perfect is not None:
            for box, order in zip(boxes, orders, strict=True):
                check_spans(box, perfect, _as(painted, orders[0], order).phase, linear_part(box)[0])
        return _fields(scenes, boxes, orders, painted, knobs, {"expected_mib": needed / MIB})


def _fields(scenes, boxes, orders, painted, knobs, said):
    """The fields on voxels that are painted; `said` is of their stats."""
    kept, fields = {}, []
    for scene, order, box in zip(scenes, orders, boxes, strict=True):
        same = _as(painted, orders[0], order)
        # Only in a periodic cell is the load's axis any one.
        kept = kept if scene.periodic else {}
        fields.append(_loaded(scene, box, order, same, knobs, kept, said))
    return fields


def _as(painted, before, order):
    """Painted voxels with axes in another order than before."""
    return turned(painted, [before.index(axis) for axis in order])


def _loaded(scene, box, order, painted, knobs, kept, said):
    """The Field of a scene on painted voxels."""
    slope, level = linear_part(box)
    how = {"sharp": knobs.rule == "links", "rings": knobs.scheme == "eyre-milton"}
    grid = Grid(box, order=order, voxels=painted, slope=slope, level=level, **how)
    units = units_of(grid)
    if scene.mean_conductivities.min() == 0:
        grid = grid._replace(bodies=bodies(box, painted, slope, linked=grid.sharp))
        if not grid.bodies.passing.any():
            return _field(scene, grid, units, _at_rest(painted.phase.shape), knobs, said)
    check_scheme(box, knobs.scheme, knobs.rule)
    with Team(knobs.threads) as team:
        problem = kept.get("problem") or problem_of(grid, units, knobs, team)
        kept["problem"] = problem
        problem = problem._replace(team=team, gradient=direction(grid, units))
        solution = SOLVERS[knobs.scheme](problem, kept=kept.setdefault("scheme", {}))
    return _field(scene, grid, units, solution, knobs, said)


def _field(scene, grid, units, solution, knobs, said):
    """The solution in the user's units and axes; what is costly is made when asked for."""

    @cache
    def whole():
        temperature, flux = solution.state()
        temperature *= units.temperature
        flux *= -units.flux
        if grid.voxels.rise is not None:
            own = flux.reshape(3, -1)[:, grid.voxels.cut]
            temperature.reshape(-1)[grid.voxels.cut] -= np.einsum("mi,im->m", grid.voxels.rise, own)
        if grid.bodies is not None:
            settle(grid.bodies, grid.scene, temperature, grid.slope, grid.slope[0] * grid.scene.size[0])
            flux[:, np.append(~grid.bodies.passing, True)[grid.bodies.label]] = 0.0
        return grid._replace(temperature=temperature, flux=flux)

    shape = tuple(grid.voxels.phase.shape[a] for a in np.argsort(grid.order))
    found = {"unknowns": solution.unknowns, "iterations": solution.iterations, **solution.errors, **solution.cost}
    said = said | {name: value for name, value in knobs._asdict().items() if name not in UNSAID}
    again, asked = partial(solve, **knobs._asdict()), asker(whole)
    return Field(
        scene=scene,
        mean_flux=mean_flux(grid, units, solution),
        fractions=grid.voxels.fractions,
        sampler=lambda: samples(whole()),
        temperature_at=lambda points: temperature_at(whole(), asked(points)),
        flux_at=lambda points: flux_at(whole(), asked(points)),
        wall_temperature=scene.wall_temperatures,
        wall_heat=wall_heat(scene, units, solution),
        stats={**found, **said, "voxels": shape},
        estimator=partial(estimated, solve=again),
        extrapolator=partial(extrapolated, solve=again),
    )


def _at_rest(shape):
    """The solution where pores let no heat pass: exactly none, without iterations."""

    def state():
        return np.zeros(shape), np.zeros((3, *shape))

    return SolvedGrid(np.zeros(3), np.zeros(2), state, math.prod(shape), 0, {"residual": 0.0}, {})
