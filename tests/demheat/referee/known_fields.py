"""Fields whose difference is known by construction."""

import numpy as np

from demheat import Field, Material, Samples, Scene

WALLED = Scene((1.0, 2.0, 1.0), Material(3.0), walls={"y-": 10.0, "y+": 30.0})
CELL = Scene((1.0, 2.0, 1.0), Material(3.0), gradient=(0.0, 10.0, 0.0))
POINTS = np.array([[0.5, 0.5, 0.5], [0.5, 1.5, 0.5], [0.2, 1.0, 0.5]])
VOLUMES = np.array([1.0, 0.5, 0.5])


def field(scene, temperature, flux, *, conductivity=3.0, **rest):
    """A Field with given temperature and flux functions and samples at POINTS."""

    def sampler():
        return Samples(POINTS, VOLUMES, temperature(POINTS), np.zeros(3, dtype=int), flux(POINTS))

    rest.setdefault("wall_temperature", scene.wall_temperatures)
    mean = np.array([0.0, -10.0 * conductivity, 0.0])
    # Their conductivities are no body's.
    return Field(scene, mean, np.ones(1), sampler, temperature, flux, slack=(1.0, np.inf), **rest)


def exact_temperature(points):
    return 10.0 + 10.0 * points[:, 1]


def exact_flux(points):
    return np.tile([0.0, -30.0, 0.0], (len(points), 1))


def with_errors(scene, temperature_errors, flux_errors=(0.0, 0.0, 0.0)):
    """A Field that is off by the given amounts at POINTS, in the flux along x."""

    def at(points, errors):
        return np.array([errors[np.argmin(np.abs(POINTS - p).sum(axis=1))] for p in points])

    return field(
        scene,
        lambda points: exact_temperature(points) + at(points, temperature_errors),
        lambda points: exact_flux(points) + at(points, flux_errors)[:, None] * [1.0, 0.0, 0.0],
    )
