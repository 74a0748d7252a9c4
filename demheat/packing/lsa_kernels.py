"""Event-driven motion of growing hard spheres, compiled: one event per sphere, the earliest found in a tree of minima.

Bookkeeping after Lubachevsky, J. Comput. Phys. 94 (1991) 255: every sphere keeps its one next event. A collision is
taken over by a sphere that can have it earlier; the partner left behind is looked at again when its event comes up.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

# What a sphere's next event is, where it is not a collision with another sphere (its number): to be predicted again, to
# leave the region its list of neighbours serves, to hit wall 0 to 5 (x-, x+, y-, ...) or the round wall.
AGAIN, LEAVE, WALL, ROUND = -1, -2, -3, -9
# Why the motion stopped.
LEFT, TIMED_OUT, COUNTED, STUCK, PAUSED = 0, 1, 2, 3, 4
# Events per collision asked for that can only mean that time stands still; a dense packing has 1.2, a thin gas between
# walls some tens.
TOO_MANY = 1000
# Children of a node of the tree: their times are one cache line.
FAN = 8
# Columns of a sphere: centre, velocity, the time at which it was there, and its radius at time 0. One cache line.
X, Y, Z, U, V, W, TIME, RADIUS = range(8)


class Bounds(NamedTuple):
    """Plain numbers that hold for a whole run: no arrays, whose counted references would cost more than the events."""

    # period, wall: tuples of three floats: Period of each axis, 0 if it has none; position of its upper flat wall (the
    # lower is at 0), 0 if it has none
    period: tuple
    wall: tuple
    middle: tuple  # tuple of three floats: Centre of the round wall
    across: tuple  # tuple of three floats: 1 for axes across which the round wall stands, else 0
    round: float  # Its radius, 0 if there is none
    grow: float  # Growth rate of the radii over the radii at time 0
    leash: float  # How far from home a sphere may go before the neighbours must be listed again
    last: float  # Time at which to stop


class Lists(NamedTuple):
    """Whom each sphere may meet before it leaves its region."""

    home: np.ndarray  # (n, 3) float array: Where each sphere was when its neighbours were listed
    indptr: np.ndarray  # (n + 1,) int64 array
    indices: np.ndarray  # (nnz,) uint32 array


class Events(NamedTuple):
    """The next event of every sphere."""

    times: np.ndarray  # (nodes,) float array: Tree of minima, leaves first: FAN children to a node
    levels: np.ndarray  # (depth + 1,) int array: Where each level of the tree begins
    # (n,) int32 array: Number of the sphere that will be met, or one of AGAIN, LEAVE, WALL and ROUND
    partner: np.ndarray


class Count(NamedTuple):
    """What has happened in a run: collisions between spheres, events, and the sum of impulse times distance."""

    collisions: int
    events: int
    virial: float


@njit(cache=True, error_model="numpy", inline="always")
def _set_time(events, i, time):
    """Give leaf i a time and mend the minima above it, as far up as they change."""
    times, levels = events.times, events.levels
    times[i] = time
    node = i
    for level in range(1, len(levels) - 1):
        node //= FAN
        first = levels[level - 1] + node * FAN
        least = min(
            min(min(times[first], times[first + 1]), min(times[first + 2], times[first + 3])),
            min(min(times[first + 4], times[first + 5]), min(times[first + 6], times[first + 7])),
        )
        here = levels[level] + node
        if times[here] == least:
            return
        times[here] = least


@njit(cache=True, error_model="numpy", inline="always")
def _earliest(events):
    """Leaf with the least time."""
    times, levels = events.times, events.levels
    node = 0
    for level in range(len(levels) - 2, 0, -1):
        least = times[levels[level] + node]
        first = levels[level - 1] + node * FAN
        child = 0
        while times[first + child] != least:
            child += 1
        node = node * FAN + child
    return node


@njit(cache=True, error_model="numpy", inline="always")
def _advance(spheres, i, now):
    """Move a sphere along its way to the time `now`."""
    step = now - spheres[i, TIME]
    spheres[i, X] += step * spheres[i, U]
    spheres[i, Y] += step * spheres[i, V]
    spheres[i, Z] += step * spheres[i, W]
    spheres[i, TIME] = now


@njit(cache=True, error_model="numpy", inline="always")
def _meeting(a, b, c):
    """First root >= 0 of a t^2 + 2 b t + c, the growing contact distance met from outside (c >= 0 but for rounding)."""
    if b < 0.0:
        if c <= 0.0:
            return 0.0
        square = b * b - a * c
        return c / (np.sqrt(square) - b) if square >= 0.0 else np.inf
    # Moving apart, but slower than the surfaces grow.
    return (b + np.sqrt(b * b - a * c)) / -a if a < 0.0 else np.inf


@njit(cache=True, error_model="numpy", inline="always")
def _parting(a, b, c):
    """First root >= 0 of a t^2 + 2 b t + c, a shrinking bound met from inside (c <= 0 but for rounding)."""
    square = b * b - a * c
    if square < 0.0:
        return np.inf
    if b > 0.0:
        return max(0.0, -c / (b + np.sqrt(square)))
    return (np.sqrt(square) - b) / a if a > 0.0 else np.inf


@njit(cache=True, error_model="numpy", inline="always")
def _walls(bounds, s, home, i, now):
    """First meeting with a wall or the edge of the sphere's region: time from now, and which."""
    a = b = c = 0.0
    for k in range(3):
        away = s[i, X + k] - home[i, k]
        v = s[i, U + k]
        a += v * v
        b += away * v
        c += away * away
    best, who = _parting(a, b, c - bounds.leash**2), LEAVE
    radius, swell = s[i, RADIUS] * (1.0 + bounds.grow * now), s[i, RADIUS] * bounds.grow
    a = b = c = 0.0
    for k in range(3):
        x, v = s[i, X + k], s[i, U + k]
        if bounds.wall[k] > 0.0:
            if v < swell:
                t = max(0.0, x - radius) / (swell - v)
                if t < best:
                    best, who = t, WALL - 2 * k
            if -v < swell:
                t = max(0.0, bounds.wall[k] - x - radius) / (swell + v)
                if t < best:
                    best, who = t, WALL - 2 * k - 1
        if bounds.across[k] > 0.0:
            x -= bounds.middle[k]
            a += v * v
            b += x * v
            c += x * x
    if bounds.round > 0.0:
        room = bounds.round - radius
        t = _parting(a - swell * swell, b + room * swell, c - room * room)
        if t < best:
            best, who = t, ROUND
    return best, who


