"""An ellipsoid."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from demheat.scene.inputs import moderate, vector
from demheat.scene.material import Material, check_material
from demheat.scene.rotations import IDENTITY, rotation, turned_rotation
from demheat.scene.shapes.base import Shape, check_resistance
from demheat.scene.shapes.directions import corners
from demheat.scene.shapes.occ import GENERIC, placed
from demheat.scene.shapes.solid import Solid

# Newton steps to the foot of a point, at most: found 5 to 15; each at least halves what is far, where few count.
STEPS = 200
# Points around a cut by a wall.
AROUND = 48
# Of a semi-axis: a point that lies in a plane of symmetry counts as this far off it, where its foot is one of two.
OFF = 1e-13


@dataclass(frozen=True)
class Ellipsoid(Solid):
    """An ellipsoid.

    Parameters
    ----------
    center : (3,) sequence of float, m
    semi_axes : (3,) sequence of float, m
        Half its length along each of its own axes.
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
    >>> from demheat.scene import Ellipsoid
    >>> along_y = Ellipsoid((0.5, 0.5, 0.5), (0.4, 0.2, 0.1), Material(5.0), rotation=(0, 0, pi / 2))
    >>> low, high = along_y.bounds()
    >>> low.round(12).tolist(), high.round(12).tolist()
    ([0.3, 0.1, 0.4], [0.7, 0.9, 0.6])
    """

    center: tuple[float, float, float]
    semi_axes: tuple[float, float, float]
    material: Material
    rotation: Sequence[float] | Sequence[Sequence[float]] = field(default=IDENTITY, kw_only=True)
    resistance: float = field(default=0.0, kw_only=True)

    stored = {"center": "point", "semi_axes": "lengths", "rotation": "rotation"}

    def __post_init__(self):
        object.__setattr__(self, "center", vector("Ellipsoid.center", self.center))
        object.__setattr__(self, "semi_axes", lengths("Ellipsoid.semi_axes", self.semi_axes))
        check_material("Ellipsoid.material", self.material)
        object.__setattr__(self, "rotation", rotation("Ellipsoid.rotation", self.rotation))
        check_resistance(self)

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest coordinates along each axis, two (3,) float arrays, m."""
        half = np.linalg.norm(self._columns(), axis=1)
        return np.array(self.center) - half, np.array(self.center) + half

    @property
    def volume(self) -> float:
        """Volume, m3."""
        return 4 / 3 * math.pi * math.prod(self.semi_axes)

    @property
    def width(self) -> float:
        """Its least width, m."""
        return 2 * min(self.semi_axes)

    def turned(self, order: Sequence[int]) -> Ellipsoid:
        """The same ellipsoid with axes order[0], order[1], order[2] as axes 0, 1, 2."""
        center = tuple(self.center[axis] for axis in order)
        return replace(self, center=center, rotation=turned_rotation(self.rotation, order))

    def ball(self) -> tuple[np.ndarray, float]:
        """A ball that holds it: centre and radius, m."""
        return np.array(self.center), max(self.semi_axes)

    def reach(self, direction: np.ndarray, size: Sequence[float] | None = None) -> float:
        """How far it reaches along a direction, m; see `Shape.reach`."""
        return float(np.dot(direction, self.center) + np.linalg.norm(direction @ self._columns()))

    def hull(self, size: Sequence[float] | None = None) -> tuple[np.ndarray, float]:
        """Balls of its least semi-axis, at the corners of a box; see `Shape.hull`.

        Of their hull no point less: along n it reaches |(a_i n_i)| <= least |n| + sum of (a_i - least) |n_i|.
        """
        least = min(self.semi_axes)
        columns = np.array(self.rotation) * (np.array(self.semi_axes) - least)
        return np.array(self.center) + corners(columns), least

    def encloses(self, other: Shape, shift: np.ndarray) -> bool:
        """Whether it surely holds another ellipsoid: exact but for rounding; see `Shape.encloses`.

        The map that makes this one the unit ball makes the other one c + M u, |u| <= 1. For every m above the largest
        eigenvalue of M'M, |c + M u|^2 <= |c|^2 + m + c M (m - M'M)^-1 M' c, of which the least is the greatest value
        that there is (a convex function of m, sought by thirds of its logarithm).
        """
        if not isinstance(other, Ellipsoid):
            return False
        to_ball = np.array(self.rotation).T / np.array(self.semi_axes)[:, None]
        offset = to_ball @ (np.array(other.center) + shift - np.array(self.center))
        left, stretch, _ = np.linalg.svd(to_ball @ other._columns())
        moved, square = (left.T @ offset) ** 2, stretch**2
        if square[0] > 1:
            return False
        least, most = -40.0, 5.0

        def bound(power):
            above = np.exp(power)
            return moved.sum() + square[0] + above + np.sum(moved * square / (square[0] - square + above))

        for _ in range(120):
            a, b = least + (most - least) / 3, most - (most - least) / 3
            least, most = (least, b) if bound(a) < bound(b) else (a, most)
        return bool(bound(0.5 * (least + most)) <= 1 + 1e-12)

    def leans(self, size: Sequence[float]) -> np.ndarray:
        """How far it leans against the walls that cut it, at points all around the cuts; see `Shape.leans`."""
        columns, found = self._columns(), np.zeros(3)
        for axis, row in enumerate(columns):
            half = np.linalg.norm(row)
            away = (np.array([0.0, size[axis]]) - self.center[axis]) / half
            for height in away[np.abs(away) < 1]:
                # On the ball that it is stretched from.
                circle = _circle(row / half, height)
                normals = circle / np.array(self.semi_axes) @ np.array(self.rotation).T
                found[axis] = max(found[axis], np.max(np.abs(normals[:, axis]) / np.linalg.norm(normals, axis=1)))
        return found

    @property
    def faces(self) -> list[Shape]:
        """Itself; see `Shape.faces`."""
        return [self]

    def cad(self, occ, box: np.ndarray, scale: float) -> int:
        """A ball of OpenCASCADE, stretched; see `Shape.cad`."""
        tag = occ.addSphere(0, 0, 0, 1)
        occ.rotate([(3, tag)], 0, 0, 0, *GENERIC)
        occ.dilate([(3, tag)], 0, 0, 0, *(np.array(self.semi_axes) / scale))
        return placed(occ, tag, self.rotation, np.array(self.center) / scale)

    def _columns(self):
        """Its semi-axes as the columns of a matrix, m."""
        return np.array(self.rotation) * np.array(self.semi_axes)

    def _inside(self, offsets):
        own = offsets @ np.array(self.rotation) / np.array(self.semi_axes)
        return np.einsum("ij,ij->i", own, own) <= 1.0

    def _feet(self, offsets):
        """Where the surface is nearest and the factor of its gradient to there, in its own axes and mean semi-axis.

        A point y has its foot at x_i = a_i^2 y_i / (t + a_i^2), with the greatest t at which x lies on the surface.
        The sum that says so is convex and falls: Newton's steps from below do not pass it.
        Source: Hart, Graphics Gems IV (1994) 113-119; Eberly, Geometric Tools (2013).
        """
        unit = float(np.cbrt(math.prod(self.semi_axes)))
        a = np.array(self.semi_axes) / unit
        own = offsets @ np.array(self.rotation) / unit
        y = np.maximum(np.abs(own), OFF * a)
        # From the least that t can be: digits remain where the foot is that of a point of a plane of symmetry.
        more = a * a - a.min() ** 2
        s = np.max(a * y - more, axis=1)
        going = np.arange(len(s))
        for _ in range(STEPS):
            width = s[going, None] + more
            part = a * y[going] / width
            excess = np.einsum("ij,ij->i", part, part) - 1.0
            step = 0.5 * excess / np.sum(part * part / width, axis=1)
            s[going] += step
            going = going[step > 4e-16 * s[going]]
            if not len(going):
                break
        foot = a * a * y / (s[:, None] + more)
        return np.copysign(foot, own), s - a.min() ** 2, a, unit

    def _surface(self, offsets):
        foot, t, a, unit = self._feet(offsets)
        normal = foot / (a * a)
        length = np.linalg.norm(normal, axis=1)
        return unit * t * length, normal / length[:, None] @ np.array(self.rotation).T


def _circle(axis: np.ndarray, height: float) -> np.ndarray:
    """Points on the unit ball at a height along an axis, (AROUND, 3) float array."""
    one = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    one /= np.linalg.norm(one)
    turns = 2 * np.pi * np.arange(AROUND)[:, None] / AROUND
    return height * axis + math.sqrt(1 - height**2) * (np.cos(turns) * one + np.sin(turns) * np.cross(axis, one))


def lengths(name: str, value) -> tuple[float, float, float]:
    """Three lengths above 0, or a ValueError."""
    found = vector(name, value)
    if min(found) <= 0 or not all(map(moderate, found)):
        raise ValueError(f"{name} = {value!r}: must be three lengths > 0 m")
    return found
