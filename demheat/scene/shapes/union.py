"""Shapes of one material that overlap, as one."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations

import numpy as np

from demheat.scene.material import Material, check_material
from demheat.scene.shapes.base import Shape, check_resistance
from demheat.scene.shapes.creases import crease
from demheat.scene.shapes.occ import GENERIC
from demheat.scene.shapes.patterns import SPREAD, Room, closer, lifted, sampled, sampled_between, spread
from demheat.scene.shapes.samples import volume_by_cells
from demheat.scene.shapes.solid import Solid

# Of its width: a point this near to a surface lies on it; far above rounding, far below what anything resolves.
ON = 1e-9
# Of an endless one, over its width: how thick a slice its cross-section is measured in.
SLICE = 1 / 96
# Cosines of normals: from which on one is that of a face, and from which on two faces go on in each other.
FLAT, ALIKE = 1.0 - 1e-6, 0.98


@dataclass(frozen=True)
class Union(Solid):
    """All that lies in any of several shapes, which may overlap: one body without surfaces inside.

    Exact: what lies inside, and distances outside. Inside it is the distance to the nearest point of the surface that
    is found, on the members' faces and on the creases where two of them meet: never less than the true one, and more
    at most where that is a corner or an edge on which a crease ends. Where none is found it is the depth in the
    deepest member, which is no more than the true one. Its volume, by planes in small cells, is right to some 1e-4.

    Parameters
    ----------
    shapes : sequence of Sphere, Cylinder, Ellipsoid and Box
        Two or more, of the union's material and without resistances of their own; they overlap, so that they are one
        piece. Without end along the same axes, or with ends.
    material : Material
    resistance : float, m2 K/W
        Of its surface towards whatever it lies in, as that of a `Sphere`.

    Examples
    --------
    >>> from demheat import Material, Sphere
    >>> from demheat.scene import Union
    >>> steel = Material(50.0)
    >>> grains = [Sphere((x, 0.5, 0.5), 0.2, steel) for x in (0.35, 0.65)]
    >>> neck = Union(grains, steel)
    >>> neck.contains([[0.5, 0.5, 0.6], [0.5, 0.5, 0.7]]).tolist()
    [True, False]
    >>> print(f"{neck.distance([[0.5, 0.5, 0.5]])[0]:.6f} {-(0.2**2 - 0.15**2)**0.5:.6f}")
    -0.132288 -0.132288
    >>> print(f"{neck.volume:.4f} {sum(ball.volume for ball in grains):.4f}")
    0.0641 0.0670
    """

    shapes: Sequence[Shape]
    material: Material
    resistance: float = field(default=0.0, kw_only=True)

    convex = False
    stored = {"shapes": "members"}

    def __post_init__(self):
        valid = "must be a sequence of two or more of Sphere, Cylinder, Ellipsoid and Box"
        if not isinstance(self.shapes, Sequence) or isinstance(self.shapes, str) or len(self.shapes) < 2:
            raise ValueError(f"Union.shapes = {self.shapes!r}: {valid}")
        check_material("Union.material", self.material)
        for number, shape in enumerate(self.shapes):
            self._check_member(f"Union.shapes[{number}]", shape, valid)
        object.__setattr__(self, "shapes", tuple(self.shapes))
        check_resistance(self)

    def _check_member(self, name, shape, valid):
        if not (isinstance(shape, Shape) and may_join(type(shape))):
            raise ValueError(f"{name} = {shape!r}: {valid}")
        if shape.material != self.material or shape.resistance:
            raise ValueError(
                f"{name}: of {shape.material} and resistance {shape.resistance:g}; must be of Union.material, "
                f"{self.material}, and without a resistance, which is Union.resistance"
            )
        if np.any(np.isfinite(shape.bounds()[0]) != np.isfinite(self.shapes[0].bounds()[0])):
            raise ValueError(
                f"{name}: has no end along other axes than Union.shapes[0]; must go on along the same axes, or have a "
                "length"
            )

    @property
    def parts(self) -> tuple[Shape, ...]:
        """Its members; see `Shape.parts`."""
        return self.shapes

    @cached_property
    def center(self) -> tuple[float, float, float]:
        """The middle of its bounds, m; along axes without end that of its first member."""
        low, high = self.bounds()
        sides = zip(low.tolist(), high.tolist(), self.shapes[0].center, strict=True)
        return tuple(0.5 * (a + b) if math.isfinite(a) else own for a, b, own in sides)

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest coordinates along each axis, m; infinite where it goes on without end."""
        lows, highs = zip(*(shape.bounds() for shape in self.shapes), strict=True)
        return np.min(lows, axis=0), np.max(highs, axis=0)

    @cached_property
    def volume(self) -> float:
        """Volume, m3, by planes in small cells; infinite without ends."""
        return volume_by_cells(self, *self.bounds()) if self.bounded else math.inf

    def volume_in(self, size: Sequence[float], *, periodic: bool) -> float:
        """Volume of the part in a box, m3, without end by a thin slice across it; see `Shape.volume_in`."""
        low, high = self.bounds()
        along = np.flatnonzero(~np.isfinite(low))
        if not len(along):
            return super().volume_in(size, periodic=periodic)
        if len(along) > 1:
            raise NotImplementedError(f"no closed form for the volume of a {self.kind} without end across the axes")
        for shape in self.shapes:
            shape.volume_in(size, periodic=periodic)
        ends = np.isfinite(low)
        thick = SLICE * float((high - low)[ends].max())
        low, high = np.where(ends, low, 0.0), np.where(ends, high, thick)
        return volume_by_cells(self, low, high) / thick * size[int(along[0])]

    @property
    def width(self) -> float:
        """That of its narrowest member, m: the union is wider, or as narrow somewhere."""
        return min(shape.width for shape in self.shapes)

    def turned(self, order: Sequence[int]) -> Union:
        """The same union with axes order[0], order[1], order[2] as axes 0, 1, 2."""
        return self._moved(shapes=tuple(shape.turned(order) for shape in self.shapes))

    def placed(self, center: Sequence[float]) -> Union:
        """The same union with its centre elsewhere; see `Shape.placed`."""
        shift = np.subtract(center, self.center)
        if not np.any(shift):
            return self
        return self._moved(shapes=tuple(shape.placed((shape.center + shift).tolist()) for shape in self.shapes))

    def meets(self, size: Sequence[float]) -> bool:
        """Whether a member reaches into the box from 0 to a size; see `Shape.meets`."""
        return any(shape.meets(size) for shape in self.shapes)

    def point_in(self, size: Sequence[float], *, periodic: bool) -> np.ndarray:
        """A point of the box that lies in a member, (3,) float array, m; see `Shape.point_in`."""
        inside = self.shapes if periodic else [shape for shape in self.shapes if shape.meets(size)]
        return (inside or self.shapes)[0].point_in(size, periodic=periodic)

    def sure_distance(self, points: np.ndarray, *, period: np.ndarray | None = None) -> np.ndarray:
        """The least of the members', m: inside no deeper than it surely is; see `Shape.sure_distance`."""
        return np.min([shape.sure_distance(points, period=period) for shape in self.shapes], axis=0)

    def reach(self, direction: np.ndarray, size: Sequence[float] | None = None) -> float:
        """How far it reaches along a direction, m; see `Shape.reach`."""
        return max(shape.reach(direction, size) for shape in self.shapes)

    def check_fit(self, name: str, size: Sequence[float], *, periodic: bool) -> None:
        """Raise ValueError unless its members can lie in a box; see `Shape.check_fit`."""
        for shape in self.shapes:
            shape.check_fit(name, size, periodic=periodic)

    @cached_property
    def faces(self) -> list[Shape]:
        """Of all members: smooth surfaces, of parts of which the union's is made."""
        return [face for shape in self.shapes for face in shape.faces]

    @cached_property
    def _creases(self):
        """Pairs of faces, by their numbers, of members that are near each other."""
        owners = [number for number, shape in enumerate(self.shapes) for _ in shape.faces]
        balls = [shape.ball() for shape in self.shapes]
        near = [[not np.linalg.norm(a - b) > r + s for b, s in balls] for a, r in balls]
        pairs = combinations(range(len(owners)), 2)
        return [(i, j) for i, j in pairs if owners[i] != owners[j] and near[owners[i]][owners[j]]]

    @cached_property
    def _on(self):
        low, high = self.bounds()
        ends = np.isfinite(low)
        return ON * (float((high - low)[ends].max()) if ends.any() else self.width)

    def bare(self, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
        """Which points of the members' faces lie on the union's surface, (n,) bool array.

        Parameters
        ----------
        points : (n, 3) float array, m
        normals : (n, 3) float array
            Out of the faces.
        """
        away = self._nearness(points + self._on * normals)
        return (away > 0) & (away < 1.1 * self._on)

    def pattern(self, spacing: float, rng: np.random.Generator, room: Room) -> tuple[np.ndarray, np.ndarray]:
        """Points spread out on each face, so that half a spacing is left to its edges; see `Shape.pattern`."""
        samples, areas = sampled(self, room, spacing / SPREAD)
        own, found = self._faced(samples), [(np.empty((0, 3)), np.empty((0, 3)))]
        for number in np.unique(own):
            mine = own == number
            count = max(1, round(areas[mine].sum() / (np.sqrt(0.75) * spacing**2)))
            points, normals = spread(self.faces[number], samples[mine], areas[mine], count, rng)
            bare = self.bare(points, normals)
            found.append((points[bare], normals[bare]))
        return tuple(np.concatenate(column) for column in zip(*found, strict=True))

    def choice(self, least: float, widest: float, wanted: Callable, rng: np.random.Generator, room: Room):
        """Points to choose from, half the least spacing off edges and creases; see `Shape.choice`."""
        points, normals = closer(self, widest, wanted, rng, room)
        own, smooth = self._faced(points), np.ones(len(points), dtype=bool)
        for number, face in enumerate(self.faces):
            mine, outward = own == number, face.normal(points)
            cosine = np.einsum("ij,ij->i", normals, outward)
            smooth &= ~mine | (cosine > FLAT)
            smooth &= mine | (cosine > ALIKE) | (np.abs(face.distance(points)) > 0.5 * least)
        return points[smooth], normals[smooth]

    def facets(self, points: np.ndarray, normals: np.ndarray, room: Room) -> np.ndarray:
        """Each face for itself: across a crease planes are others; see `Shape.facets`."""
        samples, areas = sampled_between(self, points, room)
        own, there, moved = self._faced(points), self._faced(samples), points.copy()
        for number in np.unique(own):
            mine, near = own == number, there == number
            outward = self.faces[number].normal(samples[near])
            moved[mine] = lifted(points[mine], normals[mine], samples[near], outward, areas[near])
        return moved

    def cad(self, occ, box: np.ndarray, scale: float) -> int:
        """The members, fused by OpenCASCADE; see `Shape.cad`."""
        first, *rest = ((3, self._member_cad(shape, occ, box, scale)) for shape in self.shapes)
        pieces, _ = occ.fuse([first], rest)
        if len(pieces) != 1:
            raise NotImplementedError(
                f"a union of shapes at {self.center} is {len(pieces)} pieces: meshes know one; give each piece for "
                "itself"
            )
        return pieces[0][1]

    @staticmethod
    def _member_cad(shape, occ, box, scale):
        tag = shape.cad(occ, box, scale)
        if shape.fills_ball:
            # Its poles off the planes of symmetry.
            occ.rotate([(3, tag)], *(np.array(shape.center) / scale), *GENERIC)
        return tag

    def _faced(self, points):
        """The face that each point of the surface lies on, the first of those that go on in each other."""
        away = np.stack([np.abs(face.distance(points)) for face in self.faces])
        return np.argmax(away <= away.min(axis=0) + ON * self.width, axis=0)

    def _nearness(self, points):
        return np.min([shape.distance(points) for shape in self.shapes], axis=0)

    def _inside(self, offsets):
        return np.any([shape.contains(offsets + self.center) for shape in self.shapes], axis=0)

    def _surface(self, offsets):
        points = offsets + self.center
        distance, normal = self.shapes[0].surface(points)
        for shape in self.shapes[1:]:
            away, outward = shape.surface(points)
            nearer = away < distance
            distance, normal = np.where(nearer, away, distance), np.where(nearer[:, None], outward, normal)
        # Inside, where that foot lies in another member.
        hidden = np.flatnonzero(distance <= 0)
        feet = points[hidden] - distance[hidden, None] * normal[hidden]
        hidden = hidden[~self.bare(feet, normal[hidden])]
        if len(hidden):
            depth, outward = self._depth(points[hidden])
            found = np.isfinite(depth)
            distance[hidden[found]], normal[hidden[found]] = -depth[found], outward[found]
        return distance, normal

    def _depth(self, points):
        """Distance to the nearest point of the surface that is found, infinite without one, and the way there."""
        depth, way = np.full(len(points), np.inf), np.zeros((len(points), 3))
        away = np.empty((len(self.faces), len(points)))
        for face, distance in zip(self.faces, away, strict=True):
            distance[:], normal = face.surface(points)
            nearer = (distance <= 0) & (-distance < depth)
            nearer[nearer] = self.bare((points - distance[:, None] * normal)[nearer], normal[nearer])
            depth[nearer], way[nearer] = -distance[nearer], normal[nearer]
        for one, other in self._creases:
            # A crease is no nearer than either of its faces.
            near = np.flatnonzero(np.maximum(np.abs(away[one]), np.abs(away[other])) < depth)
            if len(near):
                step = crease(points[near], self.faces[one], self.faces[other]) - points[near]
                length = np.linalg.norm(step, axis=1)
                nearer = (length > self._on) & (length < depth[near])
                nearer[nearer] = np.abs(self._nearness((points[near] + step)[nearer])) < self._on
                depth[near[nearer]], way[near[nearer]] = length[nearer], step[nearer] / length[nearer, None]
        return depth, way


def may_join(kind: type[Shape]) -> bool:
    """Whether shapes of a type may be members of a union: convex ones that know their faces."""
    return kind.convex and kind.faces is not Shape.faces
