"""Steady conduction on voxels: checks, the choice of a rule, units and axes around the two schemes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache, partial
from typing import NamedTuple

import numpy as np

from demheat.field import Field
from demheat.limits import check_memory
from demheat.progress import announced
from demheat.scene import Scene, check_scene
from demheat.scene.inputs import chosen, finite, whole
from demheat.scene.turned import turned as turned_scene
from demheat.tensor import axis_loads
from references.fft import cg, eyre_milton
from references.fft.estimate import estimated
from references.fft.interpolation import Grid, flux_at, samples, temperature_at
from references.fft.link_kernels import Links
from references.fft.memory import expected
from references.fft.problem import Problem, SolvedGrid
from references.fft.rules import LEAST_LINKED, automatic, warn_of_thin
from references.threads import Team, thread_count
from references.voxels.bodies import bodies, settle
from references.voxels.links import links
from references.voxels.paint import grid_shape, turned, voxelise

RULES = {"cg": ("auto", "plain", "laminate", "links"), "eyre-milton": ("auto", "plain", "laminate")}
PRECISIONS = {"float64": np.float64, "float32": np.float32}
# Found at contrasts 0.01 to 100: these leave an error of the conductivity, against the grid's own limit, below 1e-10
# (cg: quadratic in the tolerance, so 1e-3 suffices for 1e-6) and 2e-7, of the flux field 1e-5 and 1e-6 of its mean.
TOLERANCES = {"cg": 1e-5, "eyre-milton": 1e-6}
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
) -> Field:
    """Solve a periodic cell, or a box between two opposite isothermal walls with four insulated sides.

    Memory per voxel, less what its spheres' surfaces take: 52 bytes with "eyre-milton" (7 GB at 512^3), 35 with "cg"
    and a laminate, half of it in single precision; more when fields are asked for.

    Parameters
    ----------
    scene : Scene
    voxels : int or (3,) sequence of int, optional
        Voxels along the longest side, the others as nearly cubic as they can be; or along each side. Default: 128, or
        the voxels of an image, which are all whole: to it a laminate is plain, and links have halves of both.  With
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
    knobs = _checked(scheme, rule, precision, tolerance, max_iterations, threads)
    _check_load(scene)
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
) -> tuple[Field, Field, Field]:
    """Solve a scene on voxels for loads along x, y and z: painted once, and in a periodic cell planned once.

    The fields are those that `solve` finds for the scenes of `demheat.tensor.axis_loads`, between walls to the rounding
    of the voxels' laminates.

    Parameters
    ----------
    scene : Scene
        A periodic cell, or a box between two isothermal walls with four insulated faces.
    voxels, scheme, rule, precision, threads, tolerance, max_iterations
        As those of `solve`, which also says what is raised and warned of.

    Returns
    -------
    tuple of three Fields
        Under loads along x, y and z; `demheat.tensor.conductivity_tensor` takes them.

    Raises
    ------
    NotImplementedError
        If the load is another.
    """
    knobs = _checked(scheme, rule, precision, tolerance, max_iterations, threads)
    loads = axis_loads(scene)
    _check_load(scene)
    return tuple(_solved(loads, voxels, knobs))


def _solved(scenes, voxels, knobs):
    """The Field of each of some scenes that differ in their loads only."""
    grid, orders = grid_shape(scenes[0], voxels, USUAL), [_order(scene) for scene in scenes]
    boxes = [turned_scene(scene, order) for scene, order in zip(scenes, orders, strict=True)]
    shapes = [tuple(grid[a] for a in order) for order in orders]
    if knobs.rule == "auto":
        knobs = knobs._replace(rule=automatic(knobs.scheme, scenes[0], grid))
    if scenes[0].image is not None:
        knobs = _of_image(scenes[0], knobs)
    _check_tensors(scenes[0], knobs.scheme, knobs.rule)
    for box, shape in zip(boxes, shapes, strict=True):
        _check_grid(box, knobs.rule, shape)
    itemsize = np.dtype(PRECISIONS[knobs.precision]).itemsize
    how = {"loads": len(scenes), "anisotropic": scenes[0].anisotropic}
    needed = expected(knobs.scheme, knobs.rule, itemsize, **how) * math.prod(grid)
    check_memory("voxels", voxels or grid, needed, power=3)
    with announced("FFT", needed):
        # Links do not use the laminates, but their fractions are cut as finely and their fields ask which voxels are.
        painted = voxelise(boxes[0], shapes[0], laminate=knobs.rule != "plain")
        if scenes[0].inclusions:
            warn_of_thin(boxes[0], knobs.rule, shapes[0])
        return _fields(scenes, boxes, orders, painted, knobs, {"expected_mib": needed / MIB})


