"""One solve of a scene whose surfaces resist, as a row."""

from dataclasses import replace

import numpy as np

from demheat import Sphere, gallery, referee
from references import exact
from studies.common import silica_epoxy
from studies.harness import methods
from studies.resistance.cases import CONTRAST, FRACTION

# Seed of the points at which the matrix's temperature is looked at, and their number.
SEED, POINTS = 7, 4000


def resisting(scene, length):
    """The spheres of a scene with surfaces of one Kapitza length over the radius."""
    k = scene.matrix.conductivity
    spheres = [replace(each, resistance=length * each.radius / k) for each in scene.inclusions]
    assert all(isinstance(each, Sphere) for each in spheres)
    return replace(scene, inclusions=spheres)


def array(kapitza, *, method, **knobs):
    """A sphere in a cube beside the exact value."""
    scene = resisting(gallery.sphere_in_cube(CONTRAST, fraction=FRACTION), kapitza)
    return methods.solve_row(scene, exact.solve(scene).conductivity / methods.MATRIX, method=method, **knobs)


def neutral(spheres, *, method, **knobs):
    """Spheres that nothing outside of them notices."""
    made = gallery.random_dispersion(spheres, fraction=FRACTION)
    contrast = made.inclusions[0].material.conductivity / made.matrix.conductivity
    scene = resisting(made, (contrast - 1) / contrast)
    field, row = silica_epoxy.solved(scene, method=method, **knobs)
    row["error_percent"] = 100 * referee.conductivity_error(field, scene.matrix.conductivity)
    points = np.random.default_rng(SEED).random((POINTS, 3)) * scene.size
    points = points[scene.phase_at(points) == 0]
    warmth, linear = field.temperature_at(points), points @ np.array(scene.gradient)
    span = float(np.abs(scene.gradient) @ scene.size)
    # Only differences of temperatures mean anything in a periodic cell.
    errors = referee.value_error(warmth - warmth.mean(), linear - linear.mean(), scale=span)
    return row | {"temperature_percent": 100 * referee.rms(errors)}


def silica(fraction, kapitza, realisation, *, method, **knobs):
    """The papers' spheres, in a periodic cell."""
    scene = resisting(silica_epoxy.scene("periodic", fraction, seed=realisation), kapitza)
    return silica_epoxy.solved(scene, method=method, **knobs)[1]
