"""All that lies on one side of a plane."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np

from demheat.scene.inputs import vector
from demheat.scene.material import Material, check_material
from demheat.scene.shapes.base import check_resistance
from demheat.scene.shapes.directions import across, unit
from demheat.scene.shapes.occ import placed
from demheat.scene.shapes.patterns import Room, grid, random_frame
from demheat.scene.shapes.sections import below
from demheat.scene.shapes.solid import Solid


@dataclass(frozen=True)
class HalfSpace(Solid):
    """All that lies behind a plane, which may be inclined; in boxes with walls only, for nothing repeats it.

    Parameters
    ----------
    point : (3,) sequence of float, m
        Of the plane.
    outward : (3,) sequence of float
        Out of it, of any length but 0.
    material : Material
    resistance : float, m2 K/W
        Of the plane, as that of the surface of a `Sphere`.

    Examples
    --------
    >>> from demheat import Material, Scene
    >>> from demheat.scene import HalfSpace
    >>> below = HalfSpace(point=(0.5, 0.5, 0.5), outward=(0, 1, 1), material=Material(5.0))
    >>> scene = Scene((1.0, 1.0, 1.0), Material(1.0), [below], walls={"y-": 0.0, "y+": 1.0})
    >>> scene.phase_at([[0.5, 0.2, 0.7], [0.5, 0.4, 0.7]]).tolist()
    [1, 0]
    >>> print(f"{below.volume_in(scene.size, periodic=False):.6f}")
    0.500000
    """

    point: tuple[float, float, float]
    outward: tuple[float, float, float]
    material: Material
    resistance: float = field(default=0.0, kw_only=True)

    finding = "form"
    kind = "half-space"
    stored = {"point": "point", "outward": "direction"}

    def __post_init__(self):
        object.__setattr__(self, "point", vector("HalfSpace.point", self.point))
        object.__setattr__(self, "outward", unit("HalfSpace.outward", self.outward))
        check_material("HalfSpace.material", self.material)
        check_resistance(self)

    @property
    def center(self) -> tuple[float, float, float]:
        """The point of its plane, m."""
        return self.point

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Infinite, m: along an axis it ends at most on one side."""
        return np.full(3, -math.inf), np.full(3, math.inf)

    @property
    def volume(self) -> float:
        """Infinite; see `volume_in`."""
        return math.inf

    def turned(self, order: Sequence[int]) -> HalfSpace:
        """The same half-space with axes order[0], order[1], order[2] as axes 0, 1, 2."""
        return replace(self, **{name: tuple(getattr(self, name)[a] for a in order) for name in ("point", "outward")})

    def meets(self, size: Sequence[float]) -> bool:
        """Whether it reaches into the box from 0 to a size, three lengths in metres."""
        return bool(self._distance(_box_corners(size) - np.array(self.point)).min() < 0)

    def volume_in(self, size: Sequence[float], *, periodic: bool) -> float:
        """Volume of the part in a box, m3; see `Shape.volume_in`."""
        box = np.array(size, dtype=float)
        share, _ = below(np.array([self.outward]), self.distance(box[None] / 2), box)
        return float(share[0]) * math.prod(size)

    def reach(self, direction: np.ndarray, size: Sequence[float] | None = None) -> float:
        """How far it reaches along a direction, m; see `Shape.reach`."""
        found = self.hull(size)
        if found is None:
            along = float(np.dot(direction, self.outward))
            same = np.linalg.norm(direction - along * np.array(self.outward)) <= 1e-14 * abs(along)
            return along * float(np.dot(self.point, self.outward)) if same and along > 0 else math.inf
        return float((found[0] @ direction).max())

    def hull(self, size: Sequence[float] | None = None) -> tuple[np.ndarray, float] | None:
        """Corners of its part in a box; see `Shape.hull`."""
        if size is None:
            return None
        points = _box_corners(size)
        height = self._distance(points - np.array(self.point))
        found = [points[height <= 0]]
        for i, j in ((i, i | bit) for i in range(8) for bit in (1, 2, 4) if not i & bit):
            if (height[i] < 0) != (height[j] < 0) and height[i] != height[j]:
                found.append((points[i] + height[i] / (height[i] - height[j]) * (points[j] - points[i]))[None])
        return np.concatenate(found), 0.0

    def planes(self) -> tuple[np.ndarray, np.ndarray]:
        """Its one plane; see `Shape.planes`."""
        return np.array([self.outward]), np.array([np.dot(self.point, self.outward)])

    def leans(self, size: Sequence[float]) -> np.ndarray:
        """How far its plane leans against walls; see `Shape.leans`."""
        return np.abs(self.outward)

    def check_fit(self, name: str, size: Sequence[float], *, periodic: bool) -> None:
        """Raise ValueError in a periodic cell; see `Shape.check_fit`."""
        if periodic:
            raise ValueError(f"{name}: half-space in a periodic cell does not repeat; must be in a box with walls")

    def pattern(self, spacing: float, rng: np.random.Generator, room: Room) -> tuple[np.ndarray, np.ndarray]:
        """Triangles on its plane, beyond the box too; see `Shape.pattern`."""
        frame, middle = random_frame(self.outward, rng), 0.5 * np.array(room.size)
        middle = middle - self.distance(middle[None])[0] * frame[2]
        count = int(np.ceil(0.5 * np.linalg.norm(room.size) / (np.sqrt(0.75) * spacing))) + 1
        i, j = grid(np.arange(-count, count + 1), np.arange(-count, count + 1))
        start = rng.uniform(-0.5, 0.5, 2)
        places = np.stack([i + 0.5 * (j % 2) + start[0], np.sqrt(0.75) * (j + start[1])], axis=1) * spacing
        return middle + places @ frame[:2], np.tile(frame[2], (len(places), 1))

    def cad(self, occ, box: np.ndarray, scale: float) -> int:
        """A box of OpenCASCADE, wide around the scene's; see `Shape.cad`."""
        wide = 2 * np.linalg.norm(box)
        tag = occ.addBox(-wide, -wide, -2 * wide, 2 * wide, 2 * wide, 2 * wide)
        normal = np.array(self.outward)
        # The point of its plane that is nearest to the middle: the box is then wide enough around it.
        middle = box / 2 - self.distance(scale * box[None] / 2)[0] / scale * normal
        return placed(occ, tag, np.stack([*across(normal), normal], axis=1), middle)

    def _distance(self, offsets):
        return offsets @ np.array(self.outward)

    def _normal(self, offsets):
        return np.tile(self.outward, (len(offsets), 1))


def _box_corners(size):
    """Corners of a box from 0 to a size, numbered by the bits 4 of x, 2 of y and 1 of z."""
    return np.array(list(product(*((0.0, float(side)) for side in size))))
