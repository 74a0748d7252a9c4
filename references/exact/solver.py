"""Exact solutions, for the scenes that have one."""

from __future__ import annotations

import math

import numpy as np

from demheat.field import Field, Samples
from demheat.scene import Layer, Scene
from references.exact.forms import coated_spheres, cubic_array, laminate
from references.midpoints import check_points_per_axis, midpoints

KNOWN = (
    "a homogeneous box, layers, a sphere in the middle of a cube, a periodic simple, body- or face-centred cubic cell "
    "of equal spheres, and neutral coated spheres, each under a mean gradient or one pair of opposite walls (with an "
    "imposed flux only where the flux is uniform)"
)


def solve(scene: Scene, *, points_per_axis: int = 24) -> Field:
    """Solve a scene in closed form.

    Parameters
    ----------
    scene : Scene
        Homogeneous, laminate, cubic array of spheres or neutral coated spheres; see `forms`.
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
        If the load does not fix a steady temperature, or drives heat through a body of no conductivity.
    NotImplementedError
        If the scene has no closed form here.
    """
    check_points_per_axis(points_per_axis)
    scene.check_steady()
    closed = laminate(scene) or cubic_array(scene) or coated_spheres(scene)
    if closed is None:
        load = f"gradient {scene.gradient}" if scene.periodic else f"walls {dict(scene.walls)}"
        raise NotImplementedError(
            f"no closed form for {len(scene.inclusions)} inclusions in a box {scene.size} under {load}; exact.solve "
            f"knows {KNOWN}"
        )
    heat, temperatures = {}, {}
    for name in scene.walls or {}:
        axis, sign = "xyz".index(name[0]), 1 if name[1] == "-" else -1
        heat[name] = float(sign * closed.mean_flux[axis] * scene.volume / scene.size[axis])
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
    )


def fractions(scene):
    """Exact volume fraction of each phase, (1 + number of inclusions,) float array.

    Raises
    ------
    NotImplementedError
        If a wall cuts a sphere.
    """
    volumes = [scene.volume]
    for number, inclusion in enumerate(scene.inclusions):
        middle = _middle(scene, inclusion)
        holders = [i for i in range(number) if _holds(scene, scene.inclusions[i], middle)]
        volume = _volume(scene, inclusion)
        volumes.append(volume)
        # The innermost inclusion around it, or the matrix, gives up the place.
        volumes[holders[-1] + 1 if holders else 0] -= volume
    return np.array(volumes) / scene.volume


def _middle(scene, inclusion):
    if not isinstance(inclusion, Layer):
        return np.array(inclusion.center)
    middle = np.array(scene.size) / 2
    middle[inclusion.axis] = (inclusion.start + inclusion.stop) / 2
    return middle


def _holds(scene, inclusion, point):
    if isinstance(inclusion, Layer):
        x = point[inclusion.axis] % scene.size[inclusion.axis] if scene.periodic else point[inclusion.axis]
        return inclusion.start <= x <= inclusion.stop
    apart = point - inclusion.center
    if scene.periodic:
        apart -= np.array(scene.size) * np.round(apart / scene.size)
    return bool(inclusion.contains(apart[None])[0])


def _volume(scene, inclusion):
    if isinstance(inclusion, Layer):
        return (inclusion.stop - inclusion.start) * scene.volume / scene.size[inclusion.axis]
    slack = 1e-12 * max(scene.size)
    ends = [(c - inclusion.radius, c + inclusion.radius) for c in inclusion.center]
    if not scene.periodic and any(a < -slack or b > n + slack for (a, b), n in zip(ends, scene.size, strict=True)):
        raise NotImplementedError(f"no closed form for the volume of a sphere at {inclusion.center} cut by a wall")
    return 4 / 3 * math.pi * inclusion.radius**3


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
