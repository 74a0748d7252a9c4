"""What a method's answers close in on as its elements get smaller: Richardson's limit, with an interval of its own.

Richardson, Phil. Trans. R. Soc. A 210 (1911) 307; the order from three sizes as in Roache, J. Fluids Eng. 116 (1994)
405. Two coarser runs of the same scene show how errors fall. Where they fall by one power, that of the method, what the
last change leaves is taken off; where sizes must show the power themselves, and do not, nothing is. The interval counts
on a slower fall, as `demheat.error` does. Orders and safeties were found on drawn scenes (study `intervals`, even
seeds), and are judged on others.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from demheat.error import NOTHING, ROUNDING, conductivity_of, largest, misplaced, missing, quietly, unshown
from demheat.scene.edges import SMOOTH, edge_order
from demheat.scene.volumes import known_fractions


class Extrapolated(NamedTuple):
    """What a conductivity closes in on.

    Attributes
    ----------
    how : str
        Of what it is made.
    conductivity : float, W/(m K)
        NaN where the scene has none.
    lower, upper : float, W/(m K)
        Between which it is expected.
    mean_flux : (3,) float array, W/m2
    flux : float, W/m2
        By how much any component of it is expected to be off at most.
    order : float
        Of the size of elements, with which errors were taken to fall; infinite where nothing was taken off.
    runs : tuple of float, W/(m K)
        Conductivities that it was made of, the field's own first.

    Examples
    --------
    >>> from demheat import gallery
    >>> from references import fft
    >>> limit = fft.solve(gallery.sphere_in_cube(5.0), voxels=32).extrapolated
    >>> limit.lower < 42.6403 < limit.upper, len(limit.runs)
    (True, 3)
    """

    how: str
    conductivity: float
    lower: float
    upper: float
    mean_flux: np.ndarray
    flux: float
    order: float
    runs: tuple[float, ...]


class Limit(NamedTuple):
    """How a method's answers close in, by two runs, each with elements so many times as long as the one before."""

    how: str  # What is made coarser
    ratio: float
    order: float  # With which errors fall
    slow: float  # With which they fall at least, for the interval
    safety: float
    # With which errors fall in the end, beyond sizes that do not show it: the interval reaches to what that leaves, and
    # counts on it where changes fall no faster
    last: float = math.inf
    # Three sizes must show an order between these, which is then taken, but between `slow` and `order`; empty where the
    # method's own is right on nearly all scenes
    shown: tuple[float, ...] = ()


def by_extrapolation(field, coarser: Callable, rule: Limit, *, residual=0.0, fine=NOTHING) -> Extrapolated:
    """The limit of a method by coarser runs; `coarser(level)` makes the first and the second, each of one kind or more.

    Of a size there may be several runs, as two may be close to each other by luck: the first tells the limit, the
    largest change the interval. Warnings of runs whose elements are too large for what the finest resolves are kept
    back.
    """
    _check(field, fine)
    sizes = [[field], *_coarser(coarser)]
    runs = [first for first, *_ in sizes]
    k, flux = [conductivity_of(each) for each in runs], [each.mean_flux for each in runs]
    order = _order(k if math.isfinite(k[0]) else [_along(each, field) for each in flux], rule)
    limit, mean_flux = _limit(k, rule.ratio, order), _limit(flux, rule.ratio, order)
    residual += ROUNDING
    half = _lacks(sizes, conductivity_of, rule, order) + residual * abs(k[0])
    made = abs(k[0] - float(field.scene.mean_conductivities[0]))
    half += (unshown([misplaced(each) for each in runs], rule.ratio, rule.slow) + fine.rough) * made
    half = max(half, fine.least * made)
    off = _lacks(sizes, lambda each: each.mean_flux, rule, order) + residual * float(np.linalg.norm(flux[0]))
    if k[0]:
        off = max(off, half / abs(k[0]) * float(np.linalg.norm(flux[0])))
    return Extrapolated(rule.how, limit, max(limit - half, 0.0), limit + half, mean_flux, off, order, tuple(k))


def _check(field, fine):
    """Refuse what coarser runs do not tell of, or where errors cancel or fall by other powers."""
    scene = field.scene
    unseen = list(fine.unseen)
    if scene.inclusions:
        unseen += np.flatnonzero((known_fractions(scene) > 0) & (field.fractions == 0)).tolist()
    why = ""
    if scene.varies:
        why = "nobody has looked at conductivities that follow the temperature"
    elif edge_order(scene) < SMOOTH:
        why = "beside edges errors fall by other powers"
    elif np.any(scene.parents()):
        why = "where inclusions lie in others errors cancel"
    elif unseen:
        why = "some inclusions are finer than elements"
    if why:
        raise NotImplementedError(f"Field.extrapolated: {why}; Field.error has an interval")


def _coarser(coarser):
    try:
        return [quietly(lambda of: list(coarser(of)), level) for level in (1, 2)]
    except ValueError as error:
        raise RuntimeError(f"Field.extrapolated: no coarser runs to go by: {error}") from error


def _along(flux, field):
    return float(flux @ field.mean_flux)


def _order(values, rule):
    """With which errors fall; infinite where sizes must show it and do not."""
    if not rule.shown:
        return rule.order
    fine, coarse = values[0] - values[1], values[1] - values[2]
    if not fine * coarse > 0:
        return math.inf
    found = math.log(coarse / fine) / math.log(rule.ratio)
    least, most = rule.shown
    return min(max(found, rule.slow), rule.order) if least <= found <= most else math.inf


def _limit(values, ratio, order):
    return values[0] + (values[0] - values[1]) / (ratio**order - 1)


def _lacks(sizes, read, rule, order):
    """Half of an interval, by the largest changes between runs of one size and the next."""
    values = [[read(each) for each in runs] for runs in sizes]
    fine, *coarse = [first for first, *_ in values]
    changes = [
        max(largest(one, other) for other in each) for one, each in zip((fine, *coarse), values[1:], strict=False)
    ]
    first, second = np.subtract(fine, coarse[0]), np.subtract(*coarse)
    falls = np.sum(first * second) >= rule.ratio ** min(rule.last, rule.slow) * np.sum(first**2)
    half = rule.safety * missing(changes, rule.ratio, rule.slow if falls else min(rule.slow, rule.last))
    in_the_end = changes[0] * (1 / (rule.ratio**rule.last - 1) - 1 / (rule.ratio**order - 1))
    return max(half, in_the_end)
