"""What the studies of fields look at: points, a plane, the method's own points; errors by the referee, in %."""

import math

import numpy as np

from demheat import referee
from demheat.terminal.slices import filled, plane
from studies.harness.cells import cell
from studies.harness.cost import measured

# Radii of the packings: Gaussian, whose cut leaves a standard deviation of 0.29 of the mean; packing fraction.
SPREAD, PACKED = 0.29, 0.64
# At so many of a method's own points its temperature is judged.
OWN_POINTS = 20_000
# Haddad et al. 2021, section 4.1: fluxes are within so many % of its FEM.
WITHIN = 19.6


def mean_diameter(particles, scene):
    """Mean diameter of so many particles that fill the scene as packings do, m."""
    cubes = scene.volume * PACKED / (particles * math.pi / 6)  # mean cube of the diameters
    return (cubes / (1 + 3 * SPREAD**2)) ** (1 / 3)


def clearance(scene, points):
    """Distance to the nearest surface of a sphere or insulated face."""
    gaps = [np.abs(np.linalg.norm(points - sphere.center, axis=1) - sphere.radius) for sphere in scene.inclusions]
    for axis, letter in enumerate("xyz"):
        for side, face in (("-", 0.0), ("+", scene.size[axis])):
            if letter + side not in scene.walls:
                gaps.append(np.abs(points[:, axis] - face))
    return np.min(gaps, axis=0)


def at_points(field, flux_at, reference, places):
    """Temperature, and flux down the load, at named points; their errors, K and % of the exact flux there."""
    points, axis = np.array(list(places.values())) * field.scene.size, field.scene.axis
    warm = field.temperature_at(points)
    off = referee.temperature_error(field, reference, points, values=warm, unit="K").values
    flux, exact = (-at(points)[:, axis] for at in (flux_at, reference.flux_at))
    flux_off = 100 * referee.value_error(flux, exact)
    row = {}
    for letter, *found in zip(places, warm, off, flux, flux_off, strict=True):
        names = (f"T_{letter}", f"T_{letter}_error", f"q_{letter}", f"q_{letter}_error")
        row |= dict(zip(names, found, strict=True))
    return row


def over_plane(field, flux_at, reference, where, n, widths):
    """Errors over a plane, rms and largest, and what it cost to look at it."""
    points, _ = plane(field.scene, **where, n=n)
    (temperature, flux), cost = measured(lambda: (field.temperature_at(points), flux_at(points)))
    warm = referee.temperature_error(field, reference, points, values=temperature, unit="%")
    misses = referee.flux_error(field, reference, points, values=flux, unit="%")
    clear = clearance(field.scene, points)
    regions = {ending: clear > width for ending, width in widths.items()}
    regions["_band"] = ~regions[""]
    row = {"temperature_rms": warm.rms, "temperature_max": warm.max}
    for ending, here in regions.items():
        part = misses.part(here)
        row |= {f"flux_rms{ending}": part.rms, f"flux_max{ending}": part.max}
    row |= in_papers_measure(temperature, flux, reference, points)
    return row | {f"sample_{name}": cost[name] for name in ("wall_s", "cpu_s", "peak_mib")}


def in_papers_measure(temperature, flux, reference, points):
    """Errors over the exact value at the point itself, %, as Haddad et al. 2021 state theirs against their FEM."""
    warm = referee.value_error(temperature, reference.temperature_at(points))
    sizes = (np.linalg.norm(vectors, axis=1) for vectors in (flux, reference.flux_at(points)))
    off = 100 * np.abs(referee.value_error(*sizes))
    found = {"relative_temperature": 100 * np.abs(warm).max(), "relative_flux": off.max()}
    return found | {"relative_within": 100 * np.mean(off <= WITHIN)}


def at_own_points(field, reference):
    """Error of the temperature at the method's own points, %, rms weighted by volume; every k-th of many points."""
    number = len(field.samples.points)
    some = np.arange(number) % -(-number // OWN_POINTS) == 0
    return {"own_temperature_rms": referee.temperature_error(field, reference, mask=some, unit="%").rms}


def field_pictures(field, where, n):
    """A field on a plane in two cells, `slice_temperature` and `slice_flux`: %."""
    axis, coldest = field.scene.axis, min(field.scene.wall_temperatures.values())
    points, mask = plane(field.scene, **where, n=n)
    warm = 100 * (field.temperature_at(points) - coldest) / referee.span(field.scene)
    flux = -100 * field.flux_at(points)[:, axis] / abs(field.mean_flux[axis])
    return _cells(mask, warm, flux)


def error_pictures(field, flux_at, reference, where, n):
    """Errors on a plane in the same two cells: of the temperature, % of the span; along the mean flux, % of it."""
    points, mask = plane(field.scene, **where, n=n)
    warm = referee.temperature_error(field, reference, points, unit="%")
    flux = referee.flux_error(field, reference, points, values=flux_at(points), unit="%", along=True)
    return _cells(mask, warm.values, flux.values)


def _cells(mask, warm, flux):
    pictures = {"slice_temperature": (warm, 3), "slice_flux": (flux, 2)}
    return {name: cell(filled(mask, values), decimals=digits) for name, (values, digits) in pictures.items()}
