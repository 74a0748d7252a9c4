"""One solve of a shape, as a row."""

import numpy as np

from demheat import referee
from demheat.tensor import conductivity_tensor
from references import exact
from references.exact import ellipsoids, squares
from studies.harness import methods
from studies.harness.cost import measured
from studies.shapes import scenes
from studies.shapes.cases import BALLS, CONTRAST, FEW, FRACTION

# Seed of the points at which temperatures are compared, and their number.
SEED, POINTS = 7, 2000


def fibres(contrast, fraction=FRACTION, *, kapitza=0.0, method, **knobs):
    """A fibre in its cell beside Rayleigh's value; at one contrast and fraction its temperature, too."""
    scene = scenes.fibre(contrast, fraction, kapitza=kapitza)
    right = exact.solve(scene)
    field, row = methods.solved(scene, right.conductivity / methods.MATRIX, method=method, **knobs)
    if (contrast, fraction) == (CONTRAST, FRACTION):
        points = np.random.default_rng(SEED).random((POINTS, 3)) * scene.size
        row["temperature_percent"] = referee.temperature_error(field, right, points, unit="%").rms
    return row


def neutral_fibre(contrast, **knobs):
    """A fibre whose surface resists just as much that its dipole is none; see `fibres`."""
    return fibres(contrast, kapitza=(contrast - 1) / contrast, **knobs)


def square_rods(contrast, **knobs):
    """Square rods beside Obnosov's value."""
    return methods.solve_row(scenes.square_rod(contrast), squares.square_rods(contrast), **knobs)


def diagonal(contrast, **knobs):
    """A square cut along its diagonal beside the root of the contrast: it is its own dual."""
    return methods.solve_row(scenes.diagonal(contrast), squares.checkerboard(contrast), **knobs)


def sphere(contrast, **knobs):
    """A sphere beside Rayleigh's value."""
    return _ball("sphere", contrast, knobs)


def level_set(contrast, **knobs):
    """The same sphere, as what a function tells."""
    return _ball("level set", contrast, knobs)


def _ball(shape, contrast, knobs):
    right = exact.solve(scenes.ball("sphere", contrast, BALLS)).conductivity
    return methods.solve_row(scenes.ball(shape, contrast, BALLS), right / methods.MATRIX, **knobs)


def ellipsoid(contrast, *, method, **knobs):
    """The tensor of few turned ellipsoids beside theory of second order in their fraction."""
    scene = scenes.ellipsoid(contrast, FEW)
    fields, cost = measured(methods.load(method).solve_axes, scene, **knobs)
    found = conductivity_tensor(fields) / methods.MATRIX
    shape = scene.inclusions[0]
    seen = {"frame": np.transpose(shape.rotation)}
    first, second = (
        theory(contrast, shape.semi_axes, FEW, **seen) for theory in (ellipsoids.dilute, ellipsoids.maxwell)
    )
    added = float(np.linalg.norm(second - np.eye(3)))
    off, behind = (referee.value_error(each, second, scale=added) for each in (found, first))
    return {
        "error_percent": 100 * added * float(np.linalg.norm(off, 2) / np.linalg.norm(second, 2)),
        "added_percent": 100 * float(np.linalg.norm(off)),
        "theory_percent": 100 * float(np.linalg.norm(behind)),
        "asymmetry_percent": 100 * float(np.linalg.norm(off - off.T)),
        "inclusion": float(fields[0].fractions[1]),
        **cost,
    }


def capped_rod(contrast, *, method, **knobs):
    """A short rod, of which no exact value is known, with the interval that the method gives itself."""
    field, cost = measured(methods.load(method).solve, scenes.rod(contrast), **knobs)
    error = field.error
    ratios = {"k_ratio": field.conductivity, "lower_ratio": error.lower, "upper_ratio": error.upper}
    found = {name: value / methods.MATRIX for name, value in ratios.items()}
    return found | {"inclusion": float(field.fractions[1]), **cost}
