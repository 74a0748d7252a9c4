"""Rows of the study of zeta_2: cubic arrays, random cells, voxels on them, conductivities and surfaces."""

from dataclasses import replace

import numpy as np

from demheat import gallery, referee
from demheat.packing.base import make_packing
from demheat.packing.dispersion import dispersion, dispersion_scene
from demheat.packing.statistics import two_point
from references import multipole, zeta
from references.exact import lattice
from studies.harness.cells import cell
from studies.harness.cost import measured

ARRAYS = {"sc": gallery.simple_cubic, "bcc": gallery.body_centred, "fcc": gallery.face_centred}
# Where an array lies on the grid matters: in the middle, and at two places without symmetry; in edges of the cell.
PLACES = ((0.0, 0.0, 0.0), (0.123, -0.217, 0.311), (-0.409, 0.077, 0.259))
# Highest degree received for zeta_2: found to leave 5e-6 of it at f = 0.5 with touching spheres, less elsewhere.
ORDER = 12
# Of the conductivities: found to leave 1e-4 at f = 0.5 with the gap of 0.02 D.
SOLVED = 10
# S2 in mean diameters, less than half a cell of 6.
REACH, LAGS, LINES = 2.5, 51, 10_000


def array_row(array, fraction, voxels):
    """Voxels on a cubic array at three places; errors are the worst of them, signed, %."""
    scene = ARRAYS[array](fraction=fraction)
    exact = multipole.zeta2(scene)
    places = [_moved(scene, place) for place in PLACES]
    found, cost = measured(lambda: [zeta.zeta2(place, voxels=voxels) for place in places])
    row = {"exact": exact, "lattice": lattice.zeta2(array, fraction), "zeta2": found[0].value}
    row |= {"error_percent": _worst([one.value for one in found], exact)}
    row |= {"raw_percent": _worst([one.stats["values"][-1] for one in found], exact)}
    return row | {"per_diameter": _per_diameter(scene, voxels), **cost}


def _moved(scene, place):
    shift = np.array(place) * scene.size
    moved = [replace(sphere, center=tuple(np.array(sphere.center) + shift)) for sphere in scene.inclusions]
    return replace(scene, inclusions=moved)


def _worst(values, exact):
    return referee.worst(100 * referee.value_error(np.array(values), exact))[1]


def _per_diameter(scene, voxels):
    return 2 * scene.inclusions[0].radius / max(scene.size) * voxels


def random_cell(placed, gap, fraction, ratio, seed, axis=1):
    """Periodic cell of silica spheres in epoxy."""
    materials = {"matrix": gallery.EPOXY, "inclusion": gallery.SILICA, "size": (gallery.EDGE,) * 3}
    knobs = {"fraction": fraction, "ratio": ratio, "gap": gap, "method": placed, "seed": seed}
    return dispersion_scene(axis=axis, **materials, **knobs)


def cells_row(placed, gap, fraction, ratio, first, cells):
    """zeta_2 of some random cells by multipoles; their values are kept as text."""
    scenes = [random_cell(placed, gap, fraction, ratio, seed) for seed in range(first, first + cells)]
    values, cost = measured(lambda: [multipole.zeta2(scene, order=ORDER) for scene in scenes])
    row = {"zeta2": float(np.mean(values)), "values": cell(values, ".7f")}
    return row | {"spheres": len(scenes[0].inclusions), **cost}


def voxels_row(placed, gap, fraction, ratio, first, voxels):
    """Voxels on a random cell against its multipoles."""
    scene = random_cell(placed, gap, fraction, ratio, first)
    exact = multipole.zeta2(scene, order=ORDER)
    found, cost = measured(zeta.zeta2, scene, voxels=voxels)
    row = {"exact": exact, "zeta2": found.value, "error_percent": 100 * referee.value_error(found.value, exact)}
    row |= {"raw_percent": 100 * referee.value_error(found.stats["values"][-1], exact)}
    row |= {"spheres": len(scene.inclusions)}
    return row | {"per_diameter": _per_diameter(scene, voxels), **cost}


def conductivity_row(placed, gap, fraction, ratio, first):
    """Conductivity of a random cell by multipoles, mean of three axes, beside its zeta_2."""
    scenes = [random_cell(placed, gap, fraction, ratio, first, axis) for axis in range(3)]
    fields, cost = measured(lambda: [multipole.solve(scene, order=SOLVED) for scene in scenes])
    found = [field.conductivity for field in fields]
    row = {"zeta2": multipole.zeta2(scenes[0], order=ORDER), "conductivity": float(np.mean(found))}
    row |= {"anisotropy_percent": 100 * (max(found) - min(found)) / row["conductivity"]}
    row |= {name: max(field.stats[name] for field in fields) for name in ("unknowns", "iterations", "residual")}
    return row | {"truncation": max(field.stats["truncation"] for field in fields), **cost}


def surface_row(placed, gap, fraction, ratio, first, cells):
    """S2 of some random cells, mean of directions and cells, and the surface that its slope gives, against 3 f/R."""
    knobs = {"fraction": fraction, "ratio": ratio, "gap": gap, "method": placed}
    made = [dispersion(seed=seed, **knobs) for seed in range(first, first + cells)]
    packings = [make_packing(centers, radii, (1.0, 1.0, 1.0), True, {}) for centers, radii in made]
    found, cost = measured(lambda: [two_point(p, r_max=REACH, points=LAGS, lines=LINES) for p in packings])
    # In mean diameters: s = -4 slope, exactly 3 f/R = 6 f/D.
    surface = -4 * np.array([one.slope for one in found])
    error = 4 * np.array([one.slope_error for one in found])
    exact = 6 * fraction
    row = {"surface": float(surface.mean()), "exact": exact}
    row |= {"error_percent": float(100 * referee.value_error(surface.mean(), exact))}
    row |= {"error_se": float(100 * np.sqrt(np.sum(error**2)) / error.size / exact)}
    s2 = np.mean([one.s2 for one in found], axis=(0, 1))
    return row | {"r": cell(found[0].r, ".5f"), "s2": cell(s2, ".5f"), "spheres": packings[0].number, **cost}
