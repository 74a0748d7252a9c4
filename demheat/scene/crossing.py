"""When moving sources meet a body."""

import math

import numpy as np

from demheat.scene.bodies import ROUND_AXES


def touching(source, size, domain):
    """First and last time at which the rim of a moving cylinder touches a body; None if never.

    The axis is then in the body's outline grown by the radius, which is convex, and made of rectangles and discs.
    """
    place, velocity, radius = source.position(0.0), np.array(source.velocity), source.diameter / 2
    sides = np.array(size)[[axis for axis in range(3) if axis != source.axis]]
    if ROUND_AXES[domain]:
        return _in_disc(place - sides / 2, velocity, sides[0] / 2 + radius)
    pieces = [_in_disc(place - sides * corner, velocity, radius) for corner in ((0, 0), (0, 1), (1, 0), (1, 1))]
    pieces += [_in_rectangle(place, velocity, -grown, sides + grown) for grown in radius * np.eye(2)]
    met = [piece for piece in pieces if piece]
    return (min(start for start, _ in met), max(stop for _, stop in met)) if met else None


def _in_disc(place, velocity, radius):
    """Times between which a moving point is within a disc around the origin, or None."""
    a, b, c = velocity @ velocity, velocity @ place, place @ place - radius**2
    if a == 0.0:
        return (-math.inf, math.inf) if c <= 0 else None
    # The reach of the line inside, from its distance to the origin: no digits are lost far away.
    along = radius**2 - (place[0] * velocity[1] - place[1] * velocity[0]) ** 2 / a
    if along < 0:
        return None
    half = math.sqrt(along / a)
    return -b / a - half, -b / a + half


def _in_rectangle(place, velocity, low, high):
    """Times between which a moving point is in a rectangle, or None."""
    start, stop = -math.inf, math.inf
    for x, v, a, b in zip(place, velocity, low, high, strict=True):
        if v == 0.0:
            if not a <= x <= b:
                return None
            continue
        first, last = sorted(((a - x) / v, (b - x) / v))
        start, stop = max(start, first), min(stop, last)
    return (start, stop) if start <= stop else None
