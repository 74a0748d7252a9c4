"""Steps of walkers: leaps to a sphere around them, and at a surface the choice of a side.

The walkers' density relaxes as a temperature does where c dT/dt = div(k grad T); as the mean square of their way does
not depend on c, it is the least of the conductivity and the matrix's over the latter: then neither good conductors nor
poor ones hold walkers for long.

Beside its own way each walker adds up two others that have no drift, for `references.walkers.sums`: the leaps alone,
and the leaps divided by the conductivity where they are made.
"""

from typing import NamedTuple

import numpy as np

from demheat.scene.volumes import known_fractions

# Of the radius of the balls in which sides are chosen: within which a surface is near, and within which it is reached.
NEAR, ON = 0.25, 1e-9
# Balls are at most so large a part of the way to the next surface, but not less than this part of their radius.
CLEAR, LEAST = 0.5, 0.02
# Columns of what a walker adds up: place, the leaps, the leaps over conductivities, clock, mean squares of the leaps;
# then for each direction mean products of both, and mean squares of the latter.
PLACE, LEAPS, RESISTED, CLOCK, SQUARE = slice(0, 3), slice(3, 6), slice(6, 9), 9, 10
FIRST = 11


class Medium(NamedTuple):
    """What walkers walk through, by phase number, and how they are watched."""

    conductivity: np.ndarray  # (phases,) float array, of that of `unit`
    capacity: np.ndarray  # (phases,) float array
    mean_capacity: float
    unit: float  # W/(m K)
    radius: float  # m: Of the balls on surfaces
    directions: np.ndarray  # (d, 3) float array, of length 1

    @property
    def columns(self) -> tuple[slice, slice]:
        """Columns of the mean products and of the mean squares."""
        d = len(self.directions)
        return slice(FIRST, FIRST + d), slice(FIRST + d, FIRST + 2 * d)


def medium(scene, radius: float, directions: np.ndarray) -> Medium:
    """The medium of a scene whose conductivities are not all 0."""
    k = scene.conductivities
    unit = float(k[0] if k[0] > 0 else k.max())
    capacity = np.minimum(k / unit, 1.0)
    return Medium(k / unit, capacity, float(known_fractions(scene) @ capacity), unit, radius, directions)


def start(surfaces, medium: Medium, count: int, rng) -> tuple[np.ndarray, np.ndarray]:
    """Places and phases of walkers as they are spread in equilibrium, (count, 3) and (count,) arrays."""
    found, phases, most = [], [], medium.capacity.max()
    while sum(map(len, found)) < count:
        points = rng.random((count, 3)) * surfaces.size
        phase = surfaces.phase(points)
        kept = rng.random(count) * most < medium.capacity[phase]
        found.append(points[kept])
        phases.append(phase[kept])
    return np.concatenate(found)[:count], np.concatenate(phases)[:count]


def advance(surfaces, medium: Medium, place: np.ndarray, phase: np.ndarray, rng) -> np.ndarray:
    """One step of all walkers: what it adds to their columns; their phases are changed where they are."""
    number, away, next_away = surfaces.nearest(place)
    radius = np.clip(CLEAR * next_away, LEAST * medium.radius, medium.radius)
    near = np.flatnonzero(away <= NEAR * radius)
    added = _leaps(medium, away, phase, _directions(rng, len(place)))
    if len(near):
        moved, own = _near(surfaces, medium, (place[near], phase[near], number[near], radius[near]), rng)
        added[near], phase[near] = moved, own
    return added


def _directions(rng, count):
    """Random directions, (count, 3) float array."""
    height, angle = rng.uniform(-1.0, 1.0, count), rng.uniform(0.0, 2 * np.pi, count)
    flat = np.sqrt(1.0 - height * height)
    return np.stack([flat * np.cos(angle), flat * np.sin(angle), height], axis=1)


def _leaps(medium, length, phase, directions):
    """Leaps within a phase."""
    step, square = length[:, None] * directions, length * length / 3
    return _within(medium, step, square, phase)


def _within(medium, step, square, phase):
    """Columns of steps within a phase, of a mean square along any axis: the clock shows half of that over c/k."""
    k = medium.conductivity[phase]
    added = np.empty((len(step), FIRST + 2 * len(medium.directions)))
    added[:, PLACE] = added[:, LEAPS] = step
    added[:, RESISTED] = step / k[:, None]
    added[:, CLOCK] = square / 2 * medium.capacity[phase] / k
    added[:, SQUARE] = square
    both, own = medium.columns
    added[:, both] = (square / k)[:, None]
    added[:, own] = (square / k**2)[:, None]
    return added


