"""Exact transients of homogeneous bodies, by series: slab, beam and sphere.

Source: the exact solutions of Haddad et al. 2021, eqs. 17-19 (18-19 as printed swap initial and surface temperature and
lose the radius) and of Terreros et al. 2013, eq. 8 (as printed its coordinate starts at the insulated end). The methods
are those of Carslaw and Jaeger, see `responses`.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from demheat.error import ROUNDING, known
from demheat.field import Field, Samples
from demheat.scene import ROUND_AXES, Convection, Flux, Radiation, Scene, UniformSource, check_scene
from demheat.scene.parts import driver
from references.exact.responses import CROSSOVER, response, sphere_response
from references.exact.robin import EARLIEST, Face
from references.exact.robin import slab as exchanging
from references.midpoints import check_points_per_axis
from references.times import checked_times

KNOWN = (
    "a homogeneous body at one initial temperature, uniformly heated or not: between two opposite walls with constant "
    "temperature, constant flux, convection or insulation, the other walls insulated; or a sphere with a constant "
    "surface temperature"
)


class Body(NamedTuple):
    """One homogeneous body under constant loads."""

    conductivity: float  # float, W/(m K)
    diffusivity: float  # m2/s
    initial: float  # K
    heating: float  # K/s: Rate at which the sources heat the body where nothing is conducted


class Solved(NamedTuple):
    """A solution at one time."""

    form: str  # {"slab", "sphere"}
    fourier: float  # Diffusivity times time over the squared length or radius
    mean_flux: np.ndarray  # (3,) float array, W/m2
    # wall_temperature, heat: dict of str to float, K and W: Of every wall that could be loaded
    wall_temperature: dict
    heat: dict
    temperature: Callable  # callable (n, 3) float array, m -> (n,) float array, K
    flux: Callable  # callable (n, 3) float array, m -> (n, 3) float array, W/m2


def evolve(scene: Scene, times: Sequence[float], *, points_per_axis: int = 24) -> Iterator[Field]:
    """Solve a transient in closed form.

    Parameters
    ----------
    scene : Scene
        With one material, one initial temperature, and either walls across one axis (any body whose sides are straight
        along it, and insulated) or a round wall of a sphere. Sources must be `UniformSource`.
    times : sequence of float, s
        Increasing, >= 0.
    points_per_axis : int
        The samples are the midpoints of this number cubed of parts of equal volume.

    Returns
    -------
    iterator of Field
        One at each time. Truncation is below 1e-16 of what the loads change. At time 0 the temperature is the initial
        one everywhere; heat then enters through a wall at another temperature at an infinite rate.

    Raises
    ------
    ValueError
        If times or the number of points are not as described, or the scene lacks what a transient needs.
    NotImplementedError
        If the scene has no series here.

    Examples
    --------
    >>> from demheat import gallery, Scene
    >>> from references import series
    >>> slab = Scene((0.1, 0.1, 0.1), gallery.HADDAD, walls={"y-": 25.0, "y+": 35.0}, initial=25.0)
    >>> (field,) = series.evolve(slab, [0.1])
    >>> print(f"{field.temperature_at([0.05, 0.075, 0.05])[0]:.4f}")
    29.1488
    """
    check_scene(scene)
    scene.require(steady=False, takes=("exchange",))
    times = checked_times(times)
    check_points_per_axis(points_per_axis)
    body = _body(scene)
    solve = _sphere if "round" in scene.walls else _slab
    _slab_axis(scene)
    return (_field(scene, body, time, solve(scene, body, time), points_per_axis) for time in times)


def _body(scene):
    """What a homogeneous scene is made of."""
    first = scene.matrix
    if any(m != first for m in scene.materials):
        raise NotImplementedError(f"{len(scene.inclusions)} inclusions of other materials: no series; it knows {KNOWN}")
    if first.conductivity == 0:
        raise NotImplementedError("Material.conductivity = 0: nothing is conducted, there is no series")
    if callable(scene.initial):
        raise NotImplementedError("Scene.initial is a function: the series start from one temperature")
    for source in scene.sources:
        if not isinstance(source, UniformSource):
            raise NotImplementedError(
                f"Scene.sources: {type(source).__name__} has no series here; only UniformSource has"
            )
    for name, load in scene.walls.items():
        if callable(driver(load)):
            raise NotImplementedError(f"Scene.walls[{name!r}] depends on time: the series need constants")
        if isinstance(load, Radiation):
            raise NotImplementedError(f"Scene.walls[{name!r}] = {load}: no series, fourth powers are not linear")
    capacity = first.density * first.heat_capacity
    power = sum(source.power_density for source in scene.sources)
    if "round" in scene.walls and (scene.domain != "sphere" or isinstance(scene.walls["round"], Flux | Convection)):
        kind = "a flux through" if isinstance(scene.walls["round"], Flux) else "convection at"
        what = kind if scene.domain == "sphere" else f"a {scene.domain} loaded at"
        raise NotImplementedError(f"{what} a round wall: no series here; it knows {KNOWN}")
    return Body(first.conductivity, first.conductivity / capacity, float(scene.initial), power / capacity)


def _slab_axis(scene):
    """Axis of the loaded flat walls; any axis where all is insulated."""
    axes = {"xyz".index(name[0]) for name in scene.walls if name != "round"}
    if len(axes) > 1:
        raise NotImplementedError(f"Scene.walls = {sorted(scene.walls)}: loads along two axes; it knows {KNOWN}")
    return axes.pop() if axes else 0


def _slab(scene, body, time):
    axis = _slab_axis(scene)
    length, letter = scene.size[axis], "xyz"[axis]
    fourier = body.diffusivity * time / length**2

    def profile(x):
        """Temperature and its derivative along the axis."""
        if scene.wall_exchanges and time > 0:
            return _exchanging(scene, body, letter, fourier, x / length)
        value, slope = np.full_like(x, body.initial + body.heating * time), np.zeros_like(x)
        for name, load in scene.walls.items() if time > 0 else ():
            far = "held" if letter + ("+" if name[1] == "-" else "-") in scene.wall_temperatures else "insulated"
            sign = 1.0 if name[1] == "-" else -1.0
            from_wall = np.clip((x if sign > 0 else length - x) / length, 0.0, 1.0)
            for drive, strength in _drives(body, load, length):
                own = response(from_wall, fourier, drive, far)
                value += strength * own[0]
                slope += sign * strength / length * own[1]
        return value, slope

    def flux(points):
        result = np.zeros((len(points), 3))
        _, slope = profile(points[:, axis])
        result[:, axis] = -body.conductivity * slope
        return result

    def temperature(points):
        value, _ = profile(points[:, axis])
        return value

    ends, slopes = profile(np.array([0.0, length]))
    into = -body.conductivity * scene.volume / length * slopes * [1.0, -1.0]
    mean = np.zeros(3)
    mean[axis] = -body.conductivity * (ends[1] - ends[0]) / length
    names = (letter + "-", letter + "+")
    at_walls, heat = dict(zip(names, ends.tolist(), strict=True)), dict(zip(names, into.tolist(), strict=True))
    return Solved("slab", fourier, mean, at_walls, heat, temperature, flux)


def _exchanging(scene, body, letter, fourier, x):
    """Temperature and slope of a slab with convection at a wall at least."""
    if fourier < EARLIEST:
        raise NotImplementedError(
            f"times: a Fourier number of {fourier:.1e} takes too many modes; {EARLIEST:g} is least"
        )
    length = scene.size["xyz".index(letter)]
    faces = []
    for side in "-+":
        load = scene.walls.get(letter + side, Flux(0.0))
        if isinstance(load, Flux):
            faces.append(Face(0.0, 0.0, load.value * length / body.conductivity))
            continue
        film = load.coefficient * length / body.conductivity if isinstance(load, Convection) else math.inf
        faces.append(Face(film, driver(load) - body.initial, 0.0))
    value, slope = exchanging(np.clip(x, 0.0, 1.0), fourier, *faces, body.heating * length**2 / body.diffusivity)
    return body.initial + value, slope / length


def _drives(body, load, length):
    """Kind and strength of what a wall does to the temperature of the insulated body."""
    if isinstance(load, Flux):
        return [("flux", load.value * length / body.conductivity)]
    step = [("temperature", load - body.initial)]
    return step + ([("ramp", -body.heating * length**2 / body.diffusivity)] if body.heating else [])


def _sphere(scene, body, time):
    radius, center = scene.size[0] / 2, np.array(scene.size) / 2
    fourier = body.diffusivity * time / radius**2

    def profile(r):
        """Temperature and its derivative along the radius; r in radii."""
        value, slope = np.full_like(r, body.initial + body.heating * time), np.zeros_like(r)
        for drive, strength in _drives(body, scene.walls["round"], radius) if time > 0 else ():
            own = sphere_response(r, fourier, drive)
            value += strength * own[0]
            slope += strength / radius * own[1]
        return value, slope

    def radii(points):
        return np.minimum(np.linalg.norm(points - center, axis=1) / radius, 1.0)

    def flux(points):
        r = radii(points)
        _, slope = profile(r)
        along = np.divide(points - center, r[:, None] * radius, out=np.zeros_like(points), where=r[:, None] > 0)
        return -body.conductivity * slope[:, None] * along

    def temperature(points):
        value, _ = profile(radii(points))
        return value

    _, (steepest,) = profile(np.ones(1))
    heat = 4 * math.pi * radius**2 * body.conductivity * float(steepest)
    held = {"round": scene.wall_temperatures["round"]}
    return Solved("sphere", fourier, np.zeros(3), held, {"round": heat}, temperature, flux)


def _field(scene, body, time, solved, n):
    """The Field of a solution at one time, n points per axis in its samples."""
    heat = {name: solved.heat[name] for name in scene.walls}
    for name, load in scene.walls.items():
        if isinstance(load, Flux):
            heat[name] = float(load.value * scene.volume / scene.size["xyz".index(name[0])])
        elif isinstance(load, Convection):
            area = scene.volume / scene.size["xyz".index(name[0])]
            heat[name] = float(load.coefficient * (load.temperature - solved.wall_temperature[name]) * area)
        elif time == 0 and load != body.initial:
            heat[name] = math.copysign(math.inf, load - body.initial)
    return Field(
        scene=scene,
        mean_flux=solved.mean_flux,
        fractions=_fractions(scene, n),
        sampler=lambda: _samples(scene, solved, n),
        temperature_at=solved.temperature,
        flux_at=solved.flux,
        wall_temperature={name: solved.wall_temperature[name] for name in scene.walls} | scene.wall_temperatures,
        wall_heat=heat,
        stats={
            "form": solved.form,
            "fourier": solved.fourier,
            "series": "modes" if scene.wall_exchanges or solved.fourier >= CROSSOVER else "images",
            "truncation": 1e-16,
            "unknowns": 0,
            "iterations": 0,
            "residual": 0.0,
        },
        time=time,
        estimator=_series,
    )


def _series(field):
    """To rounding: the terms that are left out are below it."""
    scale = max(abs(field.scene.initial), *map(abs, field.wall_temperature.values()))
    return known(field, field.stats["truncation"], "exact series", temperature=ROUNDING * scale)


def _fractions(scene, n):
    """Volume fractions of phases that differ in name only."""
    if not scene.inclusions:
        return np.ones(1)
    return np.bincount(scene.phase_at(_midpoints(scene, n)), minlength=len(scene.materials)) / n**3


def _samples(scene, solved, n):
    points = _midpoints(scene, n)
    volumes = np.full(len(points), scene.volume / len(points))
    return Samples(points, volumes, solved.temperature(points), scene.phase_at(points), solved.flux(points))


def _midpoints(scene, n):
    """Middles of n^3 parts of equal volume of the body, in its own coordinates."""
    part = (np.arange(n) + 0.5) / n
    u, v, w = np.stack(np.meshgrid(part, part, part, indexing="ij"), axis=-1).reshape(-1, 3).T
    axes = ROUND_AXES[scene.domain]
    if not axes:
        return np.column_stack([u, v, w]) * scene.size
    points = np.empty((len(u), 3))
    radius = scene.size[axes[0]] / 2
    if len(axes) == 2:
        (along,) = set(range(3)) - set(axes)
        points[:, along], off = u * scene.size[along], np.sqrt(v)
    else:
        along, height, r = 2, 2 * u - 1, np.cbrt(v)
        points[:, along], off = radius * (1 + r * height), r * np.sqrt(1 - height**2)
    first, second = (k for k in range(3) if k != along)
    points[:, first] = radius * (1 + off * np.cos(2 * np.pi * w))
    points[:, second] = radius * (1 + off * np.sin(2 * np.pi * w))
    return points
