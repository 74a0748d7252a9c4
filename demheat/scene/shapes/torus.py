"""A torus: a ring with a round cross-section."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np

from demheat.scene.inputs import number, vector
from demheat.scene.material import Material, check_material
from demheat.scene.shapes.base import check_resistance
from demheat.scene.shapes.directions import across, unit
from demheat.scene.shapes.occ import placed
from demheat.scene.shapes.solid import Solid

# Points of its circle: as corners of a polygon around it, 0.2 % too wide, and where a box is looked for.
SIDES, PLACES = 48, 720
# Angles at which its patches meet, rad: off the planes of symmetry, which may be faces of the box.
OFF = 0.6


@dataclass(frozen=True)
class Torus(Solid):
    """A ring: all that is no farther from a circle than the radius of its tube.

    Parameters
    ----------
    center : (3,) sequence of float, m
    radius : float, m
        Of the circle in the middle of the tube.
    tube : float, m
        Radius of the tube, less than that of the circle.
    axis : (3,) sequence of float
        Through the hole, of any length but 0.
    material : Material
    resistance : float, m2 K/W
        Of its surface towards whatever it lies in, as that of a `Sphere`.

    Examples
    --------
    >>> from demheat import Material, Torus
    >>> ring = Torus(center=(0.5, 0.5, 0.5), radius=0.3, tube=0.1, axis=(0, 0, 1), material=Material(5.0))
    >>> print(f"{ring.volume:.6f} {ring.distance([[0.5, 0.5, 0.5]])[0]:.3f}")
    0.059218 0.200
    """

    center: tuple[float, float, float]
    radius: float
    tube: float
    axis: tuple[float, float, float]
    material: Material
    resistance: float = field(default=0.0, kw_only=True)

    convex = False
    stored = {"center": "point", "radius": "length", "tube": "length", "axis": "direction"}

    def __post_init__(self):
        object.__setattr__(self, "center", vector("Torus.center", self.center))
        number(self, "radius", "a finite number > 0 m", lambda v: v > 0)
        number(self, "tube", f"> 0 m and less than Torus.radius = {self.radius:g} m", lambda v: 0 < v < self.radius)
        object.__setattr__(self, "axis", unit("Torus.axis", self.axis))
        check_material("Torus.material", self.material)
        check_resistance(self)

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest coordinates along each axis, two (3,) float arrays, m."""
        u = np.array(self.axis)
        half = self.radius * np.sqrt(np.maximum(1 - u * u, 0.0)) + self.tube
        return np.array(self.center) - half, np.array(self.center) + half

    @property
    def volume(self) -> float:
        """Volume, m3."""
        return 2 * math.pi**2 * self.radius * self.tube**2

    @property
    def width(self) -> float:
        """Its least width, along its axis, m."""
        return 2 * self.tube

    def turned(self, order: Sequence[int]) -> Torus:
        """The same torus with axes order[0], order[1], order[2] as axes 0, 1, 2."""
        return replace(self, **{name: tuple(getattr(self, name)[a] for a in order) for name in ("center", "axis")})

    def ball(self) -> tuple[np.ndarray, float]:
        """A ball that holds it: centre and radius, m."""
        return np.array(self.center), self.radius + self.tube

    def meets(self, size: Sequence[float]) -> bool:
        """Whether it reaches into the box from 0 to a size: one in its hole, or nearly so, it does not."""
        return bool(self._gaps(size)[1].min() < self.tube + math.pi * self.radius / PLACES)

    def point_in(self, size: Sequence[float], *, periodic: bool) -> np.ndarray:
        """A point of the box that lies inside, (3,) float array, m: of its circle, or the nearest to that."""
        if periodic:
            return self._circle(1)[0] % np.array(size)
        points, gaps = self._gaps(size)
        return points[np.argmin(gaps)]

    def reach(self, direction: np.ndarray, size: Sequence[float] | None = None) -> float:
        """How far it reaches along a direction, m; see `Shape.reach`."""
        beside = np.linalg.norm(direction - np.dot(direction, self.axis) * np.array(self.axis))
        return float(np.dot(direction, self.center) + self.radius * beside + self.tube * np.linalg.norm(direction))

    def hull(self, size: Sequence[float] | None = None) -> tuple[np.ndarray, float]:
        """Balls as wide as its tube around its circle; see `Shape.hull`."""
        return self._circle(SIDES, self.radius / math.cos(math.pi / SIDES)), self.tube

    def cad(self, occ, box: np.ndarray, scale: float) -> int:
        """Four patches of OpenCASCADE, sewn; see `Shape.cad`.

        Of a torus in one piece, whose face ends in its own seams, gmsh cannot mesh what faces of a periodic cell leave.
        """
        large, small, patches = self.radius / scale, self.tube / scale, []
        for start, turn in product((OFF, OFF + math.pi), repeat=2):
            arc = [(1, occ.addCircle(large, 0, 0, small, -1, start, start + math.pi))]
            occ.rotate(arc, 0, 0, 0, 1, 0, 0, math.pi / 2)
            occ.rotate(arc, 0, 0, 0, 0, 0, 1, turn)
            patches += [tag for dim, tag in occ.revolve(arc, 0, 0, 0, 0, 0, 1, math.pi) if dim == 2]
        tag = occ.addVolume([occ.addSurfaceLoop(patches, sewing=True)])
        occ.remove([(2, patch) for patch in patches], recursive=True)
        frame = np.stack([*across(np.array(self.axis)), self.axis], axis=1)
        return placed(occ, tag, frame, np.array(self.center) / scale)

    def _circle(self, count, radius=None):
        """Points of its circle, or of a wider one, (count, 3) float array, m."""
        angle = 2 * np.pi * np.arange(count) / count
        ring = np.stack([np.cos(angle), np.sin(angle)], axis=1) @ across(np.array(self.axis))
        return np.array(self.center) + (self.radius if radius is None else radius) * ring

    def _gaps(self, size):
        """Points of a box nearest to those of its circle, and how near they are, m."""
        circle = self._circle(PLACES)
        points = np.clip(circle, 0.0, size)
        return points, np.linalg.norm(points - circle, axis=1)

    def _surface(self, offsets):
        axis, one = np.array(self.axis), across(np.array(self.axis))[:1]
        along = offsets @ axis
        beside = offsets - along[:, None] * axis
        away = np.linalg.norm(beside, axis=1)
        # From its axis all ways across are as near, from its circle all ways out of the tube.
        out = np.divide(beside, away[:, None], out=np.repeat(one, len(offsets), axis=0), where=away[:, None] > 0)
        length = np.hypot(away - self.radius, along)
        rest = (away - self.radius)[:, None] * out + along[:, None] * axis
        normal = np.divide(rest, length[:, None], out=np.tile(axis, (len(offsets), 1)), where=length[:, None] > 0)
        return length - self.tube, normal