def _fields(scenes, boxes, orders, painted, knobs, said):
    """The fields on voxels that are painted; `said` is of their stats."""
    kept, fields = {}, []
    for scene, order, box in zip(scenes, orders, boxes, strict=True):
        same = turned(painted, [orders[0].index(axis) for axis in order])
        # Only in a periodic cell is the load's axis any one.
        kept = kept if scene.periodic else {}
        fields.append(_loaded(scene, box, order, same, knobs, kept, said))
    return fields


def _loaded(scene, box, order, painted, knobs, kept, said):
    """The Field of a scene on painted voxels."""
    slope, level = _linear_part(box)
    grid = Grid(box, order=order, voxels=painted, slope=slope, level=level, sharp=knobs.rule == "links")
    units = _units(grid)
    if scene.mean_conductivities.min() == 0:
        grid = grid._replace(bodies=bodies(box, painted, slope, linked=grid.sharp))
        if not grid.bodies.passing.any():
            return _field(scene, grid, units, _at_rest(painted.phase.shape), knobs, said)
    _check_scheme(box, knobs.scheme, knobs.rule)
    with Team(knobs.threads) as team:
        problem = kept.get("problem") or _problem(grid, units, knobs, team)
        kept["problem"] = problem
        problem = problem._replace(team=team, gradient=_direction(grid, units))
        solution = SOLVERS[knobs.scheme](problem, kept=kept.setdefault("scheme", {}))
    return _field(scene, grid, units, solution, knobs, said)


class _Knobs(NamedTuple):
    """What the user asks of the scheme, checked; by the names that `stats` has."""

    scheme: str
    rule: str
    precision: str
    tolerance: float
    max_iterations: int
    threads: int


class _Units(NamedTuple):
    """What the problem is divided by, so that neither size nor conductivity meets the limits of float32."""

    length: float
    conductivity: float
    slope: float

    @property
    def flux(self):
        return self.conductivity * self.slope

    @property
    def temperature(self):
        return self.slope * self.length


def _checked(scheme, rule, precision, tolerance, max_iterations, threads):
    chosen("scheme", scheme, RULES)
    if not isinstance(rule, str) or rule not in RULES[scheme]:
        raise ValueError(f"rule = {rule!r}: must be one of {', '.join(RULES[scheme])} for scheme {scheme!r}")
    chosen("precision", precision, PRECISIONS)
    least = float(np.finfo(PRECISIONS[precision]).eps)
    if tolerance is not None:
        valid = f"a number from {least:.2g}, the rounding of {precision}, to below 1"
        finite("tolerance", tolerance, valid, lambda v: least <= v < 1)
    whole("max_iterations", max_iterations, "a whole number >= 1", lambda v: v >= 1)
    tolerance = TOLERANCES[scheme] if tolerance is None else tolerance
    return _Knobs(scheme, rule, precision, tolerance, max_iterations, thread_count(threads))


def _check_load(scene):
    check_scene(scene)
    scene.require(
        "fft.solve knows a periodic cell and two opposite walls with temperatures, the others insulated; only their "
        "homogeneous problem is inverted by sines and cosines here",
        steady=True,
        walls="one isothermal pair",
        takes=("anisotropy", "image"),
    )


def _of_image(scene, knobs):
    """Knobs of an image, none of whose voxels is cut."""
    if knobs.rule != "links":
        return knobs._replace(rule="plain")
    scene.require("links have a harmonic mean; use rule 'plain'", pores=False, takes=("image",))
    return knobs


def _check_grid(box, rule, shape):
    if rule != "links" and not box.periodic and shape[0] < 2:
        raise ValueError(f"voxels: {shape[0]} along the load leaves no node between the walls; must be >= 2")
    linked = rule == "links" and box.mean_conductivities.min() > 0
    if linked and min(shape) < LEAST_LINKED and any(not each.flat for each in box.inclusions):
        raise ValueError(
            f"voxels: {min(shape)} along a side are too few for rule 'links' with round inclusions, which may pass "
            f"Voigt's and Reuss's bounds; must be >= {LEAST_LINKED}, or take rule 'laminate'"
        )


def _check_tensors(box, scheme, rule):
    """Conductivities that are tensors are for the scalar scheme on voxels."""
    if scheme == "eyre-milton":
        box.require("Eyre and Milton's reference is as good in all directions; use scheme 'cg'", takes=("image",))
    if rule == "links":
        box.require("links along the axes see only its diagonal; use rule 'laminate'", takes=("image",))


