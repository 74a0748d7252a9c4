"""What shapes in unbounded space have in common: repeats in periodic cells, parts in boxes with walls."""

from collections.abc import Sequence
from dataclasses import fields
from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from demheat.scene.shapes.base import TOUCH, Shape

# Of projections onto a shape and a box in turn, until both hold a point.
ROUNDS = 200


class Solid(Shape):
    """A shape known by offsets from its `center`: it supplies `bounds`, and `_distance` and `_normal`, or `_surface`.

    Its bounds lie symmetrically about the centre; where they are infinite it goes on without end, and has no images.
    """

    overhangs = True

    def __init_subclass__(cls, **knobs):
        """Refuse a class that supplies neither."""
        super().__init_subclass__(**knobs)
        supplied = {name for name in ("_distance", "_normal", "_surface") if getattr(cls, name) != getattr(Solid, name)}
        if not supplied >= {"_distance", "_normal"} and "_surface" not in supplied:
            raise TypeError(f"class {cls.__name__}: must supply _distance and _normal, or _surface")

    def _distance(self, offsets: np.ndarray) -> np.ndarray:
        """Distance to the surface, negative inside, of (n, 3) offsets from the centre, m."""
        return self._surface(offsets)[0]

    def _normal(self, offsets: np.ndarray) -> np.ndarray:
        """Gradient of `_distance`, of length 1."""
        return self._surface(offsets)[1]

    def _surface(self, offsets):
        return self._distance(offsets), self._normal(offsets)

    def _inside(self, offsets):
        return self._distance(offsets) <= 0.0

    def contains(self, points: ArrayLike, *, period: np.ndarray | None = None) -> np.ndarray:
        """Which points lie inside or on the surface; see `Shape.contains`."""
        return self._inside(self._home(points, period))

    def distance(self, points: ArrayLike, *, period: np.ndarray | None = None) -> np.ndarray:
        """Distance of points to the surface of the nearest image, m, negative inside; see `Shape.distance`."""
        return self._nearest(points, period)[1]

    def normal(self, points: ArrayLike, *, period: np.ndarray | None = None) -> np.ndarray:
        """Outward normal of the nearest image where that is nearest; see `Shape.normal`."""
        return self._normal(self._nearest(points, period)[0])

    def surface(self, points: ArrayLike, *, period: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """`distance` and `normal` of points at once; see `Shape.surface`."""
        if period is None:
            return self._surface(points - np.array(self.center))
        offsets, distance = self._nearest(points, period)
        return distance, self._normal(offsets)

    def images(self, size: Sequence[float], *, periodic: bool) -> list[Shape]:
        """The shape as it meets a box; see `Shape.images`. None along an axis along which it has no end."""
        ends = np.isfinite(self.bounds()[0])
        if not periodic or ends.all():
            return super().images(size, periodic=periodic)
        center = np.array(self.center)
        half = self.bounds()[1] - center
        home, found = np.where(ends, center % size, center), []
        for shift in product(*((0, -1, 1) if end else (0,) for end in ends)):
            place = home + np.array(shift) * size
            if np.all(place + half > -TOUCH * np.array(size)) and np.all(place - half < (1 + TOUCH) * np.array(size)):
                image = self.placed(place.tolist())
                found += [image] if image.meets(size) else []
        return found

    def _moved(self, **values):
        """The same solid elsewhere: what was asked of this one when it was made is not asked of each image again."""
        made = object.__new__(type(self))
        for each in fields(self):
            object.__setattr__(made, each.name, values.get(each.name, getattr(self, each.name)))
        return made

    def meets(self, size: Sequence[float]) -> bool:
        """Whether it reaches into the box from 0 to a size; if no plane is found that parts them, it does."""
        if not super().meets(size):
            return False
        point, gap = self._towards(0.5 * np.array(size), size)
        if gap <= 0:
            return True
        outward = -self.normal(point[None])[0]
        return bool(-self.reach(-outward) < np.maximum(outward * size, 0.0).sum())

    def point_in(self, size: Sequence[float], *, periodic: bool) -> np.ndarray:
        """A point of the box that lies inside, (3,) float array, m; see `Shape.point_in`."""
        if periodic or np.all((np.array(self.center) > 0) & (np.array(self.center) < size)):
            return np.array(self.center) % size
        # Between points on all sides of the part in the box: not on its surface.
        starts = product(*((0.0, side) for side in size))
        return np.mean([self._towards(np.array(start), size)[0] for start in starts], axis=0)

    def _towards(self, point, size):
        """A point of the box that lies in the shape, or as near to it as was found, and its distance."""
        for _ in range(ROUNDS):
            gap = self.distance(point[None])[0]
            if gap <= 0:
                break
            point = np.clip(point - gap * (1 + 1e-9) * self.normal(point[None])[0], 0.0, size)
        return point, gap

    def _home(self, points, period):
        """Offsets from the centre of the image whose centre is nearest: of that which holds a point, if any does."""
        offsets = points - np.array(self.center)
        if period is None:
            return offsets
        ends = np.isfinite(self.bounds()[0])
        return offsets - np.where(ends, period * np.round(offsets / period), 0.0)

    def _nearest(self, points, period):
        """Offsets from the centre of the image that is nearest to each point, and distances to it.

        Along each axis the nearest image of a convex body that is no wider than the period is that with the nearest
        centre or one beside it: where the distance to the body, moved freely along the axis, is least, the foot lies
        within half a period of the centre.
        """
        offsets = self._home(points, period)
        distance = self._distance(offsets)
        if period is None:
            return offsets, distance
        home, half = offsets.copy(), self.bounds()[1] - np.array(self.center)
        for shift in product(*((0, -1, 1) if end else (0,) for end in np.isfinite(half))):
            moved = home + np.array(shift) * period
            # No nearer than the box of its bounds.
            near = np.linalg.norm(np.maximum(np.abs(moved) - half, 0.0), axis=1) < distance
            near = np.flatnonzero(near & (distance > 0) & any(shift))
            if not len(near):
                continue
            other = self._distance(moved[near])
            closer = other < distance[near]
            offsets[near[closer]], distance[near[closer]] = moved[near[closer]], other[closer]
        return offsets, distance