@njit(cache=True, error_model="numpy", inline="always")
def _predict(bounds, s, lists, events, i, now):
    """Find the next event of sphere i, which stands at time `now`, and take its partner over from any other sphere.

    A collision that others have arranged with sphere i holds unless something comes earlier.
    """
    indptr, indices, times, partner = lists.indptr, lists.indices, events.times, events.partner
    bx, by, bz = bounds.period
    ix = 1.0 / bx if bx > 0.0 else 0.0
    iy = 1.0 / by if by > 0.0 else 0.0
    iz = 1.0 / bz if bz > 0.0 else 0.0
    grow = bounds.grow
    size = 1.0 + grow * now
    x, y, z, u, v, w, radius = s[i, X], s[i, Y], s[i, Z], s[i, U], s[i, V], s[i, W], s[i, RADIUS]
    wait, who = _walls(bounds, s, lists.home, i, now)
    best, held = now + wait, partner[i]
    if held >= 0 and times[i] <= best:
        best, who = times[i], np.int64(held)
    for t in range(np.uint64(indptr[i]), np.uint64(indptr[i + 1])):
        j = indices[t]
        lag = now - s[j, TIME]
        du, dv, dw = s[j, U] - u, s[j, V] - v, s[j, W] - w
        dx = s[j, X] + lag * s[j, U] - x
        dy = s[j, Y] + lag * s[j, V] - y
        dz = s[j, Z] + lag * s[j, W] - z
        dx -= bx * np.rint(dx * ix)
        dy -= by * np.rint(dy * iy)
        dz -= bz * np.rint(dz * iz)
        reach = radius + s[j, RADIUS]
        swell = reach * grow
        reach *= size
        a = du * du + dv * dv + dw * dw - swell * swell
        b = dx * du + dy * dv + dz * dw - reach * swell
        c = dx * dx + dy * dy + dz * dz - reach * reach
        # Too far to matter: no later than c / -2b is only what surfaces outrun by their growth can be.
        if a >= 0.0 and c >= -2.0 * b * (best - now):
            continue
        when = now + _meeting(a, b, c)
        if when < best and when < times[j]:
            best, who = when, np.int64(j)
    if who != held:
        if held >= 0:
            partner[held] = AGAIN
        partner[i] = who
        _set_time(events, i, best)
        if who >= 0:
            if partner[who] >= 0:
                partner[partner[who]] = AGAIN
            partner[who] = i
            _set_time(events, who, best)


