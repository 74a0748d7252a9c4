"""The closed forms that `exact.solve` chooses from: laminate, spheres in an insulator or a cubic array, coated spheres.

A form takes a scene and gives a `Closed`, or None if the scene is not of its kind.
"""

import math
from collections.abc import Callable, Mapping
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from demheat.scene import Flux, Layer, Sphere
from demheat.scene.perfect import INFINITE, touching_spheres
from demheat.scene.resistances import between
from references.exact import lattice, lattice_field
from references.exact.insulated import sphere_temperature

# Rounding of coordinates and conductivities that users type or work out.
SAME = 1e-12


class Closed(NamedTuple):
    """A solution in closed form."""

    form: str
    temperature: Callable  # callable (n, 3) float array, m -> (n,) float array, K
    flux: Callable  # callable (n, 3) float array, m -> (n, 3) float array, W/m2
    mean_flux: np.ndarray  # (3,) float array, W/m2
    normal: int  # Axis along which the temperature of a wall can vary piecewise linearly
    # (m,) float array, m: Ends of its linear pieces; elsewhere the mean over a wall is the value at its centre
    breaks: np.ndarray
    stats: Mapping[str, object]  # mapping


def laminate(scene):
    """Homogeneous box or plane layers: harmonic mean across, interfaces that resist in series; arithmetic mean along.

    Where layers of zero conductivity stop the heat, the temperature between them is constant across, see `Field`.
    """
    k = scene.conductivities
    layered = scene.only(Layer)
    if not layered and not (np.all(k == k[0]) and not scene.resistances.any()):
        return None
    normal = scene.inclusions[0].axis if layered and scene.inclusions else 0
    length = scene.size[normal]
    breaks, phase, resist = (
        pieces(scene, normal) if layered else (np.array([0.0, length]), np.zeros(1, int), np.zeros(2))
    )
    k, thickness = k[phase], np.diff(breaks)
    along, series = (
        float(thickness @ k / length),
        float(np.sum(thickness / k) + resist[1:].sum()) if k.all() else np.inf,
    )
    if series == 0:
        raise ValueError(INFINITE)
    across = length / series
    slope = across / k if across else np.zeros(len(k))
    # Plain homogeneous material also takes an imposed flux along its layers, for it has none.
    means = np.full(3, along if np.all(k == k[0]) else np.nan)
    means[normal] = across
    load = mean_load(scene, means)
    if load is None:
        return None
    gradient, level = load
    rise = np.concatenate([[0.0], np.cumsum(slope * thickness)])
    jumps = across * np.cumsum(resist)[:-1]
    sideways = np.where(np.arange(3) == normal, 0.0, gradient)
    if math.isinf(along) and sideways.any():
        raise ValueError(INFINITE)
    # Nothing is driven along perfect conductors.
    beside = np.where(np.isinf(k), 0.0, k)

    flat = None if across else _flat(scene, normal, breaks, k > 0, load)

    def where(points):
        turns = np.floor(points[:, normal] / length) if scene.periodic else 0.0
        return turns, points[:, normal] - turns * length

    def temperature(points):
        turns, x = where(points)
        if flat is not None:
            # Points on an interface belong to either side.
            before, after = (np.clip(np.searchsorted(breaks, x, side) - 1, 0, len(k) - 1) for side in ("left", "right"))
            here = np.where(np.isnan(flat[after]), flat[before], flat[after])
            return points @ sideways + gradient[normal] * turns * length + here
        total = turns * length + np.interp(x, breaks, rise)
        if resist.any():
            total += jumps[np.clip(np.searchsorted(breaks, x, side="right") - 1, 0, len(k) - 1)]
        return level + points @ sideways + gradient[normal] * total

    def flux(points):
        _, x = where(points)
        piece = np.clip(np.searchsorted(breaks, x, side="right") - 1, 0, len(k) - 1)
        result = 0.0 - beside[piece][:, None] * sideways
        result[:, normal] = 0.0 - across * gradient[normal]
        return result

    mean = 0.0 - (0.0 if math.isinf(along) else along) * sideways
    mean[normal] = 0.0 - across * gradient[normal]
    plain = len(set(k.tolist())) == 1 and not resist.any()
    form = "homogeneous" if plain else "laminate"
    return Closed(form, temperature, flux, mean, normal, breaks, {"unknowns": len(k), "digits": 15.0})


