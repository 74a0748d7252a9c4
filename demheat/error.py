"""How far an answer may be off: an interval beside every Field, made only when it is asked for.

A method that knows its own error says so (`known`). One that does not solves the same scene on coarser and coarser
elements (`by_refinement`): what changes between two of them is what a method of that order still lacks, and the largest
that any pair asks for counts, since errors cross zero by luck. How much the largest is to be raised to hold nearly
always was found on drawn scenes for the main methods; study `estimates` judges it on others.
"""

import math
import threading
import warnings
from collections.abc import Callable, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import partial
from typing import NamedTuple

import numpy as np

from demheat.gate import hashin_shtrikman, isotropic, wiener
from demheat.scene.bodies import inside
from demheat.scene.edges import SMOOTH, edge_order
from demheat.scene.negligible import change_without
from demheat.scene.volumes import fractions, known_fractions

# Points at which temperatures of two runs are compared, and the seed that draws them.
POINTS, SEED = 1000, 7
# Rounding of a conductivity: sums of as many numbers as there are unknowns.
ROUNDING = 1e-12
# What formulas that must agree differ by.
BESIDE = 1e-9
# Of the power with which errors fall beside edges, as coarse elements meet singular fields by chance: rods of
# square section (study `intervals`, even seeds) ask for .93.
EDGES = 0.9
# What else a method knows raises an interval by so much at most, where runs close in from one side: scenes of study
# `intervals`, even seeds, ask for 1.08.
RAISED = 1.15
# What inclusions make of the conductivity goes with how much there is of them to some part: faces along the axes, even
# seeds of that study, ask for 1.01.
PLACED = 1.25
# Coarser runs.
LEVELS = 2
# Whether temperatures are compared, too, which costs more than the rest where solves are small.
_WARMTH = ContextVar("warmth", default=True)
# Filters of warnings belong to the process: one thread at a time changes and restores them.
_QUIET = threading.Lock()


class Estimate(NamedTuple):
    """How far a field may be off.

    Attributes
    ----------
    how : str
        What was done to know it.
    lower, upper : float, W/(m K)
        Between which the conductivity is expected; NaN where the scene has none.
    flux : float, W/m2
        By how much any component of the mean flux is expected to be off at most.
    temperature : float, K
        Root mean square over the body, expected at most; NaN if unknown.
    runs : tuple of float, W/(m K)
        Conductivities on coarser and coarser elements, the field's own first.

    Examples
    --------
    >>> from demheat import gallery
    >>> from references import fft
    >>> error = fft.solve(gallery.sphere_in_cube(5.0), voxels=32).error
    >>> error.lower < 42.6403 < error.upper, len(error.runs)
    (True, 3)
    """

    how: str
    lower: float
    upper: float
    flux: float
    temperature: float
    runs: tuple[float, ...] = ()


class Refinement(NamedTuple):
    """How a method's error is read off coarser runs, each with elements so many times as long as the one before."""

    how: str  # What is made coarser
    ratio: float  # Of the lengths
    order: float  # With which errors fall
    # What the largest change is raised by, of the conductivity and of the temperature's root mean square
    safety: float
    temperature_safety: float
    also: float = 0.0  # What the change by another refinement is raised by, of what coarser runs do not show
    # Where inclusions lie in others the interval is at least so many times as wide, relatively, as the temperature is
    # expected to be off: errors of coat and core may cancel in the conductivity, wholly so in neutral spheres, and what
    # is left between runs is chance. 0: nothing of that
    coats: float = 0.0
    # Whether elements hold too much or too little of phases by chance: changes between runs do not show that, and are
    # taken between conductivities that are corrected for it
    chance: bool = False


class Fine(NamedTuple):
    """What is too fine for coarser runs to tell of it."""

    # sequence of int: Inclusions finer than the elements, which may make of the conductivity whatever bounds allow;
    # those of which a method holds nothing need not be named
    unseen: Sequence[int] = ()
    # What all inclusions make of the conductivity is off by this part, as some are hardly wider than elements
    rough: float = 0.0
    # m: Of a ball about the middle of an unseen sphere that holds all that a method may see instead
    radius: float = 0.0
    # Half of the interval is at least this part of what all inclusions make of the conductivity
    least: float = 0.0


NOTHING = Fine()


@contextmanager
def of_conductivity_alone():
    """Within, estimates leave temperatures out: NaN."""
    token = _WARMTH.set(False)
    try:
        yield
    finally:
        _WARMTH.reset(token)


