"""Any body inside of a closed surface of triangles, as scanners and design programs write them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product

import numpy as np

from demheat.scene.inputs import moderate, reals
from demheat.scene.material import Material, check_material
from demheat.scene.shapes.base import BESIDE, Shape, check_resistance
from demheat.scene.shapes.closed import closed
from demheat.scene.shapes.drawn import Drawn
from demheat.scene.shapes.patches import Patches
from demheat.scene.shapes.patterns import BEYOND, LIFTED, SPREAD, Room, between, closer
from demheat.scene.shapes.solid import Solid
from demheat.scene.shapes.triangles import TURN, Triangles

# Points along each side of its bounds that are looked at for one inside.
CELLS = 12
# Of the longest side of a box: how wide a body is whose unit is another.
OTHER_UNIT = 100.0
# Of its diagonal, below which a point is on its surface: the way to it says nothing there.
ON = 1e-9


@dataclass(frozen=True, eq=False, repr=False)
class SurfaceMesh(Solid):
    """What a closed surface of triangles holds; several pieces are several bodies, one within another is a cavity.

    Exact: what lies inside, and the volume. Distances are exact beside the surface, and elsewhere too long by at most
    an eightieth of its diagonal. Corners at one place are joined, and triangles may look either way.

    Parameters
    ----------
    vertices : (n, 3) array of float, m
    triangles : (m, 3) array of int
        Three vertices each, counted from 0.
    material : Material
    resistance : float, m2 K/W
        Of its surface towards whatever it lies in, as that of a `Sphere`.

    Raises
    ------
    ValueError
        If the surface is open, crosses itself, or has one side only.

    Examples
    --------
    >>> import numpy as np
    >>> from demheat import Material, SurfaceMesh
    >>> corners = np.array([(0.2, 0.2, 0.2), (0.8, 0.2, 0.2), (0.2, 0.8, 0.2), (0.2, 0.2, 0.8)])
    >>> sides = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
    >>> body = SurfaceMesh(corners, sides, Material(5.0))
    >>> print(f"{body.volume:.3f} {body.contains([[0.3, 0.3, 0.3], [0.7, 0.7, 0.7]]).tolist()}")
    0.036 [True, False]
    """

    vertices: np.ndarray
    triangles: np.ndarray
    material: Material
    resistance: float = field(default=0.0, kw_only=True)

    kind = "surface mesh"
    convex = False
    # Its own opposite side is not told: twins that would lie beyond it are none.
    depth = math.inf

    def __post_init__(self):
        vertices = reals("SurfaceMesh.vertices", self.vertices, "(n, 3) finite numbers, m")
        if vertices.ndim != 2 or vertices.shape[1] != 3 or not np.all(np.isfinite(vertices)):
            bad = "" if vertices.ndim != 2 else f", {np.count_nonzero(~np.isfinite(vertices))} of them not finite"
            raise ValueError(f"SurfaceMesh.vertices: of shape {vertices.shape}{bad}; must be (n, 3) finite numbers, m")
        triangles = np.asarray(self.triangles)
        good = triangles.ndim == 2 and triangles.shape[1] == 3 and len(triangles) and triangles.dtype.kind in "iu"
        if not good or triangles.min() < 0 or triangles.max() >= len(vertices):
            raise ValueError(
                f"SurfaceMesh.triangles: of shape {triangles.shape} and type {triangles.dtype}; must be (m, 3) whole "
                f"numbers of vertices, 0 to {len(vertices) - 1}"
            )
        if not all(map(moderate, np.ptp(vertices, axis=0))):
            raise ValueError("SurfaceMesh.vertices: lengths that floating point does not hold; must be in metres")
        check_material("SurfaceMesh.material", self.material)
        check_resistance(self)
        self._have(closed("SurfaceMesh", np.array(vertices, dtype=float), triangles.astype(int)))

    def __repr__(self):
        return f"SurfaceMesh({len(self.vertices)} vertices, {len(self.triangles)} triangles, {self.material})"

    def _have(self, body):
        """Take a body; its own coordinates count from the middle of its bounds, so that images share it."""
        middle = 0.5 * (body.vertices.min(axis=0) + body.vertices.max(axis=0))
        own = Triangles(body.vertices - middle, body.triangles)
        found = {"vertices": body.vertices, "triangles": body.triangles, "_middle": middle, "_body": own}
        for name, value in found.items():
            if isinstance(value, np.ndarray):
                value.flags.writeable = False
            object.__setattr__(self, name, value)

    @property
    def center(self) -> tuple[float, float, float]:
        """The middle of its bounds, m."""
        return tuple(self._middle.tolist())

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest coordinates along each axis, two (3,) float arrays, m."""
        half = self._body.vertices.max(axis=0)
        return self._middle - half, self._middle + half

    @property
    def volume(self) -> float:
        """Volume, m3."""
        return self._body.volume

    @property
    def drawn(self) -> Drawn:
        """Its triangles; see `Shape.drawn`."""
        body, sharp = self._body, int(self._patches.sharp.sum())
        reach = float(np.linalg.norm(body.vertices, axis=1).max())
        return Drawn(float(body.areas.sum()), len(body.triangles), sharp, reach)

    def placed(self, center: Sequence[float]) -> SurfaceMesh:
        """The same body with the middle of its bounds elsewhere; see `Shape.placed`."""
        shift = np.subtract(center, self.center)
        made = self._moved(vertices=self.vertices + shift)
        object.__setattr__(made, "_middle", self._middle + shift)
        object.__setattr__(made, "_body", self._body)
        return made

    def turned(self, order: Sequence[int]) -> SurfaceMesh:
        """The same body with axes order[0], order[1], order[2] as axes 0, 1, 2."""
        order = list(order)
        # An odd change of axes is a mirror, which turns triangles inside out.
        odd = np.linalg.det(np.eye(3)[order]) < 0
        made = self._moved()
        made._have(Triangles(self.vertices[:, order], self.triangles[:, ::-1] if odd else self.triangles))
        return made

    def sure_distance(self, points: np.ndarray, *, period: np.ndarray | None = None) -> np.ndarray:
        """Distance to its bounds, 0 within, m; see `Shape.sure_distance`."""
        low, high = self.bounds()
        beyond = np.abs(self._home(points, period)) - 0.5 * (high - low)
        return np.linalg.norm(np.maximum(beyond, 0.0), axis=1)

    def meets(self, size: Sequence[float]) -> bool:
        """Whether its bounds reach into the box from 0 to a size; see `Shape.meets`."""
        return Shape.meets(self, size)

    def point_in(self, size: Sequence[float], *, periodic: bool) -> np.ndarray:
        """A point of the box that lies inside, (3,) float array, m; see `Shape.point_in`."""
        points = self._inner + self._middle
        if periodic:
            return points[0] % np.array(size)
        inside = points[np.all((points > 0) & (points < size), axis=1)]
        return inside[0] if len(inside) else np.clip(points[0], 0.0, size)

    def check_fit(self, name: str, size: Sequence[float], *, periodic: bool) -> None:
        """Raise ValueError for a body that is so large, or so far away, that its unit must be another."""
        low, high = self.bounds()
        reach, longest = float(np.abs([low, high]).max()), max(size)
        if reach > OTHER_UNIT * longest:
            raise ValueError(
                f"{name}: vertices from {tuple(np.round(low, 9).tolist())} to {tuple(np.round(high, 9).tolist())} m, "
                f"the box is {longest:.6g} m wide: they seem to be in millimetres or another unit; must be in metres"
            )

    @cached_property
    def _patches(self):
        return Patches(self._body)

    @cached_property
    def _edges(self):
        return self._patches.edges(BESIDE * float(np.ptp(self._body.vertices, axis=0).min()))

    @property
    def kinks(self) -> float:
        """Angle at which neighbouring triangles meet on smooth parts; see `Shape.kinks`."""
        return self._patches.kinks

    def edges(self, size: Sequence[float]) -> np.ndarray:
        """Points around its sharpest edges; see `Shape.edges`."""
        return self._middle + self._edges[0]

    def wedges(self, size: Sequence[float]) -> np.ndarray:
        """Angles between the faces that meet at its edges, and on to their bisectors; see `Shape.wedges`."""
        return self._edges[1]

    def pattern(self, spacing: float, rng: np.random.Generator, room: Room) -> tuple[np.ndarray, np.ndarray]:
        """Points spread out between sharp edges, half a spacing from them; see `Shape.pattern`."""
        ends = self._room(room, BEYOND * spacing / SPREAD)
        points, normals = self._patches.spread(self._surface, spacing, rng, *ends)
        return points + self._middle, normals

    def choice(self, least: float, widest: float, wanted: Callable, rng: np.random.Generator, room: Room):
        """Points to choose from, half the least spacing off sharp edges; see `Shape.choice`."""
        points, normals = closer(self, widest, wanted, rng, room)
        far = ~self._patches.beside_edges(points - self._middle, 0.5 * least)
        return points[far], normals[far]

    def facets(self, points: np.ndarray, normals: np.ndarray, room: Room) -> np.ndarray:
        """What is between sharp edges for itself: across them planes are others; see `Shape.facets`."""
        own = points - self._middle
        triangle = self._body.feet(own)[1]
        moved = self._patches.facets(own, normals, triangle, between(own) / LIFTED, *self._room(room, 0.0))
        return moved + self._middle

    def _room(self, room, beyond):
        """Ends of a box with walls, counted from the middle, and so much more; infinite if it repeats."""
        if room.periodic:
            return -np.inf, np.inf
        return -beyond - self._middle, np.array(room.size) + beyond - self._middle

    @cached_property
    def _inner(self):
        """Points inside, that in the middle of its longest way through first, from the middle of its bounds, m."""
        body = self._body
        middle = body.corners[np.argmax(body.areas * np.abs(body.normals @ TURN[:, 2]))].mean(axis=0)
        met = body.heights(middle)
        widest = 2 * int(np.argmax(met[1::2] - met[0::2]))
        first = middle + 0.5 * (met[widest] + met[widest + 1]) * TURN[:, 2]
        ticks = (np.arange(CELLS) + 0.5) / CELLS * 2 - 1
        points = np.array(list(product(ticks, repeat=3))) * body.vertices.max(axis=0)
        return np.concatenate([first[None], points[body.holds(points)]])

    def _inside(self, offsets):
        inside = np.zeros(len(offsets), bool)
        half = self._body.vertices.max(axis=0)
        within = np.flatnonzero(np.all(np.abs(offsets) <= half, axis=1))
        inside[within] = self._body.holds(offsets[within])
        return inside

    def _surface(self, offsets):
        offsets = np.asarray(offsets, dtype=float)
        feet, triangle = self._body.feet(offsets)
        sign = np.where(self._inside(offsets), -1.0, 1.0)
        out = (offsets - feet) * sign[:, None]
        away = np.linalg.norm(out, axis=1)
        near = away <= ON * np.linalg.norm(self._body.vertices.max(axis=0))
        normal = np.divide(out, away[:, None], out=np.zeros_like(out), where=~near[:, None])
        return sign * away, np.where(near[:, None], self._body.normals[triangle], normal)