def insulated(scene):
    """Spheres apart in a matrix of no conductivity: no heat passes."""
    temperature = sphere_temperature(scene) if scene.inclusions else None
    load = None if temperature is None else mean_load(scene, np.zeros(3))
    if load is None:
        return None
    stats = {"unknowns": len(scene.inclusions), "digits": 15.0}
    breaks = np.array([0.0, scene.size[0]])
    return Closed("insulated", temperature, lambda points: np.zeros(points.shape), np.zeros(3), 0, breaks, stats)


def cubic_array(scene):
    """Cubic array of equal spheres, or a sphere in the middle of a cube between two isothermal walls."""
    found = _array(scene)
    if found is None:
        return None
    kind, edge, spheres = found
    load = mean_load(scene, np.full(3, np.nan))
    if load is None:
        return None
    gradient, level = load
    touching_spheres(scene)
    first, k = spheres[0], scene.matrix.conductivity
    center, ki = np.array(first.center), first.material.conductivity
    if scene.matrix.perfect:
        raise ValueError(INFINITE)
    resistance = first.resistance * k / first.radius
    contrast = ki / k if k > 0 else math.inf
    fraction = len(spheres) * 4 / 3 * math.pi * (first.radius / edge) ** 3
    array = _solved(kind, contrast, fraction, resistance)

    def temperature(points):
        here = lattice_field.temperature(array, (points - center) / edge, gradient * edge)
        return level + center @ gradient + here

    def flux(points):
        return k * lattice_field.flux(array, (points - center) / edge, gradient)

    stats = {
        "unknowns": int(np.count_nonzero(array.source)),
        "order": array.order,
        "digits": array.digits,
        "field_digits": array.field_digits,
        "residual": array.residual,
    }
    mean = -k * array.conductivity * gradient
    return Closed(f"{kind} array", temperature, flux, mean, 0, np.array([0.0, scene.size[0]]), stats)


def coated_spheres(scene):
    """Spheres with one coat each in the matrix that does not notice them (Hashin, J. Appl. Mech. 29 (1962) 143)."""
    k, pairs = scene.matrix.conductivity, _coated(scene)
    if not pairs:
        return None
    load = mean_load(scene, np.full(3, k))
    if load is None:
        return None
    gradient, level = load
    box = np.array(scene.size)

    def offsets(points, center):
        apart = points - center
        return apart - box * np.round(apart / box) if scene.periodic else apart

    def temperature(points):
        total = level + points @ gradient
        for outer, inner in pairs:
            apart = offsets(points, outer.center)
            r = np.linalg.norm(apart, axis=1)
            dipole, uniform, core = _coat(outer, inner)
            shell = uniform + dipole * (outer.radius / np.maximum(r, inner.radius)) ** 3
            factor = np.where(r <= inner.radius, core, np.where(r <= outer.radius, shell, 1.0))
            total += (factor - 1) * (apart @ gradient)
        return total

    def flux(points):
        result = np.tile(-k * gradient, (len(points), 1))
        for outer, inner in pairs:
            apart = offsets(points, outer.center)
            r = np.linalg.norm(apart, axis=1)
            dipole, uniform, core = _coat(outer, inner)
            shell, kernel = (r <= outer.radius) & (r > inner.radius), r <= inner.radius
            unit = apart[shell] / r[shell, None]
            bent = (outer.radius / r[shell, None]) ** 3 * (gradient - 3 * unit * (unit @ gradient)[:, None])
            result[shell] = -outer.material.conductivity * (uniform * gradient + dipole * bent)
            # As what enters at its surface: a good conductor's own slope is rounding, a perfect one has none.
            through = outer.material.conductivity * (uniform - 2 * dipole * (outer.radius / inner.radius) ** 3)
            good = inner.material.conductivity > outer.material.conductivity
            result[kernel] = -(through if good else inner.material.conductivity * core) * gradient
        return result

    stats = {"unknowns": 3 * len(pairs), "digits": 12.0}
    breaks = np.array([0.0, scene.size[0]])
    return Closed("neutral coated spheres", temperature, flux, -k * gradient, 0, breaks, stats)