def known(field, relative, how, *, temperature=math.nan) -> Estimate:
    """The estimate of a method that knows its relative error."""
    k, relative = conductivity_of(field), relative + ROUNDING
    flux = relative * _size(field.mean_flux)
    return Estimate(how, max(k - relative * k, 0.0), k + relative * k, flux, temperature, (k,))


def beside(field, other, how) -> Estimate:
    """The estimate of a method by another of the same scene: as far as the other is, and what that may be off."""
    error, runs = other.error, (conductivity_of(field), conductivity_of(other))
    half = max(abs(runs[0] - error.lower), abs(error.upper - runs[0]))
    apart = math.nan
    if _WARMTH.get():
        points = _points(field.scene)
        apart = _spread(_level_free(field, points), _level_free(other, points))
    flux = _size(field.mean_flux - other.mean_flux) + error.flux
    return Estimate(how, max(runs[0] - half, 0.0), runs[0] + half, flux, apart + error.temperature, runs)


def by_refinement(
    field,
    coarser: Callable,
    rule: Refinement,
    *,
    also: Callable | None = None,
    least=0.0,
    residual=0.0,
    fine=NOTHING,
) -> Estimate:
    """The estimate of a method by the changes that coarser elements make.

    Of each size there may be several coarser runs: two are not often close to a finer one by luck. Half of the interval
    is at `least` what a method knows besides, W/(m K), where coarser runs do not differ more and more, as errors of two
    kinds cancel; elsewhere that raises it by `RAISED` at most.

    Changes do not show what all elements see alike: fractions of phases that are not the body's, which count as far as
    the conductivity goes with them; and parts that are finer than any of the elements, which may be anything, within
    the bounds of the body's own fractions.

    Warnings of the coarser runs, whose elements are too large for what the finest resolves, are kept back.
    """
    runs = [[field], *_coarser_runs(coarser)]
    fields = [first for first, *_ in runs]
    other = quietly(also, fields[1]) if also else None
    residual += ROUNDING
    rule = _beside_edges(rule, edge_order(field.scene))

    def lacks(read, apart, safety):
        changes = [max(apart(read(a), read(b)) for b in each) for a, each in zip(fields, runs[1:], strict=False)]
        more = 0.0 if other is None else apart(read(fields[1]), read(other))
        return safety * missing(changes, rule.ratio, rule.order) + rule.also * more

    k = conductivity_of(field)
    half = lacks(_corrected if rule.chance else conductivity_of, largest, rule.safety)
    half = max(half, least if _by_luck(fields) else min(least, RAISED * half)) + residual * abs(k)
    flux = lacks(lambda each: each.mean_flux, largest, rule.safety) + residual * _size(field.mean_flux)
    if k:
        # What inclusions make of the conductivity goes with how much there is of them.
        off = [misplaced(each) for each in fields]
        # Runs are corrected for what they hold by chance: all that the first holds counts.
        shown = PLACED * float(np.abs(off[0]).sum()) if rule.chance else unshown(off, rule.ratio, rule.order)
        made = abs(k - float(field.scene.mean_conductivities[0]))
        half = max(half + (shown + fine.rough) * made, fine.least * made)
        flux = max(flux, fine.least * made / abs(k) * _size(field.mean_flux))
    coated, kelvin = rule.coats and np.any(field.scene.parents()), math.nan
    if coated or _WARMTH.get():
        warmth = partial(_level_free, points=_points(field.scene))
        kelvin = lacks(warmth, _spread, rule.temperature_safety) + residual * _span(field, warmth(field))
    if coated:
        half = max(half, rule.coats * abs(k) * kelvin / _drop(field, warmth(field)))
    found = Estimate(rule.how, max(k - half, 0.0), k + half, flux, kelvin, tuple(map(conductivity_of, fields)))
    return _with_unseen(found, field, k, fine)


def _corrected(field):
    """The conductivity less what inclusions make of it that is misplaced."""
    k = conductivity_of(field)
    return k - float(misplaced(field).sum()) * (k - float(field.scene.mean_conductivities[0]))


def _by_luck(runs):
    """Whether a conductivity turns from run to run, or changes less and less as elements get coarser."""
    one, *others = np.diff([conductivity_of(each) for each in runs])
    return any(np.sign(one) * other < abs(one) for other in others)


def _beside_edges(rule, power):
    """A rule whose orders are no higher than edges let them be."""
    most = EDGES * power if power < SMOOTH else math.inf
    return rule._replace(order=min(rule.order, most))