@njit(cache=True, error_model="numpy", inline="always")
def _collide(bounds, s, i, j):
    """Elastic collision of two spheres of mass 1, seen from the growing surfaces; returns impulse times distance."""
    bx, by, bz = bounds.period
    dx, dy, dz = s[j, X] - s[i, X], s[j, Y] - s[i, Y], s[j, Z] - s[i, Z]
    dx -= bx * np.rint(dx / bx) if bx > 0.0 else 0.0
    dy -= by * np.rint(dy / by) if by > 0.0 else 0.0
    dz -= bz * np.rint(dz / bz) if bz > 0.0 else 0.0
    distance = np.sqrt(dx * dx + dy * dy + dz * dz)
    dx, dy, dz = dx / distance, dy / distance, dz / distance
    approach = dx * (s[j, U] - s[i, U]) + dy * (s[j, V] - s[i, V]) + dz * (s[j, W] - s[i, W])
    impulse = bounds.grow * (s[i, RADIUS] + s[j, RADIUS]) - approach
    s[i, U] -= impulse * dx
    s[i, V] -= impulse * dy
    s[i, W] -= impulse * dz
    s[j, U] += impulse * dx
    s[j, V] += impulse * dy
    s[j, W] += impulse * dz
    return impulse * distance


@njit(cache=True, error_model="numpy", inline="always")
def _bounce(bounds, s, i, who):
    """Elastic collision with a wall, seen from the growing surface."""
    swell = s[i, RADIUS] * bounds.grow
    if who == ROUND:
        square = normal = 0.0
        for k in range(3):
            x = (s[i, X + k] - bounds.middle[k]) * bounds.across[k]
            square += x * x
            normal += x * s[i, U + k]
        change = -2.0 * (normal / np.sqrt(square) + swell) / np.sqrt(square)
        for k in range(3):
            s[i, U + k] += change * (s[i, X + k] - bounds.middle[k]) * bounds.across[k]
    else:
        k, upper = (WALL - who) // 2, (WALL - who) % 2
        s[i, U + k] = -s[i, U + k] + (-2.0 * swell if upper else 2.0 * swell)


@njit(cache=True, error_model="numpy")
def start(bounds, spheres, lists, events):
    """Predict the first event of every sphere; all stand at time 0.

    bounds : Bounds
    spheres : (n, 8) float array; columns X to RADIUS. Lengths in mean radii, times in mean radii over the thermal
      velocity
    lists : Lists
    events : Events, out
    """
    events.partner[:] = AGAIN
    events.times[:] = np.inf
    for i in range(len(spheres)):
        _predict(bounds, spheres, lists, events, i, 0.0)


@njit(cache=True, error_model="numpy")
def run(bounds, spheres, lists, events, most, done, pause):
    """Work off events until a sphere leaves its region, the last time is reached or `most` collisions have happened.

    All spheres then stand at the same time. After a pause the same call with what was done goes on, to the same bits.

    bounds : Bounds
    spheres : (n, 8) float array, in and out; as in `start`
    lists : Lists
    events : Events, in and out
    most : int; collisions
    done : Count; before a pause; zeros at first
    pause : int; events after which to pause
    Returns:
    why : int; LEFT, TIMED_OUT, COUNTED, STUCK if events go on without end, or PAUSED
    now : float
    done : Count
    """
    times, partner = events.times, events.partner
    collisions, worked_off, virial = done
    until = worked_off + pause
    while True:
        i = _earliest(events)
        now = times[i]
        if now > bounds.last:
            now, why = bounds.last, TIMED_OUT
            break
        who = partner[i]
        if who == LEAVE:
            why = LEFT
            break
        if collisions >= most:
            why = COUNTED
            break
        if worked_off == until:
            return PAUSED, now, Count(collisions, worked_off, virial)
        worked_off += 1
        if worked_off > TOO_MANY * (most + len(spheres)):
            why = STUCK
            break
        _advance(spheres, i, now)
        met = np.int64(who)
        if met >= 0:
            _advance(spheres, met, now)
            virial += _collide(bounds, spheres, i, met)
            collisions += 1
            partner[met] = AGAIN
        elif met <= WALL:
            _bounce(bounds, spheres, i, met)
        partner[i] = AGAIN
        # While the first is predicted the second's time is still now: nothing can be arranged with it.
        for turn in range(2 if met >= 0 else 1):
            _predict(bounds, spheres, lists, events, met if turn else np.int64(i), now)
    for i in range(len(spheres)):
        _advance(spheres, i, now)
    return why, now, Count(collisions, worked_off, virial)