def _check_scheme(box, scheme, rule):
    """Pores that leave heat a way are for the scalar scheme on voxels."""
    if scheme == "eyre-milton":
        box.require(
            "Eyre and Milton's scheme converges like the square root of the contrast, which is infinite; use scheme "
            "'cg'",
            pores=False,
            takes=("image",),
        )
    if rule == "links":
        box.require("links have a harmonic mean; use rule 'plain'", pores=False, takes=("image",))


def _order(scene):
    """Axes of the scene that are axes 0, 1, 2 of the grid: between walls the load's first."""
    return (0, 1, 2) if scene.periodic else (scene.axis, *(a for a in range(3) if a != scene.axis))


def _linear_part(box):
    """Mean gradient, and the temperature at the origin."""
    if box.periodic:
        return np.array(box.gradient), 0.0
    low, high = box.wall_temperatures["x-"], box.wall_temperatures["x+"]
    return np.array([(high - low) / box.size[0], 0.0, 0.0]), low


def _units(grid):
    conductivity = grid.voxels.conductivity[grid.voxels.fractions > 0].max()
    return _Units(max(grid.scene.size), float(conductivity) or 1.0, float(np.linalg.norm(grid.slope)))


def _problem(grid, units, knobs, team):
    """The problem that a scheme solves."""
    return Problem(
        voxels=_scaled(grid.voxels, units),
        links=_links(grid, units) if knobs.rule == "links" else None,
        gradient=_direction(grid, units),
        walls=not grid.scene.periodic,
        dtype=PRECISIONS[knobs.precision],
        team=team,
        tolerance=knobs.tolerance,
        max_iterations=knobs.max_iterations,
    )


def _direction(grid, units):
    # Equal wall temperatures: any load's solution, times zero.
    return grid.slope / units.slope if units.slope else np.array([1.0, 0.0, 0.0])


def _scaled(voxels, units):
    return voxels._replace(
        spacing=voxels.spacing / units.length,
        conductivity=voxels.conductivity / units.conductivity,
        tensor=voxels.tensor / units.conductivity,
        tensors=None if voxels.tensors is None else voxels.tensors / units.conductivity,
    )


def _links(grid, units):
    found = Links(*links(grid.scene, grid.voxels.phase.shape, phase=grid.voxels.phase))
    # In place: they take as much as three fields.
    for link in found:
        link /= units.conductivity
    return found


def _field(scene, grid, units, solution, knobs, said):
    """The solution in the user's units and axes; what is costly is made when asked for."""
    mean_flux = np.empty(3)
    mean_flux[list(grid.order)] = 0.0 - units.flux * solution.mean_flux

    @cache
    def whole():
        temperature, flux = solution.state()
        temperature *= units.temperature
        flux *= -units.flux
        if grid.bodies is not None:
            settle(grid.bodies, grid.scene, temperature, grid.slope, grid.slope[0] * grid.scene.size[0])
            flux[:, np.append(~grid.bodies.passing, True)[grid.bodies.label]] = 0.0
        return grid._replace(temperature=temperature, flux=flux)

    shape = tuple(grid.voxels.phase.shape[a] for a in np.argsort(grid.order))
    found = {"unknowns": solution.unknowns, "iterations": solution.iterations, **solution.errors, **solution.cost}
    asked = {name: value for name, value in knobs._asdict().items() if name not in UNSAID}
    return Field(
        scene=scene,
        mean_flux=mean_flux,
        fractions=grid.voxels.fractions,
        sampler=lambda: samples(whole()),
        temperature_at=lambda points: temperature_at(whole(), points),
        flux_at=lambda points: flux_at(whole(), points),
        wall_temperature=scene.wall_temperatures,
        wall_heat={} if scene.periodic else _wall_heat(scene, units, solution),
        stats={**found, **asked, **said, "voxels": shape},
        estimator=partial(estimated, solve=partial(solve, **knobs._asdict())),
    )


def _at_rest(shape):
    """The solution where pores let no heat pass: exactly none, without iterations."""

    def state():
        return np.zeros(shape), np.zeros((3, *shape))

    return SolvedGrid(np.zeros(3), np.zeros(2), state, math.prod(shape), 0, {"residual": 0.0}, {})


def _wall_heat(scene, units, solution):
    """Heat into the body through each of the two walls, W."""
    area, name = scene.volume / scene.size[scene.axis], "xyz"[scene.axis]
    low, high = (float(units.flux * end * area) for end in solution.ends)
    return {name + "-": 0.0 - low, name + "+": high}
