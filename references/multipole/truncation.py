"""How many degrees are enough: solutions of rising order, and what their last changes say of the rest."""

import math
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from demheat.runtime.progress import stage
from references.multipole import contacts
from references.multipole.arrangement import Arrangement, smallest_gap
from references.multipole.exchange import exchange
from references.multipole.fast import FastMultipole, plan
from references.multipole.nearest_images import beside
from references.multipole.sums import entries
from references.multipole.system import homogeneous, solve_order

FIRST_ORDER, HIGHEST_ORDER = 8, 40
# Periodic sums of all pairs are made for so many orders more than asked for at once.
AHEAD = 6
# What one product with the translations (in multiplications, some 1e9 a second) and their table (in bytes) may cost.
MOST_WORK, MOST_BYTES = 2e10, 3e9
# And by cells: seconds of one product; iterations whose vectors must fit into the memory.
MOST_SECONDS, ITERATIONS = 20.0, 50
# Of the accuracy asked for: error of b allowed where spheres exchange by cells, and residual of the linear system.
PRECISION, RESIDUAL = 0.1, 1e-3
# Of that error of b, the mean flux's: up to .035 was found, of 12 to 200 spheres of contrasts .01 to 1e6.
OF_FLUX = 0.1
# The same where an order is given, and no accuracy.
EXACT = 1e-10
# By default.
ACCURACY = 1e-5
# Bounds on the ratio of successive changes, of two degrees each, by which the rest is extrapolated.
RATIOS = (0.2, 0.95)
# What the rest is raised by: arrays of study `intervals`, even seeds, ask for .9.
SURE = 1.5
# The least ratio where pairs are solved by all degrees, of eight degrees each: in cubic order .07 to .2 were found.
STEADY = 0.3
# A sphere is small beside a larger one where its share of that one's radius is less than this over the degree.
SMALL = 2.0


def converged(arrangement: Arrangement, *, order, accuracy, tolerance, threads=1, kept=None):
    """Solutions of rising order, two degrees apart; the last is the answer."""
    spheres = arrangement.spheres
    highest = highest_order(spheres)
    rest = partial(_shown, near=beside(spheres))
    if order is not None and order > highest:
        raise ValueError(f"order = {order}: must be <= {highest} for {len(spheres.radii)} spheres in memory and time")
    exact, accuracy = order is not None and accuracy is None, ACCURACY if accuracy is None else accuracy
    if tolerance is None:
        tolerance = EXACT if exact else max(RESIDUAL * accuracy, 1e-14)
    precision = EXACT if exact else max(PRECISION * accuracy, 1e-13)
    wanted = FIRST_ORDER if order is None else order
    orders = [n for n in (wanted - 6, wanted - 4, wanted - 2, wanted) if n >= 1]
    history, table, reach = [homogeneous(spheres, arrangement.gradient)], None, 0
    with stage("multipoles") as done:
        while spheres.count:
            for n in orders:
                if n > reach:
                    reach = wanted if order is not None else min(n + AHEAD, highest)
                    table = _exchange(spheres, reach, precision, {} if kept is None else kept)
                    # Cells know no order.
                    reach = highest if isinstance(table, FastMultipole) else reach
                options = {"tolerance": tolerance, "guess": history[-1], "threads": threads}
                heard = _share(history, n, max(wanted, n), done)
                history.append(solve_order(spheres, table, arrangement.gradient, n, heard=heard, **options))
            if order is not None or rest(history).left <= accuracy:
                break
            if _hopeless(history, rest, accuracy, highest):
                knobs = {"accuracy": accuracy, "tolerance": tolerance, "threads": threads}
                return _in_contact(arrangement, history, rest, kept={} if kept is None else kept, **knobs)
            orders = [history[-1].order + 2]
            wanted = max(wanted + 2, _needed(history, rest, accuracy))
    return history


def _exchange(spheres, reach, precision, kept):
    """What spheres make at each other up to an order at least, made anew only if what was kept knows less."""
    if kept.get("reach", 0) < reach:
        kept |= {"reach": reach, "table": exchange(spheres, reach, precision)}
    return kept["table"]


def _share(history, order, last, done):
    """Tell what share is done from a solve's own, if the work goes with the cube of the order."""
    total = sum(n**3 for n in range(last, 0, -2))
    before = sum(solved.order**3 for solved in history)
    return lambda share: done(min(1.0, (before + share * order**3) / total))


def _hopeless(history, rest, accuracy, highest):
    now, needed = history[-1].order, _needed(history, rest, accuracy)
    # The prediction at low orders is rough: half as much again is allowed for.
    return now + 2 > highest or (now >= 10 and needed > 1.5 * highest)