def mean_load(scene, conductivities):
    """Mean gradient, (3,) float array in K/m, and temperature at the origin, that the load makes; None if no such."""
    if scene.periodic:
        return np.array(scene.gradient), 0.0
    # A wall without flux is an insulated one.
    active = {name for name, value in scene.walls.items() if not (isinstance(value, Flux) and value.value == 0)}
    axes = {"xyz".index(name[0]) for name in active}
    if len(axes) != 1:
        return None
    axis, gradient = axes.pop(), np.zeros(3)
    low, high = (scene.walls.get("xyz"[axis] + side, Flux(0.0)) for side in "-+")
    if not isinstance(low, Flux) and not isinstance(high, Flux):
        gradient[axis] = (high - low) / scene.size[axis]
        return gradient, float(low)
    # Fluxes are positive into the body: at the low wall along the axis, at the high one against it.
    flow = low.value if isinstance(low, Flux) else -high.value
    if flow != 0:
        if np.isnan(conductivities[axis]):
            return None
        if conductivities[axis] == 0:
            raise ValueError(f"Scene.walls = {dict(scene.walls)}: heat cannot pass a body of no conductivity")
        gradient[axis] = -flow / conductivities[axis]
    level = high - gradient[axis] * scene.size[axis] if isinstance(low, Flux) else low
    return gradient, float(level)


def _flat(scene, normal, breaks, conducts, load):
    """Temperature of pieces that no heat crosses, less what varies along them, (pieces,) float array; NaN in pores."""
    gradient, level = load
    letter, length, count = "xyz"[normal], breaks[-1], len(conducts)
    flat = np.full(count, np.nan)
    # Runs of pieces between pores; in a periodic cell the last goes on in the first.
    ends = np.flatnonzero(np.diff(np.concatenate([[0], conducts.astype(int), [0]])))
    runs = [list(pair) for pair in ends.reshape(-1, 2)]
    if not scene.periodic:
        along = not any(name[0] == letter for name in scene.walls)
        held = scene.wall_temperatures
        for start, stop in runs:
            low = held.get(letter + "-", np.nan) if start == 0 else np.nan
            high = held.get(letter + "+", np.nan) if stop == count else np.nan
            flat[start:stop] = level if along else (high if np.isnan(low) else low)
        return flat
    joined = len(runs) > 1 and conducts[0] and conducts[-1]
    for number, (start, stop) in enumerate(runs):
        low, high = breaks[start], breaks[stop]
        if joined and number == 0:
            low = breaks[runs[-1][0]] - length
        if joined and number == len(runs) - 1:
            high = breaks[runs[0][1]] + length
        flat[start:stop] = gradient[normal] * (low + high) / 2
    return flat


def pieces(scene, normal):
    """Ends of the layers along their normal, the phase between them, and the resistance at each end.

    That at the face of a periodic cell is at its upper end.
    """
    ends = {0.0, scene.size[normal]}
    for layer in scene.inclusions:
        ends |= {min(max(x, 0.0), scene.size[normal]) for x in (layer.start, layer.stop)}
    breaks = np.array(sorted(ends))
    points = np.zeros((len(breaks) - 1, 3))
    points[:, normal] = [(a + b) / 2 for a, b in pairwise(breaks)]
    phase, resistance = scene.phase_at(points), between(scene)
    resist = np.zeros(len(breaks))
    if resistance is not None:
        met = resistance(phase, np.roll(phase, -1))
        resist[1:] = met if scene.periodic else np.append(met[:-1], 0.0)
    return breaks, phase, resist


