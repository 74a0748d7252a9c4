"""Only here: collisions of hard spheres that kernels miss, beside a twin that looks at all after every event."""

from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat.packing import lsa_kernels as kernels
from demheat.packing.motion import tree
from demheat.scene.bodies import ROUND_AXES

# Between walls, and of a period: so long that a sphere never heads for another image than the nearest.
WALLED, PERIOD = 5.0, 12.0
GROW, FAR = 0.02, 100.0


def gas(periodic, domain="box", *, leash=FAR, last=np.inf, number=10, seed=0):
    """Spheres on the sites of a grid, at random velocities and towards the middle; all neighbours listed."""
    rng, flags = np.random.default_rng(seed), np.broadcast_to(periodic, 3)
    size, middle = np.where(flags, PERIOD, WALLED), np.where(flags, 0.0, WALLED / 2)  # across the period
    sites = np.array(list(product((-1.4, 0.0, 1.4), repeat=3)))
    sites = sites[np.linalg.norm(sites, axis=1) < 2.0]  # what lies well inside a ball
    spheres = np.zeros((number, 8))
    spheres[:, :3] = middle + rng.permutation(sites)[:number] + rng.uniform(-0.1, 0.1, (number, 3))
    spheres[:, kernels.U : kernels.W + 1] = rng.standard_normal((number, 3)) - 0.8 * (spheres[:, :3] - middle)
    spheres[:, :3] %= size
    spheres[:, kernels.RADIUS] = rng.uniform(0.3, 0.55, number)
    across = np.isin(range(3), ROUND_AXES[domain]).astype(float)
    period, wall = np.where(flags, PERIOD, 0.0), np.where(flags | (across > 0), 0.0, WALLED)
    vectors = (tuple(part.tolist()) for part in (period, wall, size / 2, across))
    bounds = kernels.Bounds(*vectors, WALLED / 2 if across.any() else 0.0, GROW, float(leash), float(last))
    others = np.nonzero(~np.eye(number, dtype=bool))[1].astype(np.uint32)
    rows = np.arange(0, number * number, number - 1)[: number + 1]
    lists = kernels.Lists(spheres[:, :3].copy(), rows, others)
    return bounds, spheres, lists, kernels.Events(*tree(number), np.empty(number, dtype=np.int32))


def falls(a, b, c):
    """First time >= 0 at which a t^2 + 2 b t + c, positive before, falls through 0."""
    roots = np.roots([a, 2 * b, c])
    real = roots.real[np.abs(roots.imag) < 1e-12]
    # Rounding may have let them touch already.
    return min((max(t, 0.0) for t in real if t > -1e-9 and a * t + b < 0), default=np.inf)


