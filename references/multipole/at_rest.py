"""Spheres apart in a matrix of no conductivity: the answer needs no multipoles."""

import math
from functools import partial

import numpy as np

from demheat.error import known
from demheat.field import Field, Samples
from references.exact.insulated import sphere_temperature
from references.midpoints import midpoints


def at_rest(scene, spheres, points_per_axis) -> Field:
    """The Field of a scene whose matrix has no conductivity: no heat passes."""
    temperature = sphere_temperature(scene)
    if temperature is None:
        raise NotImplementedError("multipole: a matrix of no conductivity, and a sphere from wall to wall")

    def sampler():
        points, volumes = midpoints(scene, points_per_axis)
        return Samples(points, volumes, temperature(points), scene.phase_at(points), np.zeros(points.shape))

    shares = np.bincount(spheres.original, 4 / 3 * math.pi * spheres.radii**3, spheres.count) / np.prod(spheres.size)
    stats = dict.fromkeys(("order", "unknowns", "iterations"), 0)
    stats |= dict.fromkeys(("residual", "truncation", "remainder", "field_truncation"), 0.0)
    return Field(
        scene=scene,
        mean_flux=np.zeros(3),
        fractions=np.concatenate([[1 - shares.sum()], shares]),
        sampler=sampler,
        temperature_at=temperature,
        flux_at=lambda points: np.zeros(points.shape),
        wall_temperature=scene.wall_temperatures,
        wall_heat=dict.fromkeys(scene.walls or {}, 0.0),
        stats=stats,
        estimator=partial(known, relative=0.0, how="no heat passes", temperature=0.0),
    )
