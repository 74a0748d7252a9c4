"""What is computed: a box, its materials and inclusions, and one load.

A scene knows nothing of meshes, voxels or particles; every method reads the same one.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from numbers import Integral, Real

import numpy as np

WALLS = ("x-", "x+", "y-", "y+", "z-", "z+")
# Two surfaces closer than this fraction of the box touch: relative rounding of user-typed coordinates.
TOUCH = 1e-12


@dataclass(frozen=True)
class Material:
    """A homogeneous, isotropic material.

    Parameters
    ----------
    conductivity : float, W/(m K)
        Finite and not negative; 0 is a perfect insulator (a pore).
    density : float, kg/m3, optional
        Needed by transients only.
    heat_capacity : float, J/(kg K), optional
        Specific heat, needed by transients only.
    """

    conductivity: float
    density: float | None = None
    heat_capacity: float | None = None

    def __post_init__(self):
        _number(self, "conductivity", "a finite number >= 0 W/(m K)", lambda v: v >= 0)
        for name in ("density", "heat_capacity"):
            if getattr(self, name) is not None:
                _number(self, name, "a finite number > 0", lambda v: v > 0)


@dataclass(frozen=True)
class Sphere:
    """A spherical inclusion.

    Parameters
    ----------
    center : (3,) sequence of float, m
    radius : float, m
    material : Material
    """

    center: tuple[float, float, float]
    radius: float
    material: Material

    def __post_init__(self):
        object.__setattr__(self, "center", _vector("Sphere.center", self.center))
        _number(self, "radius", "a finite number > 0 m", lambda v: v > 0)
        _check_material("Sphere.material", self.material)

    def contains(self, offsets):
        """Which points, given as (n, 3) offsets from the centre in metres, lie inside (surface included)."""
        return np.einsum("ij,ij->i", offsets, offsets) <= self.radius**2


@dataclass(frozen=True)
class Layer:
    """A plane layer, start <= coordinate <= stop along one axis, across the whole box.

    Parameters
    ----------
    axis : {0, 1, 2}
    start, stop : float, m
    material : Material
    """

    axis: int
    start: float
    stop: float
    material: Material

    def __post_init__(self):
        if not isinstance(self.axis, Integral) or self.axis not in (0, 1, 2):
            raise ValueError(f"Layer.axis = {self.axis!r}: must be 0, 1 or 2")
        object.__setattr__(self, "axis", int(self.axis))
        _number(self, "start", "a finite number of metres")
        _number(self, "stop", f"a finite number > start = {self.start}", lambda v: v > self.start)
        _check_material("Layer.material", self.material)


@dataclass(frozen=True)
class Flux:
    """Heat flux imposed on a wall.

    Parameters
    ----------
    value : float, W/m2
        Positive *into* the body.
    """

    value: float

    def __post_init__(self):
        _number(self, "value", "a finite number of W/m2")


@dataclass(frozen=True)
class Scene:
    """A box of matrix with inclusions painted in order, under one load.

    Give either `gradient` (the box is then a periodic cell) or `walls` (faces not named are insulated).

    Parameters
    ----------
    size : (3,) sequence of float, m
        The box is [0, size[0]] x [0, size[1]] x [0, size[2]].
    matrix : Material
    inclusions : sequence of Sphere or Layer
        Disjoint, touching or fully nested (outer first). In a periodic cell a sphere may cross a face, its image
        comes in on the other side; in a walled box the wall cuts it.
    gradient : (3,) sequence of float, K/m, optional
        Mean temperature gradient of the periodic cell.
    walls : mapping of str to float or Flux, optional
        Keys "x-", "x+", "y-", "y+", "z-", "z+"; a number is a temperature in the user's scale (K or degrees
        Celsius), a `Flux` an imposed heat flux density.

    Raises
    ------
    ValueError
        If an argument is not as described; the message names it, its value and what would be valid.
    """

    size: tuple[float, float, float]
    matrix: Material
    inclusions: tuple[Sphere | Layer, ...] = ()
    gradient: tuple[float, float, float] | None = None
    walls: Mapping[str, float | Flux] | None = None

    def __post_init__(self):
        size = _vector("Scene.size", self.size)
        if min(size) <= 0:
            raise ValueError(f"Scene.size = {self.size!r}: all three lengths must be > 0 m")
        object.__setattr__(self, "size", size)
        _check_material("Scene.matrix", self.matrix)
        object.__setattr__(self, "inclusions", _checked_inclusions(self.inclusions))
        _check_load(self)
        _check_geometry(self)

    @property
    def periodic(self) -> bool:
        """True for a periodic cell under a mean gradient, False for a box with walls."""
        return self.gradient is not None

    @property
    def materials(self) -> tuple[Material, ...]:
        """The matrix, then the material of each inclusion: index = phase number."""
        return (self.matrix, *(inclusion.material for inclusion in self.inclusions))

    @property
    def conductivities(self):
        """Conductivity of each phase, (1 + number of inclusions,) float array, W/(m K)."""
        return np.array([material.conductivity for material in self.materials])

    @property
    def volume(self) -> float:
        """Volume of the box, m3."""
        return math.prod(self.size)

    @property
    def wall_temperatures(self) -> dict[str, float]:
        """The walls held at a temperature."""
        return {name: float(v) for name, v in (self.walls or {}).items() if not isinstance(v, Flux)}

    @property
    def wall_fluxes(self) -> dict[str, float]:
        """The walls with an imposed flux, W/m2 into the body."""
        return {name: v.value for name, v in (self.walls or {}).items() if isinstance(v, Flux)}

    @property
    def axis(self) -> int:
        """Axis of a load by one pair of opposite walls.

        Raises
        ------
        ValueError
            If the load is anything else: only such a load defines an effective conductivity.
        """
        names = sorted(self.walls or {})
        if len(names) == 2 and names[0][0] == names[1][0]:
            return "xyz".index(names[0][0])
        raise ValueError(f"Scene.walls = {names}: only two opposite loaded walls define an axis of load")

    def images(self) -> list[tuple[int, Sphere]]:
        """Spheres that meet the box, as (phase number, Sphere), periodic images included, in painting order."""
        found = []
        for phase, sphere in enumerate(self.inclusions, start=1):
            if isinstance(sphere, Sphere):
                shifts = product((0, -1, 1), repeat=3) if self.periodic else [(0, 0, 0)]
                for shift in shifts:
                    center = tuple(
                        c % L + s * L if self.periodic else c
                        for c, s, L in zip(sphere.center, shift, self.size, strict=True)
                    )
                    if _meets_box(center, sphere.radius, self.size):
                        found.append((phase, Sphere(center, sphere.radius, sphere.material)))
        return found

    def phase_at(self, points):
        """Phase number (0 = matrix, i + 1 = inclusion i) at points, (n, 3) float array in metres -> (n,) int array."""
        points = np.asarray(points, dtype=float).reshape(-1, 3)
        phase = np.zeros(len(points), dtype=np.int32)
        box = np.array(self.size)
        for number, inclusion in enumerate(self.inclusions, start=1):
            if isinstance(inclusion, Layer):
                x = points[:, inclusion.axis]
                if self.periodic:
                    x = x % box[inclusion.axis]
                inside = (x >= inclusion.start) & (x <= inclusion.stop)
            else:
                offsets = points - inclusion.center
                if self.periodic:
                    offsets -= box * np.round(offsets / box)
                inside = inclusion.contains(offsets)
            phase[inside] = number
        return phase

    def check_steady(self) -> None:
        """Raise ValueError unless the load fixes a steady temperature level."""
        if not self.periodic and not self.wall_temperatures:
            raise ValueError(
                f"Scene.walls = {dict(self.walls)}: a steady solution needs at least one wall with a temperature"
            )


def _vector(name, value):
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError, OverflowError):
        array = None
    if array is None or array.shape != (3,) or not np.all(np.isfinite(array)):
        raise ValueError(f"{name} = {value!r}: must be three finite numbers")
    return tuple(array.tolist())


def _finite(name, value, valid, accept=lambda v: True):
    """A number as a float, or a ValueError that says what would be valid; no strings, arrays or huge integers."""
    try:
        good = isinstance(value, Real) and math.isfinite(value) and accept(value)
    except OverflowError:
        good = False
    if not good:
        raise ValueError(f"{name} = {value!r}: must be {valid}")
    return float(value)


def _number(owner, field, valid, accept=lambda v: True):
    name = f"{type(owner).__name__}.{field}"
    object.__setattr__(owner, field, _finite(name, getattr(owner, field), valid, accept))


def _check_material(name, value):
    if not isinstance(value, Material):
        raise ValueError(f"{name} = {value!r}: must be a Material")


def _checked_inclusions(inclusions):
    if not isinstance(inclusions, Sequence):
        raise ValueError(f"Scene.inclusions = {inclusions!r}: must be a sequence of Sphere or Layer")
    for number, inclusion in enumerate(inclusions):
        if not isinstance(inclusion, Sphere | Layer):
            raise ValueError(f"Scene.inclusions[{number}] = {inclusion!r}: must be a Sphere or a Layer")
    return tuple(inclusions)


def _check_load(scene):
    if (scene.gradient is None) == (scene.walls is None):
        given = "both" if scene.walls is not None else "neither"
        raise ValueError(
            f"Scene.gradient, Scene.walls: {given} given; a scene needs exactly one load: a mean gradient "
            "(periodic cell) or at least one wall with a temperature or Flux"
        )
    if scene.gradient is not None:
        gradient = _vector("Scene.gradient", scene.gradient)
        if not any(gradient):
            raise ValueError(f"Scene.gradient = {scene.gradient!r}: must not be zero")
        object.__setattr__(scene, "gradient", gradient)
        return
    if not isinstance(scene.walls, Mapping) or not scene.walls:
        raise ValueError(f"Scene.walls = {scene.walls!r}: must map at least one of {', '.join(WALLS)} to a load")
    object.__setattr__(scene, "walls", dict(scene.walls))
    for name, value in scene.walls.items():
        if name not in WALLS:
            raise ValueError(f"Scene.walls: unknown wall {name!r}; must be one of {', '.join(WALLS)}")
        if not isinstance(value, Flux):
            _finite(f"Scene.walls[{name!r}]", value, "a finite temperature or a Flux")


def _meets_box(center, radius, size):
    gap2 = sum(max(0.0, -c, c - L) ** 2 for c, L in zip(center, size, strict=True))
    return gap2 < radius**2


def _check_geometry(scene):
    for number, inclusion in enumerate(scene.inclusions):
        if isinstance(inclusion, Layer):
            length = scene.size[inclusion.axis]
            if inclusion.start < -TOUCH * length or inclusion.stop > length * (1 + TOUCH):
                raise ValueError(
                    f"Scene.inclusions[{number}]: layer from {inclusion.start} to {inclusion.stop} must "
                    f"lie in the box, 0 to {length}"
                )
            continue
        limit = min(scene.size) if scene.periodic else max(scene.size)
        if 2 * inclusion.radius > limit * (1 + TOUCH):
            raise ValueError(
                f"Scene.inclusions[{number}]: sphere of diameter {2 * inclusion.radius} is larger than "
                f"the box; must be <= {limit}"
            )
        if not scene.periodic and not _meets_box(inclusion.center, inclusion.radius, scene.size):
            raise ValueError(
                f"Scene.inclusions[{number}]: sphere at {inclusion.center} of radius {inclusion.radius} "
                f"lies outside the box {scene.size}"
            )
    _check_pairs(scene)


def _check_pairs(scene):
    """Refuse partial overlaps and inclusions hidden by later ones; vectorised over the spheres."""
    numbers = [i for i, inclusion in enumerate(scene.inclusions) if isinstance(inclusion, Sphere)]
    centers = np.array([scene.inclusions[i].center for i in numbers]).reshape(-1, 3)
    radii = np.array([scene.inclusions[i].radius for i in numbers])
    box = np.array(scene.size)
    tolerance = TOUCH * box.max()
    for k in range(len(numbers) - 1):
        offsets = centers[k + 1 :] - centers[k]
        if scene.periodic:
            offsets -= box * np.round(offsets / box)
        distance = np.sqrt(np.einsum("ij,ij->i", offsets, offsets))
        r, s = radii[k], radii[k + 1 :]
        apart = distance >= r + s - tolerance
        nested = distance + s <= r + tolerance
        hidden = (distance + r <= s + tolerance) & ~apart
        for other in np.flatnonzero(hidden | ~(apart | nested)):
            _refuse_pair(numbers[k], numbers[k + 1 + other], hidden[other])
    for i, inclusion in enumerate(scene.inclusions):
        if isinstance(inclusion, Layer):
            for j, other in enumerate(scene.inclusions):
                if isinstance(other, Sphere) or j > i:
                    _check_layer_pair(scene, min(i, j), max(i, j), tolerance)


def _check_layer_pair(scene, i, j, tolerance):
    """Refuse a layer and a sphere, or two layers, that overlap partially or of which the later hides the other."""
    first, second = scene.inclusions[i], scene.inclusions[j]
    axis = first.axis if isinstance(first, Layer) else second.axis
    if isinstance(first, Layer) and isinstance(second, Layer) and first.axis != second.axis:
        raise ValueError(f"Scene.inclusions[{i}], [{j}]: layers along different axes cross each other")
    before, after = _spans(scene, first, axis, tolerance), _spans(scene, second, axis, tolerance)
    if all(d <= a + tolerance or b <= c + tolerance for a, b in before for c, d in after):
        return
    if isinstance(second, Layer) and _covers(after, before, tolerance):
        _refuse_pair(i, j, True)
    if not (isinstance(first, Layer) and _covers(before, after, tolerance)):
        _refuse_pair(i, j, False)


def _spans(scene, inclusion, axis, tolerance):
    """Intervals of the box that an inclusion takes along an axis; two if it crosses a periodic face."""
    if isinstance(inclusion, Layer):
        return [(inclusion.start, inclusion.stop)]
    length, x, radius = scene.size[axis], inclusion.center[axis], inclusion.radius
    x = x % length if scene.periodic else x
    low, high = x - radius, x + radius
    spans = [(max(low, 0.0), min(high, length))]
    if scene.periodic and low < -tolerance:
        spans.append((low + length, length))
    if scene.periodic and high > length + tolerance:
        spans.append((0.0, high - length))
    return spans


def _covers(outer, inner, tolerance):
    return all(any(a <= c + tolerance and d <= b + tolerance for a, b in outer) for c, d in inner)


def _refuse_pair(i, j, hidden):
    if hidden:
        raise ValueError(f"Scene.inclusions[{i}] is hidden by inclusions[{j}]: list the outer one first")
    raise ValueError(
        f"Scene.inclusions[{i}] and [{j}] overlap partially: inclusions must be disjoint, touching or fully nested"
    )