def _near(surfaces, medium, walkers, rng):
    """Steps of walkers beside a surface: as far away from it again, or onto it, where they choose a side.

    Along the surface they go by what keeps the mean square alike along all axes; the chances are those with which the
    mean place is where they are, however the surface bends.
    """
    place, phase, number, radius = walkers
    distance, normal = surfaces.side(place, number)
    side, gap = np.where(distance < 0, -1.0, 1.0)[:, None], np.abs(distance)
    outward, count = side * normal, len(place)
    along = _directions(rng, count)
    along -= np.einsum("ij,ij->i", along, outward)[:, None] * outward
    along *= np.sqrt(2.0) * (gap / np.linalg.norm(along, axis=1))[:, None]
    foot = place - gap[:, None] * outward + along
    off, normal = surfaces.side(foot, number)
    foot -= off[:, None] * normal
    bent = np.maximum(side[:, 0] * off, -0.9 * gap)
    leave = (rng.random(count) * (2 * gap + bent) < gap + bent) & (gap > ON * radius)
    step = np.where(leave[:, None], gap[:, None] * outward + along, foot - place)
    there = phase.copy()
    there[leave] = surfaces.phase(place[leave] + step[leave])
    # By a slope that is a little off one would leave into a pore.
    leave &= medium.conductivity[there] > 0
    step[~leave] = (foot - place)[~leave]
    added, phase = _within(medium, step, gap * gap, phase), np.where(leave, there, phase)
    on = ~leave
    added[on] += _chosen(surfaces, medium, (foot[on], normal[on], radius[on]), phase, np.flatnonzero(on), rng)
    return added, phase


def _chosen(surfaces, medium, balls, phase, walkers, rng):
    """Attempts to leave a surface for a point of a ball on it, taken as often as it conducts there.

    So the walker goes to both sides by their conductivities times their areas of the ball, as Kim and Torquato have it
    for whatever surface is in the ball. Where it does not, it waits on the surface for the next
    attempt. Leaps without drift count all attempts, as many as make the step's mean product with a leap right.
    """
    foot, normal, radius = balls
    direction = _directions(rng, len(foot))
    leap, half = radius[:, None] * direction, 0.5 * radius[:, None] * normal
    # On either side; where the leap goes; and where, at the mean, the ball holds a walker until then.
    offsets = np.stack([-half, half, leap, rng.beta(2.0, 2.0, len(foot))[:, None] * leap])
    inner, outer, there, inside = surfaces.phase((foot + offsets).reshape(-1, 3)).reshape(4, -1)
    sides = medium.conductivity[np.stack([inner, outer])]
    most = np.maximum(sides.max(axis=0), np.finfo(float).tiny)
    taken = rng.random(len(foot)) * most < medium.conductivity[there]
    phase[walkers[taken]] = there[taken]
    square = radius * radius / 3
    across, along = _resisted(sides)
    added = np.zeros((len(foot), FIRST + 2 * len(medium.directions)))
    added[:, PLACE] = taken[:, None] * leap
    added[:, LEAPS] = leap
    steep = np.einsum("ij,ij->i", direction, normal)
    added[:, RESISTED] = along[:, None] * leap + ((across - along) * steep * radius)[:, None] * normal
    added[:, CLOCK] = square / 2 * medium.capacity[inside] / most
    added[:, SQUARE] = square
    slopes = (normal @ medium.directions.T) ** 2
    for column, power in zip(medium.columns, (1, 2), strict=True):
        added[:, column] = square[:, None] * (
            along[:, None] ** power * (1 - slopes) + across[:, None] ** power * slopes
        )
    return added


def _resisted(sides):
    """What stands for one over the conductivity, across a surface and along it; 0 where a side does not conduct."""
    with np.errstate(divide="ignore", invalid="ignore"):
        across, along = 0.5 * (1 / sides).sum(axis=0), 2 / sides.sum(axis=0)
    open_ = (sides > 0).all(axis=0)
    return np.where(open_, across, 0.0), np.where(open_, along, 0.0)