@lru_cache(maxsize=32)
def _solved(kind, contrast, fraction, resistance):
    try:
        return lattice.solve(kind, contrast, fraction, resistance=resistance)
    except ValueError as error:
        raise NotImplementedError(f"no closed form to six digits: {error}") from error


def _array(scene):
    """Kind, edge in metres and spheres of a cubic array, or None."""
    spheres, edge = scene.inclusions, scene.size[0]
    if len(spheres) not in (1, 2, 4) or not scene.only(Sphere):
        return None
    first = spheres[0]
    equal = all(
        abs(s.radius - first.radius) <= SAME * edge
        and s.material.conductivity == first.material.conductivity
        and s.resistance == first.resistance
        for s in spheres
    )
    if not equal or np.any(np.abs(np.array(scene.size) - edge) > SAME * edge):
        return None
    kind = {1: "sc", 2: "bcc", 4: "fcc"}[len(spheres)]
    places = np.array([sphere.center for sphere in spheres]) / edge
    if not scene.periodic:
        centred = np.all(np.abs(places - 0.5) <= SAME)
        return (kind, edge, spheres) if kind == "sc" and centred else None
    offsets = lattice_field.nearest_site(kind, places - places[0]) - (places - places[0])
    # Spheres at as many different sites, for the scene refuses two at the same place, are the array.
    return None if np.any(np.abs(offsets) > SAME) else (kind, edge, spheres)


def _coated(scene):
    """Pairs (outer, inner) if all inclusions are neutral coated spheres, else None; `fractions` refuses cut ones."""
    if not scene.inclusions or not scene.only(Sphere) or scene.resistances.any():
        return None
    parents = scene.parents()[1:]
    inner = np.flatnonzero(parents)
    outer = parents[inner] - 1
    # Every second sphere lies in one of its own, which lies in none.
    if 2 * len(inner) != len(parents) or len(np.union1d(inner, outer)) != len(parents):
        return None
    centers = np.array([sphere.center for sphere in scene.inclusions])
    apart = centers[inner] - centers[outer]
    if scene.periodic:
        apart -= np.array(scene.size) * np.round(apart / scene.size)
    if np.any(np.linalg.norm(apart, axis=1) > SAME * max(scene.size)):
        return None
    pairs = [(scene.inclusions[i], scene.inclusions[j]) for i, j in zip(outer, inner, strict=True)]
    return pairs if all(_neutral(scene, *pair) for pair in pairs) else None


def _neutral(scene, outer, inner):
    """Whether the matrix does not notice a coated sphere."""
    above, below = _ratio(outer, inner)
    excess = abs(scene.matrix.conductivity * below - outer.material.conductivity * above)
    # Rounding of the two products, not of their difference, is what a matrix worked out by a user carries.
    return excess <= SAME * outer.material.conductivity * above


def _ratio(outer, inner):
    """Neutral conductivity over that of the coat, as numerator and denominator: (1 + 2 beta f) / (1 - beta f)."""
    k1, k2 = outer.material.conductivity, inner.material.conductivity
    f = (inner.radius / outer.radius) ** 3
    if inner.material.perfect:
        return 1 + 2 * f, 1 - f
    return k2 + 2 * k1 + 2 * (k2 - k1) * f, k2 + 2 * k1 - (k2 - k1) * f


def _coat(outer, inner):
    """Dipole and uniform part in the coat and slope in the core, for a unit gradient outside.

    At the outer radius b: uniform + dipole = 1 and k1 (uniform - 2 dipole) = k.
    """
    above, below = _ratio(outer, inner)
    ratio = above / below
    dipole, uniform = (1 - ratio) / 3, (2 + ratio) / 3
    return dipole, uniform, uniform + dipole * (outer.radius / inner.radius) ** 3