class SlowTwin:
    """Centres x, velocities v and radii r now; every event is found afresh."""

    def __init__(self, bounds, spheres, lists):
        self.bounds, self.home, self.now = bounds, lists.home, 0.0
        self.x, self.v, self.r = spheres[:, :3].copy(), spheres[:, 3:6].copy(), spheres[:, kernels.RADIUS].copy()
        self.period, self.wall, self.across = (np.array(part) for part in (bounds.period, bounds.wall, bounds.across))
        self.collisions = self.bounces = self.virial = 0

    def offset(self, i, j):
        d = self.x[j] - self.x[i]
        return d - np.where(self.period > 0, self.period * np.rint(d / PERIOD), 0.0)

    def events(self, i):
        """Time of every event that sphere i may have next, by what it is."""
        grow, size = self.bounds.grow, 1 + self.bounds.grow * self.now
        away, swell, v = self.x[i] - self.home[i], self.r[i] * grow, self.v[i]
        found = {kernels.LEAVE: falls(-v @ v, -away @ v, self.bounds.leash**2 - away @ away)}
        for j in set(range(len(self.x))) - {i}:
            d, u, reach = self.offset(i, j), self.v[j] - v, self.r[i] + self.r[j]
            b, c = d @ u - reach**2 * grow * size, d @ d - (reach * size) ** 2
            found[j] = falls(u @ u - (reach * grow) ** 2, b, c)
        for k in np.flatnonzero(self.wall):
            found[kernels.WALL - 2 * k] = falls(0.0, (v[k] - swell) / 2, self.x[i, k] - self.r[i] * size)
            room = self.wall[k] - self.x[i, k] - self.r[i] * size
            found[kernels.WALL - 2 * k - 1] = falls(0.0, (-v[k] - swell) / 2, room)
        if self.bounds.round:
            off, w = (self.x[i] - self.bounds.middle) * self.across, v * self.across
            room = self.bounds.round - self.r[i] * size
            found[kernels.ROUND] = falls(swell**2 - w @ w, -room * swell - off @ w, room**2 - off @ off)
        return {who: self.now + wait for who, wait in found.items()}

    def follow(self, until):
        """Go on to a time, or until a sphere leaves its region; returns why."""
        while True:
            first = ((t, i, who) for i in range(len(self.x)) for who, t in self.events(i).items())
            time, i, who = min(first, key=lambda event: event[0])
            why = kernels.TIMED_OUT if time > until else kernels.LEFT if who == kernels.LEAVE else None
            self.x += (min(time, until) - self.now) * self.v
            self.now = min(time, until)
            if why is not None:
                return why
            self.meet(i, who)

    def meet(self, i, who):
        """Reflect at the normal, seen from the growing surface."""
        grow = self.bounds.grow
        if who >= 0:
            d = self.offset(i, who)
            distance = np.linalg.norm(d)
            push = grow * (self.r[i] + self.r[who]) - d @ (self.v[who] - self.v[i]) / distance
            self.v[i], self.v[who] = self.v[i] - push * d / distance, self.v[who] + push * d / distance
            self.collisions, self.virial = self.collisions + 1, self.virial + push * distance
            return
        if who == kernels.ROUND:
            normal = (self.x[i] - self.bounds.middle) * self.across
            normal /= np.linalg.norm(normal)
        else:
            axis, upper = divmod(kernels.WALL - who, 2)
            normal = np.eye(3)[axis] * (1 if upper else -1)
        self.bounces += 1
        self.v[i] -= 2 * (normal @ self.v[i] + self.r[i] * grow) * normal


KINDS = [
    (True, "box"),
    ((True, False, False), "box"),
    ((False, True, False), "cylinder-y"),
    (False, "cylinder-x"),
    (False, "sphere"),
]


@pytest.mark.twin
@pytest.mark.parametrize(("periodic", "domain"), KINDS)
@pytest.mark.parametrize("leash", [FAR, 0.3])
def test_start(periodic, domain, leash):
    bounds, spheres, lists, events = state = gas(periodic, domain, leash=leash)
    kernels.start(*state)
    slow = SlowTwin(bounds, spheres, lists)
    times, partner = events.times[: len(spheres)], events.partner
    found = [slow.events(i) for i in range(len(spheres))]
    for i, due in enumerate(found):
        # Nothing can come before a sphere is looked at; it may have lost an earlier collision to another one.
        assert times[i] >= min(due.values()) - 1e-12
        if partner[i] != kernels.AGAIN:
            assert_allclose(times[i], due[partner[i]], rtol=1e-9)  # rounding, amplified in grazing roots
        if partner[i] >= 0:
            assert partner[partner[i]] == i and times[partner[i]] == times[i]
    first = int(np.argmin(times))
    assert_allclose(times[first], min(min(due.values()) for due in found), rtol=1e-9)
    assert partner[first] != kernels.AGAIN and np.any(partner >= 0 if leash == FAR else partner == kernels.LEAVE)


def in_pieces(state, most, pause=10**6):
    """A run, however often it pauses."""
    why, done = kernels.PAUSED, kernels.Count(0, 0, 0.0)
    while why == kernels.PAUSED:
        why, now, done = kernels.run(*state, most, done, pause)
    return why, now, done


@pytest.mark.twin
def test_pauses_change_no_bit():
    found = []
    for pause in (10**6, 3):
        state = gas(True, last=2.0, number=12, seed=1)
        kernels.start(*state)
        found.append((in_pieces(state, 10**6, pause), state[1].tobytes()))
    assert found[0] == found[1] and found[0][0][2].events > 9


