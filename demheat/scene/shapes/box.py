"""A box, turned as one likes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations, product

import numpy as np

from demheat.scene.inputs import vector
from demheat.scene.material import Material, check_material
from demheat.scene.rotations import IDENTITY, rotation, turned_rotation
from demheat.scene.shapes.base import ALONG, BESIDE, Shape, check_resistance
from demheat.scene.shapes.directions import corners
from demheat.scene.shapes.ellipsoid import lengths
from demheat.scene.shapes.half_space import HalfSpace
from demheat.scene.shapes.occ import placed
from demheat.scene.shapes.patterns import SQUARE, Room, grid
from demheat.scene.shapes.solid import Solid


@dataclass(frozen=True)
class Box(Solid):
    """A rectangular box.

    Parameters
    ----------
    center : (3,) sequence of float, m
    sides : (3,) sequence of float, m
        Lengths along its own axes.
    material : Material
    rotation : (3,) or (3, 3) array_like, or scipy.spatial.transform.Rotation
        A rotation vector in radians, or a matrix, whose columns are the directions of its own axes. Kept as a tuple of
        rows; by default they are x, y and z.
    resistance : float, m2 K/W
        Of its surface towards whatever it lies in, as that of a `Sphere`.

    Examples
    --------
    >>> from math import pi
    >>> from demheat import Material
    >>> from demheat.scene import Box
    >>> upright = Box((0.5, 0.5, 0.5), (0.4, 0.2, 0.1), Material(5.0), rotation=(0, -pi / 2, 0))
    >>> low, high = upright.bounds()
    >>> low.round(12).tolist(), high.round(12).tolist()
    ([0.45, 0.4, 0.3], [0.55, 0.6, 0.7])
    >>> Box((0.5, 0.5, 0.5), (0.4, 0.2, 0.0), Material(5.0))
    Traceback (most recent call last):
        ...
    ValueError: Box.sides = (0.4, 0.2, 0.0): must be three lengths > 0 m
    """

    center: tuple[float, float, float]
    sides: tuple[float, float, float]
    material: Material
    rotation: Sequence[float] | Sequence[Sequence[float]] = field(default=IDENTITY, kw_only=True)
    resistance: float = field(default=0.0, kw_only=True)

    finding = "form"
    stored = {"center": "point", "sides": "lengths", "rotation": "rotation"}

    def __post_init__(self):
        object.__setattr__(self, "center", vector("Box.center", self.center))
        object.__setattr__(self, "sides", lengths("Box.sides", self.sides))
        check_material("Box.material", self.material)
        object.__setattr__(self, "rotation", rotation("Box.rotation", self.rotation))
        check_resistance(self)

    @property
    def fills_bounds(self) -> bool:
        """Whether it is all of the box of its `bounds`."""
        return np.count_nonzero(self.rotation) == 3

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest coordinates along each axis, two (3,) float arrays, m."""
        half = np.abs(self.rotation) @ (0.5 * np.array(self.sides))
        return np.array(self.center) - half, np.array(self.center) + half

    @property
    def volume(self) -> float:
        """Volume, m3."""
        return math.prod(self.sides)

    @property
    def width(self) -> float:
        """Its least width, m."""
        return min(self.sides)

    def turned(self, order: Sequence[int]) -> Box:
        """The same box with axes order[0], order[1], order[2] as axes 0, 1, 2."""
        center = tuple(self.center[axis] for axis in order)
        return replace(self, center=center, rotation=turned_rotation(self.rotation, order))

    def reach(self, direction: np.ndarray, size: Sequence[float] | None = None) -> float:
        """How far it reaches along a direction, m; see `Shape.reach`."""
        half = 0.5 * np.array(self.sides)
        return float(np.dot(direction, self.center) + np.abs(direction @ np.array(self.rotation)) @ half)

    def hull(self, size: Sequence[float] | None = None) -> tuple[np.ndarray, float]:
        """Its corners; see `Shape.hull`."""
        return np.array(self.center) + corners(np.array(self.rotation) * (0.5 * np.array(self.sides))), 0.0

    def planes(self) -> tuple[np.ndarray, np.ndarray]:
        """Those of its six faces; see `Shape.planes`."""
        normals = np.concatenate([np.array(self.rotation).T, -np.array(self.rotation).T])
        return normals, normals @ np.array(self.center) + np.tile(0.5 * np.array(self.sides), 2)

    def edges(self, size: Sequence[float]) -> np.ndarray:
        """Points around its twelve edges; see `Shape.edges`."""
        turn, half = np.array(self.rotation), 0.5 * np.array(self.sides)
        beside, found = BESIDE * min(*self.sides, *size), []
        for one, other in combinations(range(3), 2):
            along = 3 - one - other
            for ends in product((-1.0, 1.0), repeat=2):
                points = np.zeros((ALONG, 4, 3))
                points[:, :, along] = (((np.arange(ALONG) + 0.5) / ALONG - 0.5) * self.sides[along])[:, None]
                for axis, end, ways in ((one, ends[0], (-1, -1, 1, 1)), (other, ends[1], (-1, 1, 1, -1))):
                    points[:, :, axis] = end * (half[axis] + beside * np.array(ways))
                found.append(points)
        return np.array(self.center) + np.concatenate(found) @ turn.T

    @property
    def faces(self) -> list[Shape]:
        """Half-spaces behind its faces; see `Shape.faces`."""
        found = []
        for (column, side), sign in product(zip(np.array(self.rotation).T, self.sides, strict=True), (-1, 1)):
            normal = sign * column
            found.append(HalfSpace(np.array(self.center) + 0.5 * side * normal, normal, self.material))
        return found

    def pattern(self, spacing: float, rng: np.random.Generator, room: Room) -> tuple[np.ndarray, np.ndarray]:
        """Squares on its faces, half a side from its edges; see `Shape.pattern`."""
        turn, middle = np.array(self.rotation).T, 0.5 * np.array(room.size)
        counts = np.maximum(1, np.rint(np.array(self.sides) / (SQUARE * spacing)).astype(int))
        ticks = [((np.arange(n) + 0.5) / n - 0.5) * side for n, side in zip(counts, self.sides, strict=True)]
        if not room.periodic:
            # Of faces far beyond the walls, what is near.
            near = np.linalg.norm(middle) + spacing
            ticks = [t[np.abs(t - m) <= near] for t, m in zip(ticks, turn @ (middle - self.center), strict=True)]
        points, normals = [], []
        for axis, sign in product(range(3), (-1.0, 1.0)):
            u, v = (k for k in range(3) if k != axis)
            first, second = grid(ticks[u], ticks[v])
            own = np.full((len(first), 3), sign * self.sides[axis] / 2)
            own[:, u], own[:, v] = first, second
            points.append(own)
            normals.append(np.tile(sign * np.eye(3)[axis], (len(own), 1)))
        return np.array(self.center) + np.concatenate(points) @ turn, np.concatenate(normals) @ turn

    def cad(self, occ, box: np.ndarray, scale: float) -> int:
        """A box of OpenCASCADE; see `Shape.cad`."""
        sides = np.array(self.sides) / scale
        tag = occ.addBox(*(-sides / 2), *sides)
        return placed(occ, tag, self.rotation, np.array(self.center) / scale)

    def _own(self, offsets):
        own = offsets @ np.array(self.rotation)
        return own, np.abs(own) - 0.5 * np.array(self.sides)

    def _distance(self, offsets):
        _, beyond = self._own(offsets)
        return np.linalg.norm(np.maximum(beyond, 0.0), axis=1) + np.minimum(beyond.max(axis=1), 0.0)

    def _normal(self, offsets):
        own, beyond = self._own(offsets)
        out = np.maximum(beyond, 0.0)
        # Inside, and on the surface, that of the nearest face.
        out[np.arange(len(out)), beyond.argmax(axis=1)] += np.all(beyond <= 0, axis=1)
        return np.copysign(out, own) / np.linalg.norm(out, axis=1, keepdims=True) @ np.array(self.rotation).T
