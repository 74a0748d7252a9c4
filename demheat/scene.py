"""What is computed: a box, its materials and inclusions, and one load.

A scene knows nothing of meshes, voxels or particles; every method reads the same one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from demheat.bodies import ROUND_AXES, WALLS, domain_volume, wall_names
from demheat.parts import Flux, Heating, Layer, Material, MovingCylinder, Sphere, check_material, finite, vector

__all__ = ["WALLS", "Flux", "Heating", "Layer", "Material", "MovingCylinder", "Scene", "Sphere"]

# Two surfaces closer than this fraction of the box touch: relative rounding of user-typed coordinates.
TOUCH = 1e-12
# Points whose phases are found together.
BLOCK = 4096


@dataclass(frozen=True)
class Scene:
    """A box of matrix with inclusions painted in order, under one load; or what is inscribed in the box.

    Give either `gradient` (the box is then a periodic cell) or `walls` (faces not named are insulated). A transient
    needs `initial` besides, and may do without any wall.

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
    walls : mapping of str to float, callable (time, s) -> float, or Flux, optional
        Keys "x-", "x+", "y-", "y+", "z-", "z+", and "round" for a round wall; a number is a temperature in the user's
        scale (K or degrees Celsius), a function one that changes in time, a `Flux` an imposed heat flux density.
    initial : float or callable (points) -> temperatures, optional
        Temperature at time 0; a function takes (n, 3) points in metres and returns (n,) temperatures.
    sources : sequence of Heating or MovingCylinder
        Heat sources, for transients.
    domain : {"box", "cylinder-x", "cylinder-y", "cylinder-z", "sphere"}
        The body inscribed in the box; a cylinder is named by its axis. Round ones are for transients.

    Raises
    ------
    ValueError
        If an argument is not as described; the message names it, its value and what would be valid.
    """

    size: tuple[float, float, float]
    matrix: Material
    inclusions: tuple[Sphere | Layer, ...] = ()
    gradient: tuple[float, float, float] | None = None
    walls: Mapping[str, float | Callable[[float], float] | Flux] | None = None
    initial: float | Callable | None = None
    sources: tuple[Heating | MovingCylinder, ...] = ()
    domain: str = "box"

    def __post_init__(self):
        size = vector("Scene.size", self.size)
        if min(size) <= 0:
            raise ValueError(f"Scene.size = {self.size!r}: all three lengths must be > 0 m")
        object.__setattr__(self, "size", size)
        check_material("Scene.matrix", self.matrix)
        object.__setattr__(self, "inclusions", _checked_inclusions(self.inclusions))
        _check_domain(self)
        _check_load(self)
        _check_transient_parts(self)
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
        """Volume of the body, m3."""
        return domain_volume(self.domain, self.size)

    @property
    def wall_temperatures(self) -> dict[str, float]:
        """The walls held at a temperature; a function where it depends on time (see `at`)."""
        return {name: _plain(v) for name, v in (self.walls or {}).items() if not isinstance(v, Flux)}

    @property
    def wall_fluxes(self) -> dict[str, float]:
        """The walls with an imposed flux, W/m2 into the body; a function where it depends on time (see `at`)."""
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
        spheres = [(k, i) for k, i in enumerate(self.inclusions) if isinstance(i, Sphere)]
        centers = np.array([sphere.center for _, sphere in spheres]).reshape(-1, 3)
        radii, away = np.array([sphere.radius for _, sphere in spheres]), np.zeros(len(self.inclusions), dtype=bool)
        # Of each block of points, near in space where they are near in memory, only spheres that may hold one count.
        for start in range(0, len(points), BLOCK):
            block = slice(start, start + BLOCK)
            low, high = points[block].min(axis=0), points[block].max(axis=0)
            offsets = self._nearest(0.5 * (low + high) - centers)
            reach = radii + 0.5001 * np.linalg.norm(high - low)
            away[[k for k, _ in spheres]] = np.einsum("ij,ij->i", offsets, offsets) > reach**2
            self._paint(points[block], np.flatnonzero(~away), phase[block])
        return phase

    def _paint(self, points, which, phase):
        """Write the phases of points in the inclusions of these numbers, in order."""
        for number in which:
            inclusion = self.inclusions[number]
            if isinstance(inclusion, Layer):
                x = points[:, inclusion.axis]
                if self.periodic:
                    x = x % self.size[inclusion.axis]
                inside = (x >= inclusion.start) & (x <= inclusion.stop)
            else:
                inside = inclusion.contains(self._nearest(points - inclusion.center))
            phase[inside] = number + 1

    def _nearest(self, offsets):
        """Offsets to the nearest periodic image, if there are any."""
        box = np.array(self.size)
        return offsets - box * np.round(offsets / box) if self.periodic else offsets

    def at(self, time) -> Scene:
        """The same scene with the loads of its walls as they are at a time in seconds."""
        if not any(callable(getattr(v, "value", v)) for v in (self.walls or {}).values()):
            return self
        walls = {}
        for name, load in self.walls.items():
            value = load.value if isinstance(load, Flux) else load
            value = finite(f"Scene.walls[{name!r}] at {time} s", value(time), "finite") if callable(value) else value
            walls[name] = Flux(value) if isinstance(load, Flux) else value
        return replace(self, walls=walls)

    def check_steady(self) -> None:
        """Raise unless a steady method can take this scene.

        Raises
        ------
        ValueError
            If no wall fixes the temperature level, or a load depends on time.
        NotImplementedError
            For heat sources and round bodies.
        """
        if self.sources or self.domain != "box":
            what = "heat sources" if self.sources else f"a {self.domain}"
            raise NotImplementedError(f"{what}: only transients take them; use evolve")
        loads = {name: getattr(load, "value", load) for name, load in (self.walls or {}).items()}
        changing = [name for name, load in loads.items() if callable(load)]
        if changing:
            raise ValueError(f"Scene.walls: {changing} depend on time; must be numbers for a steady solution")
        if not self.periodic and not self.wall_temperatures:
            raise ValueError(
                f"Scene.walls = {dict(self.walls or {})}: a steady solution needs at least one wall with a temperature"
            )

    def check_transient(self) -> None:
        """Raise ValueError unless there is all that a transient needs: initial temperature and heat capacities."""
        if self.periodic:
            raise ValueError("Scene.gradient: a transient needs walls instead, or insulation all round")
        if self.initial is None:
            raise ValueError("Scene.initial = None: a transient needs the temperature at time 0")
        for phase, material in enumerate(self.materials):
            for name in ("density", "heat_capacity"):
                if getattr(material, name) is None:
                    raise ValueError(f"Material.{name} = None in phase {phase}: a transient needs it; must be > 0")


def _plain(load):
    return load if callable(load) else float(load)


def _checked_inclusions(inclusions):
    if not isinstance(inclusions, Sequence):
        raise ValueError(f"Scene.inclusions = {inclusions!r}: must be a sequence of Sphere or Layer")
    for number, inclusion in enumerate(inclusions):
        if not isinstance(inclusion, Sphere | Layer):
            raise ValueError(f"Scene.inclusions[{number}] = {inclusion!r}: must be a Sphere or a Layer")
    return tuple(inclusions)


def _check_load(scene):
    transient = scene.initial is not None
    both = scene.gradient is not None and scene.walls is not None
    if both or (scene.gradient is None and scene.walls is None and not transient):
        raise ValueError(
            f"Scene.gradient, Scene.walls: {'both' if both else 'neither'} given; a scene needs exactly one load: a "
            "mean gradient (periodic cell) or at least one wall with a temperature or Flux"
        )
    if scene.gradient is not None:
        gradient = vector("Scene.gradient", scene.gradient)
        if not any(gradient):
            raise ValueError(f"Scene.gradient = {scene.gradient!r}: must not be zero")
        object.__setattr__(scene, "gradient", gradient)
        return
    valid = wall_names(scene.domain)
    walls = {} if scene.walls is None and transient else scene.walls
    if not isinstance(walls, Mapping) or not (walls or transient):
        raise ValueError(f"Scene.walls = {scene.walls!r}: must map at least one of {', '.join(valid)} to a load")
    object.__setattr__(scene, "walls", dict(walls))
    for name, value in scene.walls.items():
        if name not in valid:
            raise ValueError(f"Scene.walls: unknown wall {name!r}; must be one of {', '.join(valid)}")
        if not isinstance(value, Flux) and not callable(value):
            finite(f"Scene.walls[{name!r}]", value, "a finite temperature, a function of time or a Flux")


def _check_domain(scene):
    if scene.domain not in ROUND_AXES:
        raise ValueError(f"Scene.domain = {scene.domain!r}: must be one of {', '.join(ROUND_AXES)}")
    across = [scene.size[axis] for axis in ROUND_AXES[scene.domain]]
    if across and max(across) > min(across):
        raise ValueError(f"Scene.size = {scene.size} of a {scene.domain}: sides across its round axes must be equal")
    if across and scene.gradient is not None:
        raise ValueError(f"Scene.gradient with domain = {scene.domain!r}: only a box can be a periodic cell")


def _check_transient_parts(scene):
    if scene.initial is not None and not callable(scene.initial):
        finite("Scene.initial", scene.initial, "a finite temperature or a function of points")
    if not isinstance(scene.sources, Sequence) or not all(
        isinstance(source, Heating | MovingCylinder) for source in scene.sources
    ):
        raise ValueError(f"Scene.sources = {scene.sources!r}: must be a sequence of Heating or MovingCylinder")
    object.__setattr__(scene, "sources", tuple(scene.sources))


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
