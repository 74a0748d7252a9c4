"""Any closed set that a function tells: inside where its values are below 0."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product

import numpy as np

from demheat.scene.beats import beat
from demheat.scene.inputs import flag, moderate, vector
from demheat.scene.material import Material, check_material
from demheat.scene.shapes.base import TOUCH, check_resistance
from demheat.scene.shapes.samples import CELLS, volume_by_cells
from demheat.scene.shapes.solid import Solid
from demheat.scene.shapes.traced import CELLS as FINEST
from demheat.scene.shapes.traced import Traced, leads, traced, unit

# Of the longest side of its limits: step of the differences that make its gradient, and the step to the surface after
# which the next one would be less than its square.
STEP, ON = 1e-5, 1e-6
# Steps to the surface; rounds of a step along it and back to it; longest step, of the longest side.
STEPS, ALONG, LONGEST = 12, 6, 0.25
# Sine of the angle to the normal from which on a nearer point is sought: its square is of the distance.
ASIDE = 1e-3
# Points along each side of a face that are looked at; how far opposite ones of a period may differ, of the largest.
LOOKED_AT, ALIKE = 25, 1e-6


@dataclass(frozen=True)
class LevelSet(Solid):
    """The points of a box at which a function is not above 0: of any form, in one piece or several.

    Exact: what lies inside, by the function's sign. Not exact: distances, which are those to a point of the surface
    that Newton's steps along the gradient find; beside a smooth surface it is the nearest one to second order of the
    distance, farther away it may be another. So pairs with other shapes are told apart by the limits alone, and the
    volume, by planes in small cells, is right to some 1e-4. Where such steps are seen to miss the surface, as of a
    sign, a mask, or a distance cut off, squared or cubed, changes of sign alone tell where that is, as finely as cells
    of 1/64 of the longest limit (`demheat.scene.shapes.traced`); what is rougher has no surface for who needs one.

    Parameters
    ----------
    function : callable (n, 3) float array, m -> (n,) float array
        Not above 0 inside; above 0 elsewhere, also on the limits and beyond. Best if it is smooth, with a gradient
        that leads to where it is 0.
    limits : pair of (3,) sequences of float, m
        Lowest and highest coordinates of a box that holds it.
    material : Material
    resistance : float, m2 K/W
        Of its surface towards whatever it lies in, as that of a `Sphere`.
    periodic : bool
        Whether `limits` are one period of the function, which is then asked within them alone: the set goes on in all
        directions without end, as a gyroid does. Sides of a periodic cell must be multiples of the period's.

    Examples
    --------
    >>> import numpy as np
    >>> from demheat import Material
    >>> from demheat.scene import LevelSet
    >>> ring = LevelSet(
    ...     lambda p: np.hypot(np.hypot(p[:, 0] - 0.5, p[:, 1] - 0.5) - 0.3, p[:, 2] - 0.5) - 0.1,
    ...     limits=((0.05, 0.05, 0.35), (0.95, 0.95, 0.65)),
    ...     material=Material(5.0),
    ... )
    >>> ring.contains(np.array([[0.5, 0.5, 0.5], [0.8, 0.5, 0.55]])).tolist()
    [False, True]
    >>> print(f"{ring.volume / (2 * np.pi**2 * 0.3 * 0.1**2):.3f}")
    1.000
    """

    function: Callable[[np.ndarray], np.ndarray]
    limits: tuple[tuple[float, float, float], tuple[float, float, float]]
    material: Material
    resistance: float = field(default=0.0, kw_only=True)
    periodic: bool = field(default=False, kw_only=True)

    finding = "function"
    kind = "level set"
    convex = False
    # Its own opposite side is not told: twins that would lie beyond it are none.
    depth = math.inf
    _made_from = None

    def __post_init__(self):
        if not callable(self.function):
            raise ValueError(f"LevelSet.function = {self.function!r}: must be a function of (n, 3) points")
        valid = "a pair of lowest and highest coordinates, three lengths each, in metres"
        if not isinstance(self.limits, Sequence | np.ndarray) or len(self.limits) != 2:
            raise ValueError(f"LevelSet.limits = {self.limits!r}: must be {valid}")
        low, high = (vector("LevelSet.limits", end) for end in self.limits)
        if not all(b > a and moderate(b - a) for a, b in zip(low, high, strict=True)):
            raise ValueError(f"LevelSet.limits = {self.limits!r}: must be {valid}, the highest above the lowest")
        object.__setattr__(self, "limits", (low, high))
        check_material("LevelSet.material", self.material)
        check_resistance(self)
        flag("LevelSet.periodic", self.periodic)
        self._check_function()

    @property
    def center(self) -> tuple[float, float, float]:
        """The middle of its limits, m."""
        return tuple(0.5 * (a + b) for a, b in zip(*self.limits, strict=True))

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Its limits, two (3,) float arrays, m; infinite if it is periodic."""
        return (np.full(3, -np.inf), np.full(3, np.inf)) if self.periodic else self._ends()

    def _ends(self):
        return np.array(self.limits[0]), np.array(self.limits[1])

    @property
    def volume(self) -> float:
        """Volume, m3: in cells that the surface cuts by the plane nearest to their middles, of two sizes."""
        return math.inf if self.periodic else self._volume

    @cached_property
    def _volume(self):
        """Of what lies in the limits."""
        if self.traceable:
            return volume_by_cells(self, *self._ends())
        return float(np.prod(np.subtract(*self.limits))) * -len(self._inner) / CELLS**3

    def volume_in(self, size: Sequence[float], *, periodic: bool) -> float:
        """Volume of the part in a box, m3; see `Shape.volume_in`."""
        if self.periodic and periodic:
            return self._volume * math.prod(size) / float(np.prod(np.subtract(*self.limits[::-1])))
        return super().volume_in(size, periodic=periodic)

    def check_fit(self, name: str, size: Sequence[float], *, periodic: bool) -> None:
        """Raise ValueError unless its period goes into a periodic cell; see `Shape.check_fit`."""
        times = np.array(size) / np.subtract(*self.limits[::-1])
        if self.periodic and periodic and np.any(np.abs(times - np.maximum(1, np.round(times))) > TOUCH * times):
            raise ValueError(
                f"{name}: a period of {np.subtract(*self.limits[::-1]).tolist()} m in a periodic cell of {size} m; "
                "sides of the cell must be multiples of the period's"
            )

    @property
    def traceable(self) -> bool:
        """Whether its surface can be found; see `Shape.traceable`."""
        return self._trace is not None

    @cached_property
    def _trace(self) -> Traced | bool | None:
        """Distances that were measured; True if the function's own values lead to its surface, None if nothing does."""
        if self._made_from is not None:
            shape, move = self._made_from
            return move(shape._trace) if isinstance(shape._trace, Traced) else shape._trace
        low, high = self._ends()
        period = high - low if self.periodic else None
        return leads(self._onto, self._holds, low, high, period) or traced(self._holds, low, high)

    def turned(self, order: Sequence[int]) -> LevelSet:
        """The same set with axes order[0], order[1], order[2] as axes 0, 1, 2."""
        order = list(order)
        if order == [0, 1, 2]:
            return self
        back, function = np.argsort(order), self.function
        limits = tuple(tuple(end[axis] for axis in order) for end in self.limits)
        made = self._moved(function=lambda points: function(points[:, back]), limits=limits)
        return made._with(self, lambda trace: trace.turned(order))

    def placed(self, center: Sequence[float]) -> LevelSet:
        """The same set with the middle of its limits elsewhere; see `Shape.placed`."""
        shift = np.subtract(center, self.center)
        if not np.any(shift):
            return self
        function = self.function
        limits = tuple(vector("LevelSet.limits", np.array(end) + shift) for end in self.limits)
        made = self._moved(function=lambda points: function(points - shift), limits=limits)
        return made._with(self, lambda trace: trace.placed(shift))

    def _with(self, shape, move):
        """Itself, made from another whose surface, once found, need only be moved."""
        object.__setattr__(self, "_made_from", (shape, move))
        return self

    def sure_distance(self, points: np.ndarray, *, period: np.ndarray | None = None) -> np.ndarray:
        """Distance to its limits, 0 within, m; see `Shape.sure_distance`."""
        if self.periodic:
            return np.zeros(len(points))
        low, high = self._ends()
        beyond = np.abs(self._home(points, period)) - 0.5 * (high - low)
        return np.linalg.norm(np.maximum(beyond, 0.0), axis=1)

    def meets(self, size: Sequence[float]) -> bool:
        """Whether its limits reach into the box from 0 to a size; see `Shape.meets`."""
        low, high = self.bounds()
        return bool(np.all((high > 0) & (low < size)))

    def point_in(self, size: Sequence[float], *, periodic: bool) -> np.ndarray:
        """A point of the box that lies inside, (3,) float array, m; see `Shape.point_in`."""
        points = self._held(np.zeros(3), np.array(size)) if self.periodic and not periodic else self._inner
        if periodic:
            return points[0] % np.array(size)
        inside = points[np.all((points > 0) & (points < size), axis=1)]
        return inside[0] if len(inside) else np.clip([*points, self.center][0], 0.0, size)

    @cached_property
    def _inner(self):
        """Points within, the one with the lowest value first, (m, 3) float array, m."""
        return self._held(*self._ends())

    def _held(self, low, high):
        """The same of a box."""
        ticks = (np.arange(CELLS) + 0.5) / CELLS
        found, values = [], []
        for x in ticks:
            points = low + np.array(list(product([x], ticks, ticks))) * (high - low)
            value = self._values(points)
            found.append(points[value < 0])
            values.append(value[value < 0])
        return np.concatenate(found)[np.argsort(np.concatenate(values), kind="stable")]

    def _check_function(self):
        """Refuse functions that are none of points, that are not above 0 on the limits, or nowhere below 0."""
        low, high = self._ends()
        ticks = np.linspace(0.0, 1.0, LOOKED_AT)
        for axis, end in product(range(3), (0.0, 1.0)):
            own = np.array(list(product(*([end] if a == axis else ticks for a in range(3)))))
            points = low + own * (high - low)
            values = self._asked(points)
            if self.periodic:
                self._check_period(axis, points, values)
            elif values.min() <= 0:
                at = tuple(points[np.argmin(values)].tolist())
                raise ValueError(
                    f"LevelSet.function: {values.min():.3g} at {at}, on the limits; must be above 0 there: the set "
                    "must end within them"
                )
        if not len(self._inner):
            raise ValueError(
                f"LevelSet.function: above 0 at all of {CELLS**3} points within limits {self.limits}; must be "
                "below 0 somewhere, or have narrower limits"
            )
        if len(self._inner) == CELLS**3:
            raise ValueError(f"LevelSet.function: nowhere above 0 within limits {self.limits}; must be somewhere")

    def _check_period(self, axis, points, values):
        other = points.copy()
        other[:, axis] = self.limits[0][axis] + self.limits[1][axis] - points[:, axis]
        off = np.abs(self._asked(other) - values)
        if off.max() > ALIKE * max(np.abs(values).max(), 1e-300):
            at = tuple(points[np.argmax(off)].tolist())
            raise ValueError(
                f"LevelSet.function: differs by {off.max():.3g} between {at} and the opposite limit; must be the same "
                "there, if it is periodic"
            )

    def _values(self, points):
        return self._asked(self._home_period(points))

    def _home_period(self, points):
        """Points moved by periods into the limits, if it is periodic."""
        low, high = self._ends()
        if not self.periodic:
            return points
        turns = np.floor((points - low) / (high - low))
        return points - turns * (high - low) if turns.any() else points

    def _asked(self, points):
        beat("a level set")
        values = np.asarray(self.function(points.copy()))
        if values.shape != (len(points),) or values.dtype.kind not in "biuf" or not np.all(np.isfinite(values)):
            raise ValueError(
                f"LevelSet.function: gave values of shape {values.shape} and type {values.dtype} for {len(points)} "
                "points, or some not finite; must give one finite number for each point"
            )
        return np.asarray(values, dtype=float)

    def _inside(self, offsets):
        if self.periodic:
            return self._values(offsets + self.center) <= 0
        inside = np.zeros(len(offsets), bool)
        within = np.flatnonzero(np.all(np.abs(offsets) <= 0.5 * np.subtract(self.limits[1], self.limits[0]), axis=1))
        if len(within):
            inside[within] = self._values(offsets[within] + self.center) <= 0
        return inside

    def _holds(self, points):
        return self._inside(points - np.array(self.center))

    def _gradient(self, points):
        """Central differences, (n, 3) float array, 1/m."""
        step = STEP * float(np.subtract(self.limits[1], self.limits[0]).max())
        moved = points[None] + step * np.concatenate([np.eye(3), -np.eye(3)])[:, None]
        values = self._values(moved.reshape(-1, 3)).reshape(6, -1)
        return (values[:3] - values[3:]).T / (2 * step)

    def _onto(self, points):
        """Newton's steps along the gradient to the surface."""
        longest = float(np.subtract(self.limits[1], self.limits[0]).max())
        points, going = points.copy(), np.arange(len(points))
        for _ in range(STEPS):
            if not len(going):
                break
            here = points[going]
            # Differences to one side: the way need not be exact, the place where it ends is.
            aside = STEP * longest
            moved = here[None] + aside * np.concatenate([np.zeros((1, 3)), np.eye(3)])[:, None]
            value, *ahead = self._values(moved.reshape(-1, 3)).reshape(4, -1)
            gradient = (np.stack(ahead, axis=1) - value[:, None]) / aside
            square = np.einsum("ij,ij->i", gradient, gradient)
            step = np.divide(-value, square, out=np.zeros(len(here)), where=square > 0)[:, None] * gradient
            length = np.linalg.norm(step, axis=1)
            step *= np.minimum(1.0, LONGEST * longest / np.maximum(length, 1e-300))[:, None]
            points[going] += step
            going = going[length > ON * longest]
        return points

    def _feet(self, offsets):
        """A near point of the surface for each, (n, 3) float array, m, and its outward normal."""
        points = offsets + self.center
        feet, going = self._onto(points), np.arange(len(points))
        normals = unit(self._gradient(feet))
        for _ in range(ALONG):
            aside = points[going] - feet[going]
            away = np.linalg.norm(aside, axis=1)
            aside -= np.einsum("ij,ij->i", aside, normals[going])[:, None] * normals[going]
            off = np.linalg.norm(aside, axis=1) > ASIDE * away
            going, aside, away = going[off], aside[off], away[off]
            nearer = self._onto(feet[going] + 0.5 * aside)
            better = np.linalg.norm(points[going] - nearer, axis=1) < away
            going = going[better]
            feet[going], normals[going] = nearer[better], unit(self._gradient(nearer[better]))
        return feet, normals

    def _surface(self, offsets):
        if self._trace is not True:
            return self._distance(offsets), self._normal(offsets)
        feet, normals = self._feet(offsets)
        away = np.linalg.norm(offsets + self.center - feet, axis=1)
        return np.where(self._inside(offsets), -away, away), normals

    def _distance(self, offsets):
        if self._trace is True:
            return self._surface(offsets)[0]
        away = np.abs(self._traced().distance(self._home_period(offsets + self.center)))
        return np.where(self._inside(offsets), -away, away)

    def _normal(self, offsets):
        return (
            self._surface(offsets)[1]
            if self._trace is True
            else self._traced().normal(self._home_period(offsets + self.center))
        )

    def _traced(self):
        if self._trace is None:
            raise NotImplementedError(
                f"LevelSet.function: its sign changes too often to find a surface in {FINEST} cells along the longest "
                "limit; must be smoother, or take what asks only for what lies inside: rule 'plain' of FFT, "
                "conforming=False of the DEM"
            )
        return self._trace
