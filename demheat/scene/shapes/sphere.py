"""A sphere."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from demheat.scene.inputs import number, vector
from demheat.scene.material import Material, check_material
from demheat.scene.shapes.base import Shape, check_resistance
from demheat.scene.shapes.periodic import nearest


@dataclass(frozen=True)
class Sphere(Shape):
    """A spherical inclusion.

    Parameters
    ----------
    center : (3,) sequence of float, m
    radius : float, m
    material : Material
    resistance : float, m2 K/W
        Of its surface towards whatever it lies in: the temperature jumps there by so many times the flux across it.
        0 is a perfect interface.

    Examples
    --------
    >>> import numpy as np
    >>> from demheat import Material, Sphere
    >>> bead = Sphere(center=(0.5, 0.5, 0.5), radius=0.2, material=Material(1.05))
    >>> points = np.array([(0.5, 0.5, 0.6), (0.1, 0.1, 0.1)])
    >>> bead.contains(points), bead.distance(points).round(6)
    (array([ True, False]), array([-0.1    ,  0.49282]))
    """

    center: tuple[float, float, float]
    radius: float
    material: Material
    resistance: float = field(default=0.0, kw_only=True)

    finding = "form"
    fills_ball = True
    stored = {"center": "point", "radius": "length"}

    def __post_init__(self):
        object.__setattr__(self, "center", vector("Sphere.center", self.center))
        number(self, "radius", "a finite number > 0 m", lambda v: v > 0)
        check_material("Sphere.material", self.material)
        check_resistance(self)

    def contains(self, points: np.ndarray, *, period: np.ndarray | None = None) -> np.ndarray:
        """Which points lie inside or on the surface; see `Shape.contains`."""
        offsets = nearest(points - self.center, period)
        return np.einsum("ij,ij->i", offsets, offsets) <= self.radius**2

    def distance(self, points: np.ndarray, *, period: np.ndarray | None = None) -> np.ndarray:
        """Distance of points to the surface, m, negative inside; see `Shape.distance`."""
        offsets = nearest(points - self.center, period)
        return np.sqrt(np.einsum("ij,ij->i", offsets, offsets)) - self.radius

    def normal(self, points: np.ndarray, *, period: np.ndarray | None = None) -> np.ndarray:
        """Outward normal at the nearest point of the surface, along x for the centre; see `Shape.normal`."""
        offsets = nearest(points - self.center, period)
        length = np.linalg.norm(offsets, axis=1, keepdims=True)
        return np.divide(offsets, length, out=np.tile([1.0, 0.0, 0.0], (len(offsets), 1)), where=length > 0)

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest coordinates along each axis, two (3,) float arrays, m."""
        center = np.array(self.center)
        return center - self.radius, center + self.radius

    @property
    def volume(self) -> float:
        """Volume, m3."""
        return 4 / 3 * math.pi * self.radius**3

    @property
    def width(self) -> float:
        """Its diameter, m."""
        return 2 * self.radius

    def leans(self, size: Sequence[float]) -> np.ndarray:
        """How far it leans against the walls that cut it; see `Shape.leans`."""
        away = np.abs([self.center, np.array(size) - self.center]) / self.radius
        return np.where(away < 1, away, 0.0).max(axis=0)

    @property
    def faces(self) -> list[Shape]:
        """Itself; see `Shape.faces`."""
        return [self]

    def cad(self, occ, box: np.ndarray, scale: float) -> int:
        """A ball of OpenCASCADE, with its poles along z; see `Shape.cad`."""
        return occ.addSphere(*(np.array(self.center) / scale), self.radius / scale)

    def turned(self, order: Sequence[int]) -> Sphere:
        """The same sphere with axes order[0], order[1], order[2] as axes 0, 1, 2."""
        return replace(self, center=tuple(self.center[axis] for axis in order))

    def ball(self) -> tuple[np.ndarray, float]:
        """Centre and radius, m."""
        return np.array(self.center), self.radius

    def reach(self, direction: np.ndarray, size: Sequence[float] | None = None) -> float:
        """How far it reaches along a direction, m; see `Shape.reach`."""
        return float(direction @ np.array(self.center) + self.radius * np.linalg.norm(direction))

    def hull(self, size: Sequence[float] | None = None) -> tuple[np.ndarray, float]:
        """Centre and radius, m; see `Shape.hull`."""
        return np.array([self.center]), self.radius

    def meets(self, size: Sequence[float]) -> bool:
        """Whether it reaches into the box from 0 to a size, three lengths in metres."""
        gap2 = sum(max(0.0, -c, c - side) ** 2 for c, side in zip(self.center, size, strict=True))
        return gap2 < self.radius**2
