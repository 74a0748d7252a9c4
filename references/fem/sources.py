"""A moving cylinder of heat: points that travel with it share its power among the nodes, so none is lost or made.

Shape functions sum to one everywhere, so the heat of the nodes is that of the points, to rounding, at every time; and
as the points move, what a node gets changes without jumps.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from demheat.scene import MovingCylinder

# Of the box: a rim that touches the edge, as typed, is inside.
SLACK = 1e-9
# Points of the disc along its radius.
LEAST_RINGS, MOST_RINGS = 8, 128


class Deposit(NamedTuple):
    """What a source gives."""

    heat: np.ndarray  # (n,) float array, W: Into each node
    # power, lost: W: Inside of the body and outside
    power: float
    lost: float


def check_sources(scene, last):
    """Refuse sources that leave the body before a time, unless they are clipped."""
    for number, source in enumerate(scene.sources):
        if not isinstance(source, MovingCylinder):
            continue
        scene.require("a MovingCylinder heats boxes only here", domain="box", takes=("resistance", "exchange"))
        if source.clip:
            continue
        low, high = _room(scene, source)
        # A straight path between two places inside a rectangle stays inside.
        late = _leaves(source, low, high, last)
        if late is not None:
            place = tuple(source.position(late).tolist())
            raise ValueError(
                f"Scene.sources[{number}]: the cylinder leaves the body at {late:.6g} s, its axis at {place} m; must "
                f"stay inside until the last time, {last} s, or have clip = True"
            )


def _room(scene, source):
    """Lowest and highest place of the axis of a source inside."""
    across = np.array([scene.size[axis] for axis in range(3) if axis != source.axis])
    slack, radius = SLACK * across, source.diameter / 2
    return radius - slack, across - radius + slack


def _leaves(source, low, high, last):
    """First time, up to the last, at which the axis is outside of low..high, or None."""
    start, velocity = source.position(0.0), np.array(source.velocity)
    if np.any(start < low) or np.any(start > high):
        return 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        times = np.where(
            velocity > 0, (high - start) / velocity, np.where(velocity < 0, (low - start) / velocity, np.inf)
        )
    return float(times.min()) if times.min() < last else None


def deposit(scene, space, source, time) -> Deposit:
    """Heat of a source in each node."""
    radius, across = source.diameter / 2, [axis for axis in range(3) if axis != source.axis]
    sides = np.array(scene.size)[across]
    center = source.position(time)
    rings = int(np.clip(math.ceil(radius / space.spacing), LEAST_RINGS, MOST_RINGS))
    disc = center + radius * disc_points(rings)
    slack = SLACK * sides
    disc = np.clip(disc[np.all((disc >= -slack) & (disc <= sides + slack), axis=1)], 0, sides)
    per_area = source.power_density * scene.size[source.axis]
    whole = per_area * math.pi * radius**2
    power = per_area * overlap(center, radius, sides)
    if not len(disc):  # a sliver between the points counts as lost
        return Deposit(np.zeros(len(space.points)), 0.0, whole)
    planes = space.planes(source.axis)
    points = np.empty((len(disc), len(planes) - 1, 3))
    points[..., across] = disc[:, None]
    points[..., source.axis] = (planes[1:] + planes[:-1]) / 2
    amounts = np.tile(power / len(disc) * np.diff(planes) / scene.size[source.axis], len(disc))
    return Deposit(space.spread(points.reshape(-1, 3), amounts), power, whole - power)


@lru_cache(maxsize=4)
def disc_points(rings):
    """Points of equal weight in the unit disc, (3 rings^2, 2) float array; exact for polynomials of degree 2.

    Ring k, of width 1 / rings, has 3 (2 k + 1) points at the root mean square of its radii.
    """
    edges, points = np.arange(rings + 1) / rings, []
    for k in range(rings):
        count = 3 * (2 * k + 1)
        # Turned by the golden angle, rings do not line up.
        angle = 2.399963 * k + 2 * np.pi * np.arange(count) / count
        points.append(
            math.sqrt((edges[k] ** 2 + edges[k + 1] ** 2) / 2) * np.column_stack([np.cos(angle), np.sin(angle)])
        )
    return np.concatenate(points)


def overlap(center, radius, sides):
    """Area that a disc shares with a rectangle that begins at the origin."""
    (x0, y0), (x1, y1) = -np.asarray(center) / radius, (np.asarray(sides) - center) / radius
    return radius**2 * (_quadrant(x1, y1) - _quadrant(x0, y1) - _quadrant(x1, y0) + _quadrant(x0, y0))


def _quadrant(a, b):
    """Area of the part x <= a, y <= b of the unit disc."""
    a, b = min(max(a, -1.0), 1.0), min(max(b, -1.0), 1.0)
    left, below = (math.pi / 2 + u * math.sqrt(1 - u * u) + math.asin(u) for u in (a, b))
    if a * a + b * b < 1:
        return a * b + (left + below) / 2 - math.pi / 4
    if a <= 0 and b <= 0:
        return 0.0
    if a > 0 and b > 0:
        return left + below - math.pi
    return left if a <= 0 else below
