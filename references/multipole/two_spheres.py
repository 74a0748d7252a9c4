"""Two spheres by all degrees: what those above the order of the whole add to what the two make at each other.

About the line of the centres m stays what it is, so two spheres are a small system for each m. With z of either sphere
pointing to the other degree l of one makes (l+l')!/sqrt((l'-m)!(l'+m)!(l-m)!(l+m)!) a'^l' a^(l+1)/d^(l+l'+1) of degree
l' at the other: positive, and with the degree as smooth as what it acts on. So low degrees are unknowns one by one, and
higher ones polynomials in log l on octaves: spheres that touch take no more of them than those far apart.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.special import gammaln

from references.exact.lattice import polarisability

# Unknowns of an octave of degrees, and where octaves begin: so many times the order, and so many degrees more.
NODES, TIMES, MORE = 12, 2, 16
# Degrees end where multipoles of two spheres are exp(-ENOUGH) of what they were, or, as spheres conduct, at so many
# times what they conduct better than the matrix: beyond it the flux between them is even.
ENOUGH, EVEN = 25.0, 30.0
# From which degree on sums are integrals, which leaves 7e-8 of what is made, and points of an octave for each root of
# its first degree: what one degree makes is a bell that wide.
SMOOTH, BELL = 1024, 6.0
# Degrees that matter of order m end at the root of degree m of so many times the first octave.
LESS = 1e2


class Two(NamedTuple):
    """Two spheres, in any one unit of length; conductivities and resistances as in `translations.Spheres`."""

    apart: float  # Of the centres
    # radii, contrasts, resistances: two floats each
    radii: tuple[float, float]
    contrasts: tuple[float, float]
    resistances: tuple[float, float]


class Octave(NamedTuple):
    """Some degrees of one sphere: those that are unknowns, and those that are summed over."""

    nodes: np.ndarray  # (n,) float array
    points: np.ndarray  # (p,) float array
    onto: np.ndarray  # (p, n) float array: From values at nodes to values at points, times what each point stands for


def ends_of(two) -> list[float]:
    """Highest degrees that matter of each sphere."""
    square = [radius**2 for radius in two.radii]
    focus = max((two.apart**2 - sum(square)) ** 2 - 4 * square[0] * square[1], 0.0)
    focus = math.sqrt(focus) / (2 * two.apart)
    mean = 2 * two.radii[0] * two.radii[1] / sum(two.radii)
    ends = []
    for radius in two.radii:
        rate = math.asinh(focus / radius)
        ends.append(min(ENOUGH / rate if rate > 0 else math.inf, EVEN * max(*two.contrasts, 4.0) * radius / mean))
    return ends


@lru_cache(maxsize=512)
def octave(start) -> Octave:
    """Degrees from one to its double."""
    nodes = start * 2 ** ((1 - np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)) / 2)
    if start < SMOOTH:
        points, weight = np.arange(start, 2 * start, dtype=float), np.ones(start)
    else:
        points, weight = np.polynomial.legendre.leggauss(int(BELL * math.sqrt(start)))
        points, weight = 1.5 * start - 0.5 + 0.5 * start * points, 0.5 * start * weight
    return Octave(nodes, points, weight[:, None] * _interpolation(np.log(nodes), np.log(points)))


def degrees(m, first, end) -> list[Octave]:
    """Degrees m, ..., first - 1 one by one, then octaves up to an end at least."""
    low = np.arange(m, first, dtype=float)
    found, start = [Octave(low, low, np.eye(len(low)))], first
    # Near the line of the centres what has a large m is small, as (1/l)^m either way.
    end = min(end, first * LESS ** (1 / m)) if m else end
    while start < end:
        found.append(octave(start))
        start *= 2
    return found


def _interpolation(nodes, at):
    """Values of Lagrange's polynomials of Chebyshev's nodes, barycentric."""
    k = np.arange(len(nodes))
    weight = (-1.0) ** k * np.sin(np.pi * (k + 0.5) / len(nodes))
    apart = at[:, None] - nodes
    on = apart == 0
    share = weight / np.where(on, 1.0, apart)
    share = np.where(on.any(axis=1)[:, None], on, share)
    return share / share.sum(axis=1)[:, None]


def _made(to, of, m, receiver, sender):
    """What degrees of one sphere make of degrees of the other; radii over the distance of the centres."""
    to, of = to[:, None], of[None]
    root = 0.5 * (_factorials(to, m) + _factorials(of, m))
    return np.exp(gammaln(to + of + 1) - root + to * math.log(receiver) + (of + 1) * math.log(sender))


def _factorials(degree, m):
    return gammaln(degree - m + 1) + gammaln(degree + m + 1)


def direct(two: Two, few, m) -> np.ndarray:
    """What degrees of the second sphere make of degrees of the first."""
    return _made(few, few, m, *(radius / two.apart for radius in two.radii))


def exchanged(two: Two, order, m, reach) -> np.ndarray:
    """What two spheres make at the first of them, by all degrees, of their b up to an order, (n, 2 n) float array.

    Columns are degrees m, ..., order of the first sphere, then of the second. With b = -alpha e of all degrees that the
    two answer each other with, and r the rest of b, e = T (r - alpha e): what is made of r alone comes from elsewhere
    on the spheres and is known up to a reach, a part of the order; degrees above it are left out of T r.
    """
    count = order + 1 - m
    sets = [degrees(m, TIMES * order + MORE, end) for end in ends_of(two)]
    nodes = [np.concatenate([each.nodes for each in own]) for own in sets]
    x, n = [radius / two.apart for radius in two.radii], [len(each) for each in nodes]
    alpha = [polarisability(s, each, r) for s, r, each in zip(two.contrasts, two.resistances, nodes, strict=True)]
    rows = slice(0, n[0]), slice(n[0], sum(n))
    full, some = np.eye(sum(n)), np.zeros((sum(n), 2 * count))
    for i, j in ((0, 1), (1, 0)):
        summed = [_made(nodes[i], each.points, m, x[i], x[j]) @ each.onto for each in sets[j]]
        full[rows[i], rows[j]] = np.hstack(summed) * alpha[j]
        # Degrees up to the order are the first, one by one.
        some[rows[i], j * count : (j + 1) * count] = np.where(nodes[i][:, None] <= reach, summed[0][:, :count], 0.0)
    low = np.concatenate([np.arange(count), n[0] + np.arange(count)])
    answered = np.linalg.solve(full, some)[low]
    # r = b + alpha e.
    own = np.concatenate([each[:count] for each in alpha])
    return np.linalg.solve(np.eye(2 * count) - answered * own, answered)[:count]
