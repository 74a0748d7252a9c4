"""What other runs tell of one: fewer particles how far it is off, few ones whether there is an answer at all."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from demheat.conduction.steady import HIGH_CONTRAST, Unsolved, contrast_of
from demheat.dem.options import Particles
from demheat.error import LEVELS, Estimate, Fine, Refinement, beside, by_refinement, conductivity_of, misplaced, quietly
from demheat.extrapolation import Extrapolated, Limit, by_extrapolation
from demheat.laws import Calibrated, Laguerre, Platonic
from demheat.network.bridges import needed
from demheat.runtime.progress import stage
from demheat.scene import Scene, Union
from demheat.scene.edges import SMOOTH, edge_order, leaning
from demheat.scene.volumes import coats, extents

# Twins in gaps stand so much closer in a run besides; there the error goes with their distance.
CLOSER = 0.7
# What an interval is raised by where surfaces resist: without it one of spheres in cubic order, r = .5, ended at .95 of
# the error.
RESISTED = 1.5
# Where heat goes along flat faces of an image arithmetic means err downwards, too, and particles hold by chance too
# little of what conducts well: 30 images whose conductivity is known (study `intervals`, even seeds, 3000 to 8000
# particles) ask for up to 1.3.
MEANS = 1.5
# A run has a quarter of the particles of the one before.
RATIO = 4 ** (1 / 3)
# What a conductivity may be off by, of what the equations leave: found is 25 times as much, where cells are exact.
LEFT = 30.0
# Of the inclusions' volume, which facets on surfaces that are bent more sharply than particles are wide miss by more:
# the error is then that of a surface out of its place, which goes with the distance between particles. Beside edges it
# does so, too: rods (study `intervals`, even seeds) ask for nearly all of their 1.2.
BENT = 0.01
# In grooves where members of a union cross: errors of two balls (contrast 15, 4000 to 128 000 particles) fall with the
# power 1.33, and with 2 intervals ended before the truth from 32 000 particles on, by up to 1.3. And what half of the
# interval is at least, as by `SPREAD_OUT`, over that power of the width: these balls ask for .031.
GROOVED, GROOVES = 4 / 3, 0.045
# Part of what an inclusion does that is off, times the square of its width in particles: found on spheres and fibres at
# random, one to three particles wide, contrasts .001 to 1000, up to .37.
SMALL = 0.4
# Of what an inclusion makes, half of the interval is at least so much over the square of its width in particles, where
# points are spread over its surface: how they lie leaves an error of second order whose sign is not that of the others,
# so that runs differ by little. Balls told by functions, of radius .2 to .4 and contrasts .01 to 100 (2000 to 14 000
# particles, seeds 0 and 2, four of 4), ask for up to .061; without it 22 of 124 missed.
SPREAD_OUT = 0.1
# The same of surfaces of triangles, times the angle at which neighbours meet, over the width in particles: facets turn
# where twins are, not where triangles do. Balls of 320 to 5120 triangles (3000 to 20 000 particles) ask for up to .155.
KINKED = 0.18
# The same over the width alone, where a body goes through a wall at an angle: cells there are cut by its surface. Where
# runs lie close by chance a cylinder of contrast 20 (47 000 to 210 000 particles) asks for .0023, others for less.
LEANS = 0.003
# Even seeds of study `intervals` would do with an order of 2.5, as twins were placed by what takes the second away
# (`BEND`), but not the few particles that a tenth of a per cent asks for. Of what closer twins in gaps change .9 is
# needed there, and around coats 1.25 times the temperature.
CONFORMING = Refinement("fewer particles", RATIO, 2.0, 1.0, 1.0, also=1.0, coats=1.5)
# Where inclusions lie in others errors go with the square of twins' distance: two of eight coated spheres of study
# `estimates`, seeds 1000 to 1004, ask for 1.1.
IN_COATS = 1 / (1 - CLOSER**2)
# Twins stand where the second power of the size is gone from most scenes (`BEND`): what is left is of no one power, and
# by any that is taken off errors of drawn scenes (even seeds) get larger as often as smaller. Where three sizes show
# the second power, as around a body that fills half of its cell, a fifth is left.
LIMIT = Limit("fewer particles, extrapolated", 2.0, 2.5, 2.0, 1.5, shown=(1.5, 2.5))
# Particles across the narrowest inclusion below which sizes show no power: 83 spheres showed one on the way to a change
# of sign.
ACROSS = 8.0
# On 25 scenes of these seeds 1.8 holds all but one, as 1.6 does; 1.3 all but two.
PLAIN = Refinement("fewer particles", RATIO, 1.0, 1.8, 1.0, chance=True)
# Particles of a trial, its iterations at most (found: 700), and by how much it may miss the tolerance, as more of them
# may do a little better: .1 to 1 s. On 16 scenes of contrasts from 1e7 to 1e12, at the usual tolerance, all that it
# refused failed with 10 000 particles, and it refused all that failed from 1e9 on.
FEW, MOST, LENIENT = 3000, 2000, 2.0
# A tolerance at most, as that of any solve.
LOOSEST = 9e-3


def estimator_of(law: Laguerre | Calibrated | Platonic, wanted: Particles, answer: Callable, *, steps: float = 0.0):
    """What tells a field of the DEM its error."""
    if law.cells and law.interface == "harmonic":
        return partial(_by_fewer, law=law, wanted=wanted, answer=answer, steps=steps)
    return partial(_by_cells, wanted=wanted, answer=answer)


def _by_fewer(field, *, law, wanted, answer, steps) -> Estimate:
    """Radical cells converge: runs with fewer particles tell how far, one with closer twins how far in gaps."""
    if field.scene.image is not None:
        return _by_means(field, answer(replace(law, interface="arithmetic"), wanted))
    number = _number(wanted)

    def fewer(level, law=law, seed=wanted.seed):
        return answer(law, _fewer(wanted, number // 4**level, seed))

    def coarser(level):
        yield fewer(level)
        if level == 1:
            yield fewer(level, seed=wanted.seed + 1)

    rule = CONFORMING if law.conforming else PLAIN
    if field.scene.resistances.any():
        rule = rule._replace(safety=RESISTED * rule.safety)
    if np.abs(misplaced(field)).sum() > BENT or edge_order(field.scene) < SMOOTH:
        rule = rule._replace(order=1.0)
    elif any(map(_grooved, field.scene.inclusions)):
        rule = rule._replace(order=min(rule.order, GROOVED))

    if law.conforming and np.any(field.scene.parents()):
        rule = rule._replace(also=IN_COATS)

    def closer(first):
        return fewer(1, replace(law, gap_spacing=CLOSER * law.gap_spacing)) if _in_gaps(first) else None

    left = {"residual": LEFT * field.stats["residual"] + steps, "fine": _fine(field, number, law)}
    return by_refinement(field, coarser, rule, also=closer, **left)


def _by_means(field, other) -> Estimate:
    """Of an image, whose faces links cross where they happen to: harmonic means are too low, arithmetic ones too high.

    On images of noise, Gaussian fields and spheres (12^3 voxels, 5000 particles, contrasts .01 to 100) the conductivity
    of the image lies half way between, .45 to .56; fewer particles may differ by a fifth of the error.
    """
    if field.scene.mean_conductivities.min() == 0:
        raise NotImplementedError(
            "Field.error: beside pores of an image both means are 0, and fewer particles do not tell how far facets "
            "are off the faces of voxels; FFT and finite elements know it of themselves"
        )
    flux = MEANS * float(np.max(np.abs(field.mean_flux - other.mean_flux)))
    k, runs = conductivity_of(field), (conductivity_of(field), conductivity_of(other))
    half = MEANS * abs(runs[1] - k)
    return Estimate("arithmetic means between particles instead", max(k - half, 0.0), k + half, flux, math.nan, runs)


def _number(wanted):
    return wanted.particles if wanted.packing is None else len(wanted.packing.radii)


def _fewer(wanted, number, seed=None):
    """What is asked for with another number of particles, none of them given."""
    seed = wanted.seed if seed is None else seed
    return replace(wanted, particles=max(1, number), seed=seed, packing=None, replicas=None, allow_few=True)


def _fine(field, number, law):
    """Inclusions narrower than a particle, and what is off as others are little wider: `FEWEST` twins stand on both.

    Twins on layers lie as they would on thicker ones, and those of a coat as they would without it, unless they do not
    fit, and nothing is left of it.
    """
    scene = field.scene
    if not scene.inclusions:
        return Fine()
    diameter = _diameter(scene, number)
    if not law.conforming:
        narrow = np.flatnonzero(np.minimum(extents(scene), coats(scene)) < diameter)
        return Fine(narrow, radius=diameter)
    across = _across(scene, number)
    share = field.fractions[1:] / max(float(field.fractions[1:].sum()), 1e-300)
    # Wider ones have more twins the more particles there are, down to the coarsest run.
    off = np.where(across < RATIO**LEVELS, SMALL / across**2, 0.0)
    rough, least = (float(share @ np.minimum(part, 1.0)) for part in (off, _spread_out(field, across, diameter)))
    return Fine(np.flatnonzero(across < 1.0), rough, 0.5 * diameter, least)


def _spread_out(field, across, diameter):
    """Part of what each inclusion makes that is off at walls, and as points are spread over its surface by samples."""
    bodies, at_walls = field.scene.inclusions, leaning(field.scene) * LEANS / across
    spread = np.array([each.finding != "form" for each in bodies])
    kinks = np.array([each.kinks for each in bodies])
    # A function may have limits far beyond its body: that is no wider than a ball that holds as much.
    balls = (6 * field.scene.volume / math.pi * field.fractions[1:]) ** (1 / 3)
    across = np.maximum(np.minimum(across, balls / diameter), 1e-3)
    plain = SPREAD_OUT / across**2 + KINKED * kinks / across
    grooved = np.where([_grooved(each) for each in bodies], GROOVES / across**GROOVED, 0.0)
    return np.maximum(np.where(spread, np.maximum(plain, grooved), 0.0), at_walls)


def _grooved(body):
    """Whether members of it may cross."""
    return isinstance(body, Union)


def _diameter(scene, number):
    """Of balls that fill the body."""
    return (6 * scene.volume / (math.pi * number)) ** (1 / 3)


def _across(scene, number):
    """Particles across each inclusion; layers have as many as they need."""
    return np.where([each.flat for each in scene.inclusions], np.inf, extents(scene)) / _diameter(scene, number)


def _in_gaps(field):
    """Whether twins stand closer than even ones, or in columns of shells: fewer particles leave these as they are."""
    packing = field.stats["packing"]
    made = packing.get("of", packing)
    return made.get("twins", 0) > made.get("even_twins", 0) or made.get("shells", 0) > 0


def _by_cells(field, *, wanted, answer) -> Estimate:
    """Networks of contacts have no limit of many particles, or a far one: conforming cells show what they miss."""
    return beside(field, answer(Laguerre(), wanted), "conforming cells beside it")


def extrapolator_of(law: Laguerre | Calibrated | Platonic, wanted: Particles, answer: Callable) -> Callable | None:
    """What extrapolates a field of the DEM; None of networks that close in on nothing, or by chance."""
    if law.cells and law.conforming and law.interface == "harmonic":
        return partial(_limit, law=law, wanted=wanted, answer=answer)
    return None


def _limit(field, *, law, wanted, answer) -> Extrapolated:
    """By runs with an eighth and a sixty-fourth of the particles."""
    number = _number(wanted)
    if needed(field.stats["packing"], field.scene):
        raise NotImplementedError(
            "Field.extrapolated: facets cross gaps without particles; Field.error has an interval"
        )

    def fewer(level):
        for seed in (wanted.seed, wanted.seed + 1)[: 3 - level]:
            yield answer(law, _fewer(wanted, number // round(LIMIT.ratio**3) ** level, seed))

    rule = LIMIT._replace(safety=RESISTED * LIMIT.safety) if field.scene.resistances.any() else LIMIT
    if np.min(_across(field.scene, number), initial=math.inf) < ACROSS:
        rule = rule._replace(order=math.inf, shown=())
    left = LEFT * field.stats["residual"]
    return by_extrapolation(field, fewer, rule, residual=left, fine=_fine(field, number, law))


def check_contrast(scene: Scene, wanted: Particles, tolerance: float, answer: Callable) -> None:
    """Refuse a scene of high contrast whose equations a trial shows not to be solvable.

    Rounding of the temperatures in what conducts well leaves heat there of about 1e-16 of the contrast, of that which
    passes. That is nothing where heat passes through what conducts well from end to end, or where its temperature is
    that of the middle: a limit of the contrast alone would refuse such scenes.
    """
    number = _number(wanted)
    if scene.perfect or contrast_of(scene) < HIGH_CONTRAST or number <= FEW:
        return
    how = {"tolerance": min(LENIENT * tolerance, LOOSEST), "max_iterations": MOST}
    few = _fewer(wanted, FEW)
    try:
        with stage("trial"):
            quietly(partial(answer, **how), few)
    except Unsolved as error:
        raise NotImplementedError(
            f"solve: a trial with {FEW} particles fails already: {error} (from 1e6 on the effective conductivity "
            "hardly changes), conductivity 0 for what hardly conducts, or another method, such as references.fem"
        ) from error
    except (ValueError, RuntimeError):
        # With so few only, perhaps: what all are asked for says so itself.
        return