@pytest.mark.twin
@pytest.mark.parametrize(("periodic", "domain"), KINDS)
def test_run(periodic, domain):
    bounds, spheres, lists, events = state = gas(periodic, domain, last=2.0, number=12, seed=1)
    slow = SlowTwin(bounds, spheres, lists)
    kernels.start(*state)
    why, now, (collisions, worked_off, virial) = in_pieces(state, 10**6)
    assert (why, now) == (kernels.TIMED_OUT, 2.0) == (slow.follow(2.0), slow.now)
    assert collisions == slow.collisions > 5 and worked_off >= collisions + slow.bounces
    assert (slow.bounces > 0) == (periodic is not True)
    # Rounding, multiplied by about 10 in every collision of a sphere, of which each has two to four.
    assert_allclose(spheres[:, :3], slow.x, atol=1e-8)
    assert_allclose(spheres[:, 3:6], slow.v, atol=1e-8)
    assert_allclose(virial, slow.virial, rtol=1e-8)


@pytest.mark.twin
def test_run_stops():
    """When a sphere leaves its region, and after so many collisions."""
    bounds, spheres, lists, events = state = gas(True, leash=0.4, last=10.0)
    slow = SlowTwin(bounds, spheres, lists)
    kernels.start(*state)
    why, now, _ = in_pieces(state, 10**6)
    assert why == kernels.LEFT == slow.follow(10.0)
    assert_allclose(now, slow.now, rtol=1e-10)
    assert_allclose(np.linalg.norm(spheres[:, :3] - lists.home, axis=1).max(), 0.4, rtol=1e-10)
    bounds, spheres, lists, events = state = gas(True, last=10.0)
    slow = SlowTwin(bounds, spheres, lists)
    kernels.start(*state)
    why, now, (collisions, *_) = in_pieces(state, 3)
    assert (why, collisions) == (kernels.COUNTED, 3) and slow.follow(now) == kernels.TIMED_OUT
    assert slow.collisions == 3
    assert_allclose(spheres[:, :3], slow.x, atol=1e-11)


def first_root(a, b, c):
    roots = np.roots([a, 2 * b, c])
    real = roots.real[np.abs(roots.imag) < 1e-12]
    return min(real[real >= 0], default=np.inf)


def test_meeting_and_parting_are_first_roots():
    """A contact distance met from outside, also where it only grows faster than the spheres part; and from inside."""
    rng = np.random.default_rng(0)
    kinds = set()
    for a, b, c in np.column_stack((rng.uniform(-1, 1, (500, 2)), rng.uniform(0.01, 1, 500))):
        meets, parts = first_root(a, b, c), first_root(a, b, -c)
        # Rounding, amplified where two roots nearly coincide.
        assert_allclose(kernels._meeting(a, b, c), meets, rtol=1e-6)
        assert_allclose(kernels._parting(a, b, -c), parts, rtol=1e-6)
        kinds |= {(a > 0, b > 0, np.isfinite(meets), np.isfinite(parts))}
    assert {(False, True, True, False), (False, True, True, True), (True, True, False, True)} <= kinds
    # Rounding has let them overlap: at once if they approach, never if they part.
    assert kernels._meeting(1.0, -0.5, -1e-17) == 0.0 and kernels._meeting(1.0, 0.5, -1e-17) == np.inf


@pytest.mark.parametrize("n", [2, 9, 600])
def test_the_tree_finds_the_earliest(n):
    rng = np.random.default_rng(n)
    events = kernels.Events(*tree(n), np.empty(n, dtype=np.int32))
    mirror = np.full(n, np.inf)
    for turn in range(400):
        i = int(rng.integers(n))
        # Ties, later and earlier times.
        mirror[i] = rng.choice([rng.random(), 0.5, np.inf if turn < 300 else 2.0])
        kernels._set_time(events, i, mirror[i])
        if np.isfinite(mirror.min()):
            assert mirror[kernels._earliest(events)] == mirror.min()
