"""Errors of one field against the exact one, at points, over a plane and at the method's own points; planes as text.

Errors of the flux are the size of the vector's, in % of the exact mean flux; those of temperature in % of the span
between the walls that the load imposes.
"""

from __future__ import annotations

import math

import numpy as np

from demheat.referee import span
from demheat.slices import on_plane, plane
from studies.harness.cost import measured

# Radii of the packings: Gaussian, whose cut leaves a standard deviation of 0.29 of the mean; packing fraction.
SPREAD, PACKED = 0.29, 0.64
# At so many of a method's own points its temperature is judged.
OWN_POINTS = 20_000


def mean_diameter(particles, scene):
    """Mean diameter of so many particles that fill the scene as packings do, m."""
    cubes = scene.volume * PACKED / (particles * math.pi / 6)  # mean cube of the diameters
    return (cubes / (1 + 3 * SPREAD**2)) ** (1 / 3)


def clearance(scene, points):
    """Distance to the nearest surface of a sphere or insulated face, (n, 3) float array, m -> (n,) float array, m."""
    gaps = [np.abs(np.linalg.norm(points - sphere.center, axis=1) - sphere.radius) for sphere in scene.inclusions]
    for axis, letter in enumerate("xyz"):
        for side, face in (("-", 0.0), ("+", scene.size[axis])):
            if letter + side not in scene.walls:
                gaps.append(np.abs(points[:, axis] - face))
    return np.min(gaps, axis=0)


def at_points(field, flux_at, reference, places):
    """Temperature, and flux down the load, at named points; their errors, K and % of the exact flux there.

    Parameters
    ----------
    field, reference : Field
    flux_at : callable (points) -> fluxes
        The flux of `field` that is looked at.
    places : dict of str to (3,) tuple
        In units of the box.
    """
    points, axis = np.array(list(places.values())) * field.scene.size, field.scene.axis
    found, exact = (
        np.column_stack([one.temperature_at(points), -flux(points)[:, axis]])
        for one, flux in ((field, flux_at), (reference, reference.flux_at))
    )
    row = {}
    for letter, (t, q), (exact_t, exact_q) in zip(places, found, exact, strict=True):
        row |= {f"T_{letter}": t, f"T_{letter}_error": t - exact_t}
        row |= {f"q_{letter}": q, f"q_{letter}_error": 100 * (q / exact_q - 1)}
    return row


def over_plane(field, flux_at, reference, where, n, widths):
    """Errors over a plane, rms and largest, and what it cost to look at it.

    Parameters
    ----------
    field, reference, flux_at
        As for `at_points`.
    where : dict
        `axis` and `at` of the plane.
    n : int
        Points along each side.
    widths : dict of str to float, m
        Ending of a column, and width of the band along interfaces and insulated faces that it leaves out; that of ""
        gives the columns of the band too.

    Returns
    -------
    dict
        `temperature_rms`, `temperature_max`, `flux_rms` and `flux_max` with each ending and "_band"; `sample_cpu_s`
        and the like.
    """
    points, _ = plane(field.scene, **where, n=n)
    (temperature, flux), cost = measured(lambda: (field.temperature_at(points), flux_at(points)))
    warm = 100 * (temperature - reference.temperature_at(points)) / span(field.scene)
    misses = np.linalg.norm(flux - reference.flux_at(points), axis=1)
    misses *= 100 / np.linalg.norm(reference.mean_flux)
    clear = clearance(field.scene, points)
    regions = {ending: clear > width for ending, width in widths.items()}
    regions["_band"] = ~regions[""]
    row = {"temperature_rms": np.sqrt(np.mean(warm**2)), "temperature_max": np.abs(warm).max()}
    for ending, here in regions.items():
        row |= {f"flux_rms{ending}": np.sqrt(np.mean(misses[here] ** 2)), f"flux_max{ending}": misses[here].max()}
    return row | {f"sample_{name}": cost[name] for name in ("wall_s", "cpu_s", "peak_mib")}


def at_own_points(field, reference):
    """Error of the temperature at the method's own points, %, rms weighted by volume; every k-th of many points."""
    samples = field.samples
    step = -(-len(samples.points) // OWN_POINTS)
    points, volumes, temperature = (part[::step] for part in samples[:3])
    error = 100 * (temperature - reference.temperature_at(points)) / span(field.scene)
    return {"own_temperature_rms": math.sqrt(np.average(error**2, weights=volumes))}


def pictures(field, flux_at, reference, where, n):
    """The plane in two cells of text, `slice_temperature` and `slice_flux`, %.

    Of the reference itself its temperature over the coldest wall's and its flux down the load, in units of span and
    mean flux; of any other field the errors of both.
    """
    axis = field.scene.axis
    mine, exact = on_plane(field, **where, n=n, flux_at=flux_at), on_plane(reference, **where, n=n)
    warm, flux = mine.temperature - exact.temperature, mine.flux - exact.flux
    if field.stats.get("form"):
        warm, flux = mine.temperature - min(field.scene.wall_temperatures.values()), mine.flux
    scale = -100 / abs(reference.mean_flux[axis])
    return {
        "slice_temperature": cell(100 * warm / span(field.scene), 3),
        "slice_flux": cell(scale * flux[..., axis], 2),
    }


def cell(values, digits):
    """A (rows, columns) float array as one cell of a table, so many digits behind the point."""
    # Adding zero turns the -0.0 that rounding leaves into 0.0.
    return " ".join(f"{round(float(value), digits) + 0.0:g}" for value in values.ravel())


def picture(text):
    """The square float array of such a cell."""
    values = np.array([float(word) for word in text.split()])
    side = math.isqrt(len(values))
    if side**2 != len(values):
        raise ValueError(f"cell of {len(values)} numbers: must hold a square picture")
    return values.reshape(side, side)
