"""What every shape knows of itself: inside and outside, distance, normal, bounds and volume."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import product
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from demheat.scene.inputs import moderate, number
from demheat.scene.material import WITHIN, Material
from demheat.scene.shapes.drawn import Drawn
from demheat.scene.shapes.patterns import Room, closer, even_points, level

# Two surfaces closer than this fraction of the box touch: relative rounding of user-typed coordinates.
TOUCH = 1e-12
# Points along an edge that are looked at, and how far beside it, of the shortest length there is.
ALONG, BESIDE = 8, 1e-6
# What a class derived from a finished shape may say anew: the rest is its geometry.
OWN = {"material", "resistance", "kind", "stored"}


class Shape(ABC):
    """A region of one material, mostly convex: what every inclusion is, and what the next one must supply.

    A shape is a frozen dataclass in a file of its own. It checks its fields as it is made (`demheat.scene.inputs`) and
    lives in unbounded space: it knows neither box nor walls. All lengths are metres. What it must supply:

    - the fields `center`, three floats, and `material`; a shape without a centre overrides what uses it: `images`
      and `point_in`;
    - `distance` and `normal` of (n, 3) points, `bounds`, `volume` and `turned`, as described below;
    - if heat may meet a resistance on its surface, the field `resistance`, by keyword, see `check_resistance`.

    Points, (n, 3) float arrays in metres, on the surface count as inside. Where the `period` of a periodic cell is
    given, (3,) in metres, the shape is repeated at whole multiples of it along each axis and the nearest image counts,
    which is that of the centre in shapes no larger than the period (`nearest`). A `size` is that of the scene's box,
    three lengths in metres; where it may be None, what lies beyond a box with walls need not count.

    `Solid` supplies most of it. That is enough for phases, voxels by any rule, links cut at the surface and facets of
    the DEM on it. What a shape may supply besides, or where it has something sharper or faster:

    - `cad`, for finite elements, which cut others out of a lattice; `stored`, for scene files, which hold none
      without it;
    - `edges`, if it is not smooth: errors fall slowly beside them, which intervals must know; `wedges`, if these are
      not upright;
    - `pattern` and `facets` of the DEM, where evenly spread points are not the best there are;
    - `contains`, `ball`, `meets`, `volume_in`, `width`, `depth`, `fills_bounds` and `fills_ball`;
    - for pairs `reach`, `hull`, `planes` and `encloses`; one that is not convex says so, one whose distance is not
      exact overrides `sure_distance`; `faces`, if it may be a member of a union.
    """

    center: tuple[float, float, float]
    material: Material
    # Of its surface towards whatever it lies in, m2 K/W: what heat that crosses it meets besides both sides.
    resistance: float = 0.0
    # Whether it is all of the box of its `bounds`.
    fills_bounds = False
    # Whether it is all of its `ball`: balls are looked at all at once.
    fills_ball = False
    # Whether its surface is planes across the box and its axes, which grids follow exactly.
    flat = False
    # Whether it holds the line between any two of its points.
    convex = True
    # Whether it may be wider than a box with walls, which cut it.
    overhangs = False
    # Whether its surface can be found: distances and normals are those to it.
    traceable = True
    # How points on its surface are found, by which costs are told beforehand: by a closed "form", by a "search", or by
    # asking a "function" again and again.
    finding = "search"
    # Angle at which neighbouring faces of a surface meet that stands for a smooth one, radians.
    kinks = 0.0
    # What it is called in messages and in scene files: its class in small letters, if it says nothing else.
    kind: ClassVar[str]
    # What of it scene files have, besides material and resistance: fields, each with what its numbers are, a key of
    # `demheat.io.scenes.scene_table.FIELDS`.
    stored: ClassVar[Mapping[str, str]] = {}

    def __init_subclass__(cls, **knobs):
        """Name a class; refuse one that changes the geometry of a finished shape: who reads fields would not see."""
        super().__init_subclass__(**knobs)
        cls.kind = vars(cls).get("kind", cls.__name__.lower())
        geometry = {"center", *(name for name in vars(Shape) if not name.startswith("_"))} - OWN
        for base in cls.__mro__[1:]:
            finished = issubclass(base, Shape) and base is not Shape and not base.__abstractmethods__
            changed = sorted(geometry & vars(cls).keys()) if finished else []
            if changed:
                raise TypeError(
                    f"class {cls.__name__} changes {', '.join(changed)} of {base.__name__}, whose fields methods read: "
                    "must derive from Shape instead"
                )

    @abstractmethod
    def distance(self, points: ArrayLike, *, period: np.ndarray | None = None) -> np.ndarray:
        """Distance of points to the surface, negative inside, (n,) float array, m."""

    @abstractmethod
    def normal(self, points: ArrayLike, *, period: np.ndarray | None = None) -> np.ndarray:
        """Outward normal of the surface where it is nearest to points, the gradient of `distance`, (n, 3) float array.

        Of length 1; any of the nearest ones where there are several.
        """

    @abstractmethod
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest coordinates along each axis, two (3,) float arrays, m; infinite where it has no end."""

    @property
    @abstractmethod
    def volume(self) -> float:
        """Volume, m3; infinite where it has no end."""

    @abstractmethod
    def turned(self, order: Sequence[int]) -> Shape:
        """The same shape with axes order[0], order[1], order[2] as axes 0, 1, 2."""

    def contains(self, points: ArrayLike, *, period: np.ndarray | None = None) -> np.ndarray:
        """Which points lie inside or on the surface, (n,) bool array; up to rounding their distance is not positive."""
        return self.distance(points, period=period) <= 0.0

    @property
    def width(self) -> float:
        """Its least width in any direction, m, or that along the axes where no more is known; infinite without ends."""
        low, high = self.bounds()
        ends = np.isfinite(low)
        return float(np.min(high[ends] - low[ends], initial=np.inf))

    @property
    def drawn(self) -> Drawn:
        """What it is drawn by, if it is by triangles."""
        return Drawn()

    @property
    def depth(self) -> float:
        """How far inwards of its surface nothing of it is in the way, m; infinite without another side."""
        return 0.5 * self.width

    @property
    def parts(self) -> tuple[Shape, ...]:
        """Shapes that it is the union of: itself, if it is none."""
        return (self,)

    @property
    def bounded(self) -> bool:
        """Whether it ends along every axis."""
        return bool(np.all(np.isfinite(self.bounds())))

    def ball(self) -> tuple[np.ndarray, float]:
        """A ball that holds it: centre, (3,) float array, and radius, both m; infinite for what has no end."""
        low, high = self.bounds()
        if not self.bounded:
            return np.zeros(3), math.inf
        return 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low))

    def meets(self, size: Sequence[float]) -> bool:
        """Whether it reaches into the box from 0 to a size, three lengths in metres; if in doubt, it does."""
        low, high = self.bounds()
        return bool(np.all((high > 0) & (low < size)))

    def images(self, size: Sequence[float], *, periodic: bool) -> list[Shape]:
        """The shape as it meets a box; in a periodic cell all its images, that of the centre in the box first.

        Of spheres, all at once, the same in `references.voxels.spheres.images`.
        """
        if not periodic:
            return [self] if self.meets(size) else []
        home = tuple(c % side for c, side in zip(self.center, size, strict=True))
        low, high = (ends - self.center + home for ends in self.bounds())
        found = []
        for shift in product((0, -1, 1), repeat=3):
            sides = zip(shift, low, high, size, strict=True)
            if all(b + s * side > -TOUCH * side and a + s * side < (1 + TOUCH) * side for s, a, b, side in sides):
                place = tuple(c + s * side for c, s, side in zip(home, shift, size, strict=True))
                image = self.placed(place)
                found += [image] if image.meets(size) else []
        return found

    def placed(self, center: Sequence[float]) -> Shape:
        """The same shape with its centre elsewhere, m."""
        return replace(self, center=tuple(center))

    def point_in(self, size: Sequence[float], *, periodic: bool) -> np.ndarray:
        """A point of the box that lies inside, or in an image if it is periodic, (3,) float array, m."""
        center, box = np.array(self.center), np.array(size)
        return center % box if periodic else np.clip(center, 0.0, box)

    def volume_in(self, size: Sequence[float], *, periodic: bool) -> float:
        """Volume of the part in a box, m3: all of it in a periodic one; NotImplementedError if a wall cuts it."""
        low, high = self.bounds()
        slack = TOUCH * max(size)
        if not periodic and np.any((low < -slack) | (high > np.array(size) + slack)):
            raise NotImplementedError(f"no closed form for the volume of a {self.kind} at {self.center} cut by a wall")
        return self.volume

    def surface(self, points: ArrayLike, *, period: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """`distance` and `normal` of points, at once where that is faster."""
        return self.distance(points, period=period), self.normal(points, period=period)

    def sure_distance(self, points: ArrayLike, *, period: np.ndarray | None = None) -> np.ndarray:
        """Distance that a point surely has to the surface at least, outside; inside less than 0 where that is exact."""
        return self.distance(points, period=period)

    def reach(self, direction: np.ndarray, size: Sequence[float] | None = None) -> float:
        """How far it reaches along a direction, (3,): direction . x is no more in any of its points, m."""
        low, high = self._clipped(size)
        with np.errstate(invalid="ignore"):
            parts = np.maximum(direction * low, direction * high)
        return float(np.where(direction == 0, 0.0, parts).sum())

    def hull(self, size: Sequence[float] | None = None) -> tuple[np.ndarray, float] | None:
        """Balls of one radius whose convex hull holds it: centres, (m, 3), and radius, m; None where it has no end."""
        low, high = self._clipped(size)
        if not (np.all(np.isfinite(low)) and np.all(np.isfinite(high))):
            return None
        return np.array(list(product(*zip(low, high, strict=True)))), 0.0

    def planes(self) -> tuple[np.ndarray, np.ndarray] | None:
        """Outward normals (m, 3) and offsets (m,), m, of the planes that it is all of the inside of; None if none."""
        return None

    def edges(self, size: Sequence[float]) -> np.ndarray:
        """Points in the four quadrants around its sharp edges, `ALONG` for each, (n, 4, 3) float array, m.

        They lie `BESIDE` of the shortest length from the edge; none where it is smooth all over.
        """
        return np.empty((0, 4, 3))

    def leans(self, size: Sequence[float]) -> np.ndarray:
        """Largest cosine between its normals and those of the walls that it goes through, (3,) float array."""
        return np.zeros(3)

    def wedges(self, size: Sequence[float]) -> np.ndarray:
        """Angles of the wedges around its edges in which the points of `edges` lie, in turn, (n, 4) float array."""
        return np.full(self.edges(size).shape[:2], 0.5 * np.pi)

    @property
    def faces(self) -> Sequence[Shape]:
        """Convex shapes with smooth surfaces that it is all of the inside of, for unions; none if it is no member."""
        return ()

    def pattern(self, spacing: float, rng: np.random.Generator, room: Room) -> tuple[np.ndarray, np.ndarray]:
        """Points evenly all over its surface in a box, and maybe beyond, and outward normals, two (k, 3) arrays."""
        return even_points(self, spacing, rng, room)

    def choice(self, least: float, widest: float, wanted: Callable, rng: np.random.Generator, room: Room):
        """Points and normals to choose closer ones from: where less than `widest` is `wanted` of points and normals."""
        own = type(self).pattern is not Shape.pattern
        return self.pattern(least, rng, room) if own else closer(self, widest, wanted, rng, room)

    def facets(self, points: np.ndarray, normals: np.ndarray, room: Room) -> np.ndarray:
        """Points of a pattern moved along normals so that planes there keep the volume, (k, 3) float array, m."""
        return points if self.planes() is not None else level(self, points, normals, room)

    def cad(self, occ, box: np.ndarray, scale: float) -> int:
        """Add it to a geometry of OpenCASCADE (`gmsh.model.occ`), and give the tag of its volume.

        Lengths are divided by the scale, m, those of the scene's box are already: of what goes on beyond that only the
        part within need be right.
        """
        raise NotImplementedError(f"a {self.kind} has no volume of OpenCASCADE")

    def encloses(self, other: Shape, shift: np.ndarray) -> bool:
        """Whether it surely holds another shape, first moved by a shift, m, by what both know of their own kind."""
        return False

    def check_fit(self, name: str, size: Sequence[float], *, periodic: bool) -> None:
        """Raise ValueError, by a name, unless it can lie in a box, but for its width: its bounds are looked at."""
        return

    def _clipped(self, size):
        """Bounds, of what lies in a box if there is one."""
        low, high = self.bounds()
        return (low, high) if size is None else (np.maximum(low, 0.0), np.minimum(high, size))


def check_resistance(shape: Shape) -> None:
    """Check and cast the resistance of a shape's surface, m2 K/W, or raise ValueError."""
    number(shape, "resistance", f"a finite number >= 0 m2 K/W{WITHIN}", lambda v: v >= 0 and moderate(v))
