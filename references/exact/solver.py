"""Exact solutions, for the scenes that have one."""

import numpy as np

from demheat.error import known
from demheat.field import Field, Samples
from demheat.scene import Scene, check_scene
from demheat.scene.volumes import fractions
from demheat.tensor import axis_loads
from references.exact.fibre_forms import fibre_array
from references.exact.forms import coated_spheres, cubic_array, insulated, laminate
from references.exact.kirchhoff import layers, transformed
from references.exact.layers import tensor_laminate
from references.midpoints import check_points_per_axis, midpoints

KNOWN = "layers, arrays of spheres or fibres and few more; its docstring lists them"


def solve(scene: Scene, *, points_per_axis: int = 24) -> Field:
    """Solve a scene in closed form.

    Parameters
    ----------
    scene : Scene
        A homogeneous box, layers, a sphere in the middle of a cube, a periodic simple, body- or face-centred cubic
        cell of equal spheres, spheres apart in a matrix of no conductivity, or neutral coated spheres; see `forms`. A
        periodic square or hexagonal array of fibres along one axis, or a fibre in the middle of a square box; see
        `fibre_forms`. Layers of tensors, between walls where these bend no flux; see `layers`. Layers across that
        follow the temperature, and all else that does so alike; see `kirchhoff`. Each under a mean gradient or one pair
        of opposite walls, with an imposed flux only where the flux is uniform.
    points_per_axis : int
        The samples are the midpoints of so many equal cells along each axis.

    Returns
    -------
    Field
        In a periodic cell the temperature is the mean gradient times the position plus a periodic part; `stats` says
        which form it is and how many digits are right.

    Raises
    ------
    ValueError
        If the load does not fix a steady temperature, or drives heat through a body of no conductivity, or if perfect
        conductors join two temperatures.
    NotImplementedError
        If the scene has no closed form here.

    Examples
    --------
    >>> from demheat import gallery
    >>> from references import exact
    >>> field = exact.solve(gallery.sphere_in_cube(5.0))
    >>> print(f"{field.conductivity:.6f}")
    42.640335
    >>> field.flux_at([[0.05, 0.05, 0.05]]).round(2)  # against y, down the gradient
    array([[    0.  , -7767.43,     0.  ]])
    """
    check_scene(scene)
    check_points_per_axis(points_per_axis)
    scene.require(steady=True, takes=("resistance", "anisotropy", "dependence", "perfect"))
    if scene.anisotropic:
        scene.require("layers of tensors are finite ones here", takes=("resistance", "anisotropy", "dependence"))
    closed = (layers(scene) or transformed(scene, _linear)) if scene.varies else _linear(scene)
    if closed is None:
        load = "a mean gradient" if scene.periodic else f"walls {', '.join(sorted(scene.walls))}"
        raise NotImplementedError(
            f"no closed form for {len(scene.inclusions)} inclusions under {load}; exact.solve knows {KNOWN}"
        )
    heat, temperatures = {}, {}
    for name in scene.walls or {}:
        axis, sign = "xyz".index(name[0]), 1 if name[1] == "-" else -1
        heat[name] = 0.0 + float(sign * closed.mean_flux[axis] * scene.volume / scene.size[axis])
        temperatures[name] = _wall_mean(scene, closed, axis, name[1])
    return Field(
        scene=scene,
        mean_flux=closed.mean_flux,
        fractions=fractions(scene),
        sampler=lambda: _samples(scene, closed, points_per_axis),
        temperature_at=lambda points: closed.temperature(np.asarray(points, dtype=float).reshape(-1, 3)),
        flux_at=lambda points: closed.flux(np.asarray(points, dtype=float).reshape(-1, 3)),
        wall_temperature={**temperatures, **scene.wall_temperatures},
        wall_heat=heat,
        stats={"form": closed.form, "iterations": 0, "residual": 0.0, **closed.stats},
        estimator=_digits,
    )


def _linear(scene):
    """The closed form of a scene whose conductivities do not depend on temperature."""
    if scene.anisotropic:
        return tensor_laminate(scene)
    return laminate(scene) or insulated(scene) or cubic_array(scene) or coated_spheres(scene) or fibre_array(scene)


def solve_axes(scene: Scene, *, points_per_axis: int = 24) -> tuple[Field, Field, Field]:
    """Solve a scene in closed form for loads along x, y and z; the multipoles of an array are found once."""
    return tuple(solve(load, points_per_axis=points_per_axis) for load in axis_loads(scene))


def _digits(field):
    """By the digits that the form knows of itself; those of the temperature are at least those of the flux."""
    digits = field.stats["digits"]
    warm, cold = max(field.wall_temperature.values(), default=0.0), min(field.wall_temperature.values(), default=0.0)
    span = warm - cold if not field.scene.periodic else float(np.abs(field.scene.gradient) @ field.scene.size)
    flux = 10.0 ** -field.stats.get("field_digits", digits)
    return known(field, 10.0**-digits, f"exact to {digits:.0f} digits", temperature=flux * span)


def _wall_mean(scene, closed, axis, side):
    """Area-averaged temperature of a wall: linear pieces, each at its middle."""
    pieces = np.diff(closed.breaks) if axis != closed.normal else np.ones(1)
    points = np.tile(np.array(scene.size) / 2, (len(pieces), 1))
    if axis != closed.normal:
        points[:, closed.normal] = (closed.breaks[1:] + closed.breaks[:-1]) / 2
    points[:, axis] = 0.0 if side == "-" else scene.size[axis]
    return float(np.average(closed.temperature(points), weights=pieces))


def _samples(scene, closed, points_per_axis):
    points, volumes = midpoints(scene, points_per_axis)
    return Samples(points, volumes, closed.temperature(points), scene.phase_at(points), closed.flux(points))
