"""Rows of the study of fields among many spheres: the arrangement, its exact witnesses, and every method on it."""

import numpy as np

from demheat.terminal.slices import filled, plane
from studies.common import silica_epoxy
from studies.common.field_errors import mean_diameter
from studies.common.pictures import packed
from studies.common.silica_epoxy import LOW, POINTS, SPAN
from studies.harness.cells import cell
from studies.harness.cost import measured

GRID = 51
# Pixels of what is drawn, and steps to which it is kept: of the temperature in % of the span, of the flux in % of the
# mean flux.
FINE, STEPS = 200, {"temperature": 0.002, "flux": 0.05}
# Packing whose mean diameter is the width of the band along interfaces.
BAND = 100_000
# Arrangement: the first whose four points are no nearer to an interface than that band, in which flux is hard to find.
SEED = 20


def spheres_in(boundary):
    """The 83 spheres, between walls or, the same, in a periodic cell."""
    return silica_epoxy.scene("walled", 0.2, seed=SEED, boundary=boundary)


def arrangement_row():
    """Where the points lie, and how far the plane's points are from the nearest surface."""
    scene = spheres_in("walls")
    row = {"number": len(scene.inclusions), "radius": scene.inclusions[0].radius / scene.size[0]}
    row["band"] = mean_diameter(BAND, scene) / scene.size[0]
    places = np.array(list(POINTS.values())) * scene.size
    for letter, gap in zip(POINTS, distance(scene, places) / scene.size[0], strict=True):
        row |= {f"gap_{letter}": abs(gap), f"phase_{letter}": "sphere" if gap < 0 else "matrix"}
    points, _ = plane(scene, axis=0, at=scene.size[0] / 2, n=GRID)
    # Insulated faces count: the plane meets those across z.
    face = np.minimum(points[:, 2], scene.size[2] - points[:, 2])
    row["slice_face"] = cell(face / scene.size[0], decimals=4)
    row |= {"circles": cell(circles(scene), decimals=5)}
    return row | {"slice_gap": cell(distance(scene, points) / scene.size[0], decimals=4)}


def distance(scene, points):
    """Distance to the nearest interface, negative inside a sphere, (n, 3) float array, m -> (n,) float array, m."""
    centers = np.array([sphere.center for sphere in scene.inclusions])
    radii = np.array([sphere.radius for sphere in scene.inclusions])
    # Spheres are disjoint: the least signed distance is that of the sphere around the point, if there is one.
    return np.min(np.linalg.norm(points[:, None] - centers, axis=2) - radii, axis=1)


def field_row(boundary, *, method, fine=False, **knobs):
    """Solve, and keep temperature and flux at the points and over the plane.

    In a periodic cell the level of temperature is free: there the plane's mean is set to 30 C for all methods.
    """
    field, row = silica_epoxy.solved(spheres_in(boundary), method=method, **knobs)
    return row | looked(field, boundary, fine=fine)


def looked(field, boundary, flux_at=None, *, fine=False):
    """Temperature and flux of a field at the points and over the plane, and what it cost to look."""
    scene, flux_at = field.scene, flux_at or field.flux_at
    places = np.array(list(POINTS.values())) * scene.size
    points, mask = plane(scene, axis=0, at=scene.size[0] / 2, n=GRID)
    both = np.vstack([places, points])
    (temperature, flux), cost = measured(lambda: (field.temperature_at(both), flux_at(both)))
    level = LOW + SPAN / 2 - temperature[len(POINTS) :].mean() if boundary == "gradient" else 0.0
    temperature = temperature + level
    mean = float(np.linalg.norm(field.mean_flux))
    row = {"mean_flux": mean, "sample_cpu_s": cost["cpu_s"]}
    for letter, t, q in zip(POINTS, temperature, flux, strict=False):
        row |= {f"T_{letter}": t, f"q_{letter}": float(np.linalg.norm(q))}
        row |= {f"q{axis}_{letter}": part for axis, part in zip("xyz", q, strict=True)}
    warm, flux = filled(mask, temperature[len(POINTS) :]), filled(mask, flux[len(POINTS) :])
    # Two digits behind the point: 0.02 % of the mean flux of 29 W/m2; three: 0.0005 % of the span.
    row |= {f"slice_{axis}": cell(flux[..., k], decimals=2) for k, axis in enumerate("xyz")}
    row |= {"slice_temperature": cell(100 * (warm - LOW) / SPAN, decimals=3)}
    if not fine:
        return row
    points, mask = plane(scene, axis=0, at=scene.size[0] / 2, n=FINE)
    warm, flux = filled(mask, field.temperature_at(points) + level), filled(mask, flux_at(points))
    row["fine_temperature"] = packed(100 * (warm - LOW) / SPAN, STEPS["temperature"])
    step = STEPS["flux"] * mean / 100
    return row | {f"fine_{axis}": packed(flux[..., k], step) for k, axis in enumerate("xyz")}


def circles(scene):
    """Where the plane x = L/2 cuts the spheres: middles y and z and radii, in edges of the cube, (n, 3) float array."""
    found = []
    for sphere in scene.inclusions:
        square = sphere.radius**2 - (sphere.center[0] - scene.size[0] / 2) ** 2
        if square > 0:
            found.append((sphere.center[1], sphere.center[2], square**0.5))
    return np.array(found) / scene.size[0]