def _in_contact(arrangement, plain, rest, *, accuracy, tolerance, threads, kept):
    """The same where pairs that nearly touch are solved by all degrees; raise if that is not enough."""
    spheres, highest = arrangement.spheres, contacts.highest_order(arrangement.spheres)
    history = plain[:1]
    for order in contacts.ORDERS:
        if order > highest:
            break
        if order not in kept:
            kept[order] = contacts.Contacts(spheres, order, PRECISION * accuracy)
        options = {"tolerance": tolerance, "guess": history[-1], "threads": threads, "received": kept[order].received}
        solved = solve_order(spheres, kept[order], arrangement.gradient, order, **options)
        history.append(solved._replace(pairs=len(kept[order].pairs.here)))
        if len(history) > 3 and rest(history).left <= accuracy:
            return history
    history = history if len(history) > 1 else plain
    raise RuntimeError(
        f"multipole: at order {history[-1].order} the mean flux is known to {rest(history).left:.1e}, as the smallest "
        f"gap is {smallest_gap(spheres) * arrangement.unit:.3g} m, and no higher order fits; must be {accuracy:.1e}, "
        "the accuracy: give a larger one, or order=... to accept less"
    )


def _needed(history, rest, accuracy):
    """The order that the accuracy asks for if changes go on as they do."""
    left, ratio = rest(history)
    return history[-1].order + 2 * math.ceil(math.log(accuracy / left) / math.log(ratio))


def _changes(history):
    """Relative changes of the mean flux, the last three at most, from order 0 on, that of the matrix alone."""
    flux = [solved.mean_flux for solved in history]
    scale = max(float(np.linalg.norm(flux[-1])), np.finfo(float).tiny)
    return [float(np.linalg.norm(b - a)) / scale for a, b in pairwise(flux)][-3:]


class Rest(NamedTuple):
    """Relative error that is left in the mean flux, and the ratio of successive changes that it goes by."""

    left: float
    ratio: float


def by_images(history, near) -> Rest:
    """What higher degrees are expected to remove, by `nearest_images` of the pairs that are `near`.

    Terms fall by no more than exp(-2 alpha) from degree to degree, from any of the last changes, as some degrees hardly
    matter in a symmetric array. A sphere that is small beside the waves of a degree on a larger one answers their
    slope, and so by the degree's square.
    """
    changes = _changes(history)
    if not changes:
        return Rest(0.0, RATIOS[0])
    order, by_pairs = history[-1].order, history[-1].pairs > 0
    least = _steady(near) if by_pairs else math.exp(-4 * near.slowest())
    ratio = min(max(_mean_ratio(changes), least), RATIOS[1])
    sum_of_rest = ratio / (1 - ratio)
    if not by_pairs:
        small = min(math.exp(-4 * near.slowest(below=SMALL / order)), RATIOS[1])
        sum_of_rest, ratio = max(sum_of_rest, _rising(small, order)), max(ratio, small)
    # That from the matrix alone tells nothing, unless there is no other.
    told = changes[::-1][: max(len(history) - 2, 1)]
    return Rest(SURE * max(change * ratio**back for back, change in enumerate(told)) * sum_of_rest, ratio)


def _steady(near):
    """The least ratio of pairs by all degrees: sources on a sphere, as known as its pairs know what comes to them."""
    return max(STEADY, float(np.max(near.reach, initial=0.0)) ** (8 * contacts.PART))


def _rising(ratio, order):
    """Sum of ((order + 2 j)/order)^2 ratio^j over all j from 1 on."""
    q, rest = ratio, 1 - ratio
    return q / rest + 4 / order * q / rest**2 + 4 / order**2 * q * (1 + q) / rest**3


def _shown(history, near):
    """Half of the interval: the same with how exactly the last was solved."""
    rest = by_images(history, near)
    return rest._replace(left=rest.left + inexactness(history[-1]))


def inexactness(solved) -> float:
    """Relative error of the mean flux by the residual of the linear system, and by exchange in cells."""
    return solved.residual + OF_FLUX * solved.precision


def _mean_ratio(changes):
    """Mean ratio of successive changes; a half where there is only one, or none to begin with."""
    return (changes[-1] / changes[0]) ** (1 / (len(changes) - 1)) if len(changes) > 1 and changes[0] else 0.5


def field_truncation(spheres, solved, gradient) -> float:
    """Largest term of the last two degrees in the flux at an interface, over the mean gradient."""
    n, _ = entries(solved.order)
    last = np.abs(n * solved.source / spheres.radii[:, None])[:, :, n >= max(1, solved.order - 1)]
    return float(last.max(initial=0.0) / (np.linalg.norm(gradient) or 1.0))


def highest_order(spheres) -> int:
    """Highest order that memory and time allow, between all pairs or by cells."""
    count, everything = spheres.count, max(len(spheres.radii), 1)
    pairs = count * everything - count * (count + 1) / 2
    work = (MOST_WORK / (4 * max(count, 1) * everything)) ** 0.25 - 1
    memory = math.sqrt(MOST_BYTES / (16 * (1 + pairs))) / math.sqrt(2) - 1
    highest = min(work, memory)
    if count:
        fits = int(math.sqrt(MOST_BYTES / (8 * ITERATIONS * count))) - 1
        rising = range(1, min(HIGHEST_ORDER, fits) + 1)
        by_cells = [order for order in rising if plan(spheres, order, EXACT).product <= MOST_SECONDS]
        highest = max(highest, *by_cells, 1)
    return max(1, min(HIGHEST_ORDER, int(highest)))
