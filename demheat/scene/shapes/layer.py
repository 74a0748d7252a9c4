"""A plane layer."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from demheat.scene.inputs import number, whole
from demheat.scene.material import Material, check_material
from demheat.scene.shapes.base import TOUCH, Shape, check_resistance


@dataclass(frozen=True)
class Layer(Shape):
    """A plane layer, start <= coordinate <= stop along one axis, across the whole box.

    Parameters
    ----------
    axis : {0, 1, 2}
    start, stop : float, m
    material : Material
    resistance : float, m2 K/W
        Of its surface towards whatever it lies in: the temperature jumps there by so many times the flux across it.
        0 is a perfect interface. Both faces have it; one on a wall is none.

    Examples
    --------
    >>> import numpy as np
    >>> from demheat import Layer, Material
    >>> Layer(0, 0.015, 0.255, Material(0.5)).contains(np.array([(0.1, 9.0, 9.0), (0.3, 9.0, 9.0)]))
    array([ True, False])
    """

    axis: int
    start: float
    stop: float
    material: Material
    resistance: float = field(default=0.0, kw_only=True)

    finding = "form"
    fills_bounds = True
    flat = True
    stored = {"axis": "axis", "start": "length", "stop": "length"}

    def __post_init__(self):
        object.__setattr__(self, "axis", whole("Layer.axis", self.axis, "0, 1 or 2", lambda v: 0 <= v <= 2))
        number(self, "start", "a finite number of metres")
        number(self, "stop", f"a finite number > start = {self.start}", lambda v: v > self.start)
        check_material("Layer.material", self.material)
        check_resistance(self)

    def contains(self, points: np.ndarray, *, period: np.ndarray | None = None) -> np.ndarray:
        """Which points lie inside or on a face; see `Shape.contains`."""
        x = points[:, self.axis]
        if period is not None:
            x = x % period[self.axis]
        return (x >= self.start) & (x <= self.stop)

    def distance(self, points: np.ndarray, *, period: np.ndarray | None = None) -> np.ndarray:
        """Distance of points to the nearer face, m, negative inside; see `Shape.distance`.

        A layer that fills the period has no face: the distance is then minus infinity.
        """
        if period is not None and self.stop - self.start >= (1 - TOUCH) * period[self.axis]:
            return np.full(len(points), -math.inf)
        x = self._middled(points, period)
        return np.maximum(self.start - x, x - self.stop)

    def normal(self, points: np.ndarray, *, period: np.ndarray | None = None) -> np.ndarray:
        """Outward normal of the nearer face; see `Shape.normal`."""
        normals = np.zeros((len(points), 3))
        above = self._middled(points, period) >= self._middle
        normals[:, self.axis] = np.where(above, 1.0, -1.0)
        return normals

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest coordinates along each axis, two (3,) float arrays, m; infinite along the layer."""
        low, high = np.full(3, -math.inf), np.full(3, math.inf)
        low[self.axis], high[self.axis] = self.start, self.stop
        return low, high

    @property
    def volume(self) -> float:
        """Infinite; see `volume_in`."""
        return math.inf

    def turned(self, order: Sequence[int]) -> Layer:
        """The same layer with axes order[0], order[1], order[2] as axes 0, 1, 2."""
        return replace(self, axis=list(order).index(self.axis))

    def images(self, size: Sequence[float], *, periodic: bool) -> list[Layer]:
        """The layer itself, which lies in the box; see `Shape.images`."""
        return [self]

    def point_in(self, size: Sequence[float], *, periodic: bool) -> np.ndarray:
        """A point of the box that lies inside, (3,) float array, m; see `Shape.point_in`."""
        point = 0.5 * np.array(size)
        point[self.axis] = self._middle
        return point

    def volume_in(self, size: Sequence[float], *, periodic: bool) -> float:
        """Volume of the part in a box, m3; see `Shape.volume_in`."""
        return (self.stop - self.start) * math.prod(size) / size[self.axis]

    def cad(self, occ, box: np.ndarray, scale: float) -> int:
        """A box of OpenCASCADE that ends with the scene's; see `Shape.cad`."""
        low, span = np.zeros(3), box.copy()
        start, stop = np.clip([self.start / scale, self.stop / scale], 0.0, box[self.axis])
        low[self.axis], span[self.axis] = start, stop - start
        return occ.addBox(*low, *span)

    def check_fit(self, name: str, size: Sequence[float], *, periodic: bool) -> None:
        """Raise ValueError unless it lies in a box; see `Shape.check_fit`."""
        length = size[self.axis]
        if self.start < -TOUCH * length or self.stop > length * (1 + TOUCH):
            raise ValueError(f"{name}: layer from {self.start} to {self.stop} must lie in the box, 0 to {length}")

    @property
    def _middle(self):
        return 0.5 * (self.start + self.stop)

    def _middled(self, points, period):
        """Coordinates along the normal, of the images nearest to the middle plane."""
        x = points[:, self.axis]
        if period is None:
            return x
        length = period[self.axis]
        return x - length * np.round((x - self._middle) / length)
