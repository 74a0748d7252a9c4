"""A cylinder: a fibre through the whole box, or a rod with flat ends."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np

from demheat.scene.inputs import LEAST, MOST, finite, moderate, number, vector
from demheat.scene.material import Material, check_material
from demheat.scene.shapes.base import ALONG, BESIDE, TOUCH, Shape, check_resistance
from demheat.scene.shapes.directions import across, unit
from demheat.scene.shapes.half_space import HalfSpace
from demheat.scene.shapes.occ import GENERIC
from demheat.scene.shapes.patterns import SQUARE, Room, grid, random_frame
from demheat.scene.shapes.solid import Solid

# Of the prism around a cylinder, whose corners lie in what holds it: 0.2 % too wide.
SIDES = 48
# Points round it, in a pattern on its surface, at least.
FEWEST_ROUND = 8


@dataclass(frozen=True)
class Cylinder(Solid):
    """A circular cylinder, without end along its axis or with flat ends.

    Parameters
    ----------
    center : (3,) sequence of float, m
        A point of its axis, half-way between its ends if it has any.
    radius : float, m
    axis : (3,) sequence of float
        Its direction, of any length but 0.
    material : Material
    length : float, m, optional
        Between its flat ends. None: it goes on without end; in a periodic cell it must then lie along x, y or z.
    resistance : float, m2 K/W
        Of its surface towards whatever it lies in, as that of a `Sphere`.

    Examples
    --------
    >>> from demheat import Material, Scene
    >>> from demheat.scene import Cylinder
    >>> fibre = Cylinder(center=(0.5, 0.5, 0.0), radius=0.3, axis=(0, 0, 1), material=Material(5.0))
    >>> rod = Cylinder((0.5, 0.5, 0.5), 0.1, (1, 1, 0), Material(5.0), length=0.6)
    >>> print(f"{rod.volume:.6f} {rod.distance([[0.5, 0.5, 0.7]])[0]:.3f}")
    0.018850 0.100
    >>> Scene((1.0, 1.0, 1.0), Material(1.0), [fibre], gradient=(1, 0, 0)).phase_at([[0.5, 0.7, 0.9]]).tolist()
    [1]
    """

    center: tuple[float, float, float]
    radius: float
    axis: tuple[float, float, float]
    material: Material
    length: float | None = field(default=None, kw_only=True)
    resistance: float = field(default=0.0, kw_only=True)

    finding = "form"
    stored = {"center": "point", "radius": "length", "axis": "direction", "length": "length"}

    def __post_init__(self):
        object.__setattr__(self, "center", vector("Cylinder.center", self.center))
        number(self, "radius", "a finite number > 0 m", lambda v: v > 0)
        object.__setattr__(self, "axis", unit("Cylinder.axis", self.axis))
        check_material("Cylinder.material", self.material)
        if self.length is not None:
            valid = f"None, or a number of metres from {LEAST:g} to {MOST:g}"
            object.__setattr__(
                self, "length", finite("Cylinder.length", self.length, valid, lambda v: v > 0 and moderate(v))
            )
        check_resistance(self)

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest coordinates along each axis, m; infinite where it goes on without end."""
        u = np.abs(self.axis)
        half = self.radius * np.sqrt(np.maximum(1 - u * u, 0.0))
        half = np.where(u > 0, np.inf, half) if self.length is None else half + 0.5 * self.length * u
        return np.array(self.center) - half, np.array(self.center) + half

    @property
    def volume(self) -> float:
        """Volume, m3; infinite without ends."""
        return math.inf if self.length is None else math.pi * self.radius**2 * self.length

    @property
    def width(self) -> float:
        """Its least width, m."""
        return 2 * self.radius if self.length is None else min(2 * self.radius, self.length)

    def turned(self, order: Sequence[int]) -> Cylinder:
        """The same cylinder with axes order[0], order[1], order[2] as axes 0, 1, 2."""
        return replace(self, **{name: tuple(getattr(self, name)[a] for a in order) for name in ("center", "axis")})

    def ball(self) -> tuple[np.ndarray, float]:
        """A ball that holds it: centre and radius, m; infinite without ends."""
        return np.array(self.center), math.inf if self.length is None else math.hypot(self.radius, self.length / 2)

    def reach(self, direction: np.ndarray, size: Sequence[float] | None = None) -> float:
        """How far it reaches along a direction, m; see `Shape.reach`."""
        along = float(np.dot(direction, self.axis))
        across = self.radius * float(np.linalg.norm(direction - along * np.array(self.axis)))
        if abs(along) > TOUCH * np.linalg.norm(direction):
            half = self._half(size)
            across += abs(along) * half if math.isfinite(half) else math.inf
        return float(np.dot(direction, self.center)) + across

    def hull(self, size: Sequence[float] | None = None) -> tuple[np.ndarray, float]:
        """Balls of one radius whose convex hull holds it; see `Shape.hull`.

        Without ends and in no box, points far out stand for the end that is none: they lie in nothing that has one.
        """
        half, u = self._half(size), np.array(self.axis)
        if self.length is None:
            half = half if math.isfinite(half) else 1e6 * self.radius
            return np.array(self.center) + np.outer([-half, half], u), self.radius
        angle = 2 * np.pi * np.arange(SIDES) / SIDES
        wide = self.radius / math.cos(math.pi / SIDES)
        ring = wide * np.stack([np.cos(angle), np.sin(angle)], axis=1) @ self._frame().T[:2]
        ends = [np.array(self.center) + ring + end * u for end in (-half, half)]
        return np.concatenate(ends), 0.0

    def volume_in(self, size: Sequence[float], *, periodic: bool) -> float:
        """Volume of the part in a box, m3; see `Shape.volume_in`."""
        if periodic and self.length is None:
            return math.pi * self.radius**2 * size[int(np.argmax(np.abs(self.axis)))]
        through = [] if periodic else [axis for axis in np.flatnonzero(self.axis) if self._passes(axis, size)]
        if not through:
            return super().volume_in(size, periodic=periodic)
        return math.pi * self.radius**2 * size[through[0]] / abs(self.axis[through[0]])

    def _passes(self, axis, size):
        """Whether it goes through both walls of an axis, with its ends beyond them, and meets no other."""
        along = abs(self.axis[axis])
        slope, slack = np.array(self.axis) / self.axis[axis], TOUCH * max(size)
        # Of a flat end what is nearest to the middle.
        reach = math.inf if self.length is None else 0.5 * self.length * along - self.radius * math.sqrt(1 - along**2)
        ends = np.array([-self.center[axis], size[axis] - self.center[axis]])
        if np.any(np.abs(ends) > reach + slack) or ends[0] > 0 or ends[1] < 0:
            return False
        tips = np.delete(self.center + np.outer(ends, slope), axis, axis=1)
        # Half of what a plane across that axis cuts out of it.
        half, sides = np.delete(self.radius * np.hypot(1.0, slope), axis), np.delete(np.array(size), axis)
        return bool(np.all((tips - half > -slack) & (tips + half < sides + slack)))

    def check_fit(self, name: str, size: Sequence[float], *, periodic: bool) -> None:
        """Raise ValueError in a periodic cell that does not repeat it; see `Shape.check_fit`."""
        if periodic and self.length is None and np.count_nonzero(self.axis) > 1:
            raise ValueError(
                f"{name}: cylinder without end along {self.axis} does not repeat in a periodic cell; must lie along x, "
                "y or z, or have a length"
            )

    def edges(self, size: Sequence[float]) -> np.ndarray:
        """Points around its two rims, if it has ends; see `Shape.edges`."""
        if self.length is None:
            return super().edges(size)
        axis = np.array(self.axis)
        one = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
        one /= np.linalg.norm(one)
        turns = 2 * np.pi * (np.arange(ALONG) + 0.5) / ALONG
        outward = np.cos(turns)[:, None] * one + np.sin(turns)[:, None] * np.cross(axis, one)
        beside = BESIDE * min(self.radius, self.length, *size)
        across = (self.radius + beside * np.array([-1, -1, 1, 1]))[None, :, None] * outward[:, None]
        up = (0.5 * self.length + beside * np.array([-1, 1, 1, -1]))[:, None] * axis
        return np.array(self.center) + np.concatenate([across + up, across - up])

    def leans(self, size: Sequence[float]) -> np.ndarray:
        """How far it leans against the walls that it goes through; see `Shape.leans`."""
        (low, high), u = self.bounds(), np.abs(self.axis)
        return np.where((u > 0) & ((low < 0) | (high > size)), np.sqrt(np.maximum(1 - u * u, 0.0)), 0.0)

    @property
    def faces(self) -> list[Shape]:
        """Itself without ends, and the half-spaces that end it; see `Shape.faces`."""
        if self.length is None:
            return [self]
        out = np.array(self.axis)
        ends = [HalfSpace(tip, way, self.material) for tip, way in zip(self._tips(), (-out, out), strict=True)]
        return [replace(self, length=None, resistance=0.0), *ends]

    def pattern(self, spacing: float, rng: np.random.Generator, room: Room) -> tuple[np.ndarray, np.ndarray]:
        """Rows of points along it, which share their angles, and rings on its ends; see `Shape.pattern`."""
        frame, side = random_frame(self.axis, rng), SQUARE * spacing
        low, high = self._ends(room)
        rows = max(1, round((high - low) / side))
        columns = max(FEWEST_ROUND, round(2 * np.pi * self.radius / side))
        heights = low + (np.arange(rows) + 0.5) * (high - low) / rows
        if not room.periodic:
            # Of a rod that reaches far beyond the walls, what is near.
            middle = 0.5 * np.array(room.size)
            heights = heights[np.abs(heights - (middle - self.center) @ frame[2]) <= np.linalg.norm(middle) + spacing]
        height, angle = grid(heights, 2 * np.pi * np.arange(columns) / columns)
        normals = np.outer(np.cos(angle), frame[0]) + np.outer(np.sin(angle), frame[1])
        points = [self.radius * normals + np.outer(height, frame[2])]
        normals = [normals]
        for end in () if self.length is None else (low, high):
            disc = _disc(self.radius, side) @ frame[:2]
            points.append(disc + end * frame[2])
            normals.append(np.tile(np.sign(end) * frame[2], (len(disc), 1)))
        return np.array(self.center) + np.concatenate(points), np.concatenate(normals)

    def facets(self, points: np.ndarray, normals: np.ndarray, room: Room) -> np.ndarray:
        """Points moved inwards, onto the prism of its volume with their tangent planes as sides; see `Shape.facets`.

        The volume of what tangent planes enclose is that of the mean of 1/cos^2 of the angle to the nearest point.
        """
        axis = np.array(self.axis)
        around = np.abs(normals @ axis) < 0.5
        if not around.any():
            return points
        own = points[around] - np.array(self.center)
        moved, inner = points.copy(), self._inner(own, normals[around], room)
        height = own @ axis
        moved[around] = np.array(self.center) + np.outer(height, axis) + inner * self.radius * normals[around]
        return moved

    def _inner(self, own, normals, room):
        """Distance of the sides of that prism from the axis over the radius, by points offset from the centre."""
        from scipy.spatial import cKDTree

        axis, frame, count = np.array(self.axis), across(self.axis), 40 * len(own)
        turn, height = np.pi * (1 + np.sqrt(5.0)) * np.arange(count), own @ axis
        # Between the outermost rows: beyond them no point is nearer than those.
        where = height.min() + (np.arange(count) + 0.5) / count * np.ptp(height)
        out = np.outer(np.cos(turn), frame[0]) + np.outer(np.sin(turn), frame[1])
        beside = self.radius * out + np.outer(where, axis)
        # Beyond a wall, which cuts an inclined one obliquely, there are no points.
        places = np.array(self.center) + beside
        here = np.all((places > 0) & (places < room.size), axis=1) | room.periodic
        if not here.any():
            return 1.0
        _, nearest = cKDTree(own).query(beside[here])
        cosine = np.maximum(np.einsum("ij,ij->i", out[here], normals[nearest]), 0.25)
        return float(np.mean(cosine**-2.0) ** -0.5)

    def cad(self, occ, box: np.ndarray, scale: float) -> int:
        """A cylinder of OpenCASCADE; see `Shape.cad`."""
        start, stop = (self.hull(box * scale)[0] if self.length is None else self._tips()) / scale
        tag = occ.addCylinder(*start, *(stop - start), self.radius / scale)
        # Its seam off the planes of symmetry, which may be faces of the box.
        occ.rotate([(3, tag)], *start, *self.axis, GENERIC[3])
        return tag

    def _tips(self):
        """Middles of its flat ends."""
        half = 0.5 * self.length * np.array(self.axis)
        return np.array(self.center) + np.array([-half, half])

    def _ends(self, room):
        """Ends along its axis, or of what is to have points, m from its centre."""
        if self.length is not None:
            return -0.5 * self.length, 0.5 * self.length
        heights = (np.array(list(product(*((0.0, side) for side in room.size)))) - self.center) @ np.array(self.axis)
        return heights.min(), heights.max()

    def _half(self, size):
        """Half its length; without ends that of all that can lie in a box."""
        if self.length is not None:
            return 0.5 * self.length
        if size is None:
            return math.inf
        box = np.array(size, dtype=float)
        # The ends are beyond the ball around the box, flat as they are.
        return float(np.linalg.norm(box) + np.linalg.norm(np.array(self.center) - box / 2) + self.radius)

    def _frame(self):
        """Two directions across the axis and the axis, as columns."""
        u = np.array(self.axis)
        return np.stack([*across(u), u], axis=1)

    def _parts(self, offsets):
        """Offsets along the axis, across it and the length of these."""
        along = offsets @ np.array(self.axis)
        across = offsets - along[:, None] * np.array(self.axis)
        return along, across, np.sqrt(np.einsum("ij,ij->i", across, across))

    def _inside(self, offsets):
        along, _, away = self._parts(offsets)
        inside = away <= self.radius
        return inside if self.length is None else inside & (np.abs(along) <= 0.5 * self.length)

    def _distance(self, offsets):
        along, _, away = self._parts(offsets)
        side = away - self.radius
        if self.length is None:
            return side
        end = np.abs(along) - 0.5 * self.length
        return np.hypot(np.maximum(side, 0.0), np.maximum(end, 0.0)) + np.minimum(np.maximum(side, end), 0.0)

    def _normal(self, offsets):
        along, across, away = self._parts(offsets)
        start = np.broadcast_to(self._frame()[:, 0], across.shape)
        outward = np.divide(across, away[:, None], out=start.copy(), where=away[:, None] > 0)
        if self.length is None:
            return outward
        side, end = away - self.radius, np.abs(along) - 0.5 * self.length
        # Outside by both, as far as it is beyond each; inside, and on the surface, by the nearer one.
        beyond = np.stack([np.maximum(side, 0.0), np.maximum(end, 0.0)], axis=1)
        flat = np.all(beyond == 0, axis=1)
        beyond[flat] = np.stack([side >= end, side < end], axis=1)[flat]
        beyond /= np.linalg.norm(beyond, axis=1, keepdims=True)
        return beyond[:, :1] * outward + np.outer(beyond[:, 1] * np.where(along < 0, -1.0, 1.0), self.axis)


def _disc(radius, side):
    """Points on rings of a disc, (k, 2) float array, m."""
    count = max(1, round(radius / side))
    rings = []
    for away in (np.arange(count) + 0.5) / count * radius:
        number = max(3, round(2 * np.pi * away * count / radius))
        angle = 2 * np.pi * (np.arange(number) + 0.5) / number
        rings.append(away * np.stack([np.cos(angle), np.sin(angle)], axis=1))
    return np.concatenate(rings)