def misplaced(field) -> np.ndarray:
    """How much more of its inclusions a method has than there is, over all that it has of them, (kinds,) float array.

    Those that conduct alike, in the same surroundings, are a kind. Empty where it is not known how much there is.
    """
    scene = field.scene
    try:
        off = field.fractions - fractions(scene)
    except NotImplementedError:
        return np.empty(0)
    conducts, own = scene.mean_conductivities, float(field.fractions[1:].sum())
    if not own:
        return np.empty(0)
    _, kind = np.unique(np.stack([conducts, conducts[scene.parents()]])[:, 1:], axis=1, return_inverse=True)
    return np.bincount(kind.ravel(), off[1:]) / own


def unshown(off, ratio, order) -> float:
    """What the first of some runs has misplaced, less what changes between them show already."""
    if any(len(each) != len(off[0]) for each in off):
        return float(np.abs(off[0]).sum())
    shown = [missing(np.abs(changes), ratio, order) for changes in np.diff(off, axis=0).T]
    return float(np.maximum(np.abs(off[0]) - shown, 0.0).sum())


def _with_unseen(estimate, field, k, fine):
    """The same estimate, as far as bounds where there are parts that no elements see."""
    scene = field.scene
    if not len(scene.inclusions) or not math.isfinite(k):
        return estimate
    body = known_fractions(scene)
    unseen = (body > 0) & (field.fractions == 0)
    unseen[1 + np.array(fine.unseen, int)] = True
    # What conducts as what it lies in is not to be seen.
    conducts = scene.tensors
    unseen &= np.any(conducts != conducts[scene.parents()], axis=(1, 2))
    if not unseen.any():
        return estimate
    certain = wiener(scene, body)
    narrower = hashin_shtrikman(scene, body) if isotropic(scene) else certain
    low, high = max(certain.lower, narrower.lower), min(certain.upper, narrower.upper)
    # Rounding: an array of small spheres is as good as on a bound.
    low, high = low - BESIDE * k, high + BESIDE * k
    # How far the truth, and how far the answer may be from what the body is without them.
    numbers = np.flatnonzero(unseen[1:])
    most = k * sum(change_without(scene, numbers, radius) for radius in (0.0, fine.radius))
    low, high = max(low, estimate.lower - most), min(high, estimate.upper + most)
    low, high = min(low, k), max(high, k)
    more = max(k - low, high - k) / k if k else math.inf
    flux = max(estimate.flux, more * _size(field.mean_flux))
    return estimate._replace(lower=low, upper=high, flux=flux, temperature=math.nan)


def missing(changes, ratio, order) -> float:
    """What a run lacks, by the largest that any change between it and coarser ones asks for."""
    grown = ratio ** (order * np.arange(len(changes))) * (ratio**order - 1)
    return float(np.max(np.asarray(changes) / grown))


def largest(one, other) -> float:
    """Change of any component."""
    return float(np.max(np.abs(np.subtract(one, other))))


def _coarser_runs(coarser):
    """Fields of each size."""
    runs = []
    for level in range(1, LEVELS + 1):
        try:
            runs.append(quietly(lambda of: list(coarser(of)), level))
        except (ValueError, RuntimeError, NotImplementedError) as error:
            # The elements are too long for the scene: what there is must do.
            if not runs:
                raise RuntimeError(f"Field.error: no coarser run to compare with: {error}") from error
            break
    return runs


def quietly(run, of):
    """Call a function of one argument; its warnings are kept back."""
    with _QUIET, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return run(of)


def conductivity_of(field) -> float:
    """NaN where the load defines none."""
    try:
        return math.nan if field.time is not None else field.conductivity
    except ValueError:
        return math.nan


def _points(scene):
    points = np.random.default_rng(SEED).random((POINTS, 3)) * scene.size
    return points[inside(points, scene.domain, scene.size)]


def _size(flux):
    return float(np.linalg.norm(flux))


def _level_free(field, points):
    """Temperatures, those of a periodic cell without their mean."""
    warmth = field.temperature_at(points)
    return warmth - np.nanmean(warmth) if field.scene.periodic else warmth


def _span(field, warmth):
    """Between the coldest and the warmest point or wall."""
    every = np.append(warmth[np.isfinite(warmth)], [v for v in field.wall_temperature.values() if np.isfinite(v)])
    return float(np.ptp(every)) if len(every) else 0.0


def _drop(field, warmth):
    """That the load imposes, or what it makes; infinite where all is of one temperature."""
    scene = field.scene
    across = float(np.abs(scene.gradient) @ np.array(scene.size)) if scene.periodic else _span(field, warmth)
    return across or math.inf


def _spread(one, other):
    """Root mean square where both have a temperature; zero where none has one."""
    difference = one - other
    kept = difference[np.isfinite(difference)]
    return float(np.sqrt(np.mean(kept**2))) if len(kept) else 0.0
