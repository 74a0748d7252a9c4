"""The closed form of parallel fibres in a square or hexagonal array, for `exact.solve`.

Across them it is that of `fibres` and `fibres_field`; along them the gradient is the mean one everywhere.
"""

import math
from functools import lru_cache

import numpy as np

from demheat.scene import Cylinder
from demheat.scene.perfect import INFINITE
from references.exact import fibres, fibres_field
from references.exact.forms import SAME, Closed, mean_load

# Angles at which the field's conditions at a surface are looked at, and how far beside it.
ANGLES, BESIDE = 23, 1e-12


def fibre_array(scene):
    """Parallel fibres: one in a cell of square section, two in one of 1 by sqrt(3), or one in the middle of a box."""
    found = _array(scene)
    load = None if found is None else mean_load(scene, np.full(3, np.nan))
    if load is None:
        return None
    kind, axes, spacing = found
    gradient, level = load
    first, k = scene.inclusions[0], scene.matrix.conductivity
    center, ki, across = np.array(first.center), first.material.conductivity, list(axes[:2])
    fraction = len(scene.inclusions) * math.pi * first.radius**2 / (scene.size[across[0]] * scene.size[across[1]])
    array, digits = _solved(kind, ki / k, fraction, first.resistance * k / first.radius)
    along = np.where(np.arange(3) == axes[2], gradient, 0.0)
    if scene.matrix.perfect or (math.isinf(ki) and along.any()):
        raise ValueError(INFINITE)
    # Nothing is driven along perfect conductors.
    beside = 0.0 if math.isinf(ki) else ki

    def places(points):
        return (points[:, across] - center[across]) / spacing

    def temperature(points):
        here = fibres_field.temperature(array, places(points), gradient[across] * spacing)
        return level + center[across] @ gradient[across] + points @ along + here

    def flux(points):
        result = 0.0 - np.where(scene.phase_at(points) > 0, beside, k)[:, None] * along
        result[:, across] = k * fibres_field.flux(array, places(points), gradient[across])
        return result

    mean = -k * array.conductivity * gradient
    mean[axes[2]] = 0.0 - ((1 - fraction) * k + fraction * beside) * gradient[axes[2]]
    stats = {
        "unknowns": len(array.source),
        "order": array.order,
        "digits": array.digits if gradient[across].any() else fibres.ENOUGH,
        "field_digits": digits,
    }
    return Closed(f"{kind} array of fibres", temperature, flux, mean, 0, np.array([0.0, scene.size[0]]), stats)


def _array(scene):
    """Kind, axes (towards the next fibre, across that, along them) and distance of neighbours, m; or None."""
    cylinders = scene.inclusions
    # In a matrix of no conductivity nothing says how warm a fibre is.
    if not 0 < len(cylinders) < 3 or not scene.only(Cylinder) or scene.matrix.conductivity == 0:
        return None
    first, size = cylinders[0], np.array(scene.size)
    along = int(np.argmax(np.abs(first.axis)))
    if not all(_alike(first, each, along, SAME * max(size)) for each in cylinders):
        return None
    places = np.array([each.center for each in cylinders]) / size
    u, v = sorted({0, 1, 2} - {along}, key=lambda axis: size[axis])
    ratio, few = size[v] / size[u], SAME * max(size) / size[u]
    if len(cylinders) == 1:
        centred = scene.periodic or np.all(np.abs(places[0, [u, v]] - 0.5) <= SAME)
        return ("square", (u, v, along), size[u]) if centred and abs(ratio - 1) <= few else None
    apart = (places[1] - places[0])[[u, v]] % 1
    fits = scene.periodic and abs(ratio - math.sqrt(3)) <= few and np.all(np.abs(apart - 0.5) <= SAME)
    return ("hexagonal", (u, v, along), size[u]) if fits else None


def _alike(first, other, along, slack):
    """Whether a cylinder is one without end along an axis, as the first one."""
    straight = other.length is None and abs(other.axis[along]) == 1
    same = other.material.conductivity == first.material.conductivity and other.resistance == first.resistance
    return straight and same and abs(other.radius - first.radius) <= slack


@lru_cache(maxsize=32)
def _solved(kind, contrast, fraction, resistance):
    """The array, and digits of its field."""
    try:
        array = fibres.solve(kind, contrast, fraction, resistance=resistance)
    except ValueError as error:
        raise NotImplementedError(f"no closed form to six digits: {error}") from error
    return array, _field_digits(array)


def _field_digits(array):
    """Digits of temperature and flux, by what they lack in the conditions at the surface, under a unit gradient."""
    turn = 2 * math.pi * np.arange(ANGLES) / ANGLES
    normals, gradient = np.column_stack([np.cos(turn), np.sin(turn)]), (0.6, 0.8)
    inside, outside = (array.radius * (1 + e) * normals for e in (-BESIDE, BESIDE))
    through = [np.sum(fibres_field.flux(array, at, gradient) * normals, axis=1) for at in (inside, outside)]
    warmth = [fibres_field.temperature(array, at, gradient) for at in (inside, outside)]
    left = np.abs(through[0] - through[1]).max()
    # A pore has its own temperature.
    if array.contrast > 0:
        left = max(left, np.abs(warmth[0] - warmth[1] - array.resistance * array.radius * through[1]).max())
    # Beside the surface the field itself differs by this much.
    return float(-math.log10(max(left, BESIDE)))
