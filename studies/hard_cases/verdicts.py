"""What is true of a scene, and what is said of one answer to it."""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from demheat.referee import value_error
from demheat.scene import Scene, Sphere
from studies.common.answers import answer

OUTCOMES = ("verified", "refused", "warned", "wrong", "open")
# A bracket is narrowed to the first width, if a mesh of so many elements does; a wider one than the second judges none.
NARROW, WIDE = 0.02, 0.10
# Edges of the bracket's elements over the mesher's usual ones, coarse to fine.
STEPS = (5.0, 3.0, 1.8, 1.2)
# Bounds of touching spheres, at most a hundred times as conducting: those of spheres whose radii are less by a
# hundred-thousandth of the box, widened by what the contact adds. That was found by multipoles, two spheres of a fifth
# of the cell along the load: .001 % at contrast .01, .006 % at 10, .03 % at 30, .06 % at 50 and .1 % at 100 (there of
# order 32 on either side, known to .8 %). Pairs drawn so far have contrasts of 3.2 and 0.
APART, CONTACT = 1e-5, 0.02
# Rounding and solvers' tolerances, of the elementary bounds.
SLACK = 1e-6
# What is right, relative, where a method's own interval does not reach farther.
RIGHT = 0.02
# What multipoles are asked for where they are the witness, and how many times that they are taken to be off at most.
WITNESS, TIMES = 1e-4, 3.0


class Truth(NamedTuple):
    """An interval that holds the conductivity along the load, W/(m K), and where it is from."""

    lower: float
    upper: float
    source: str

    @property
    def wide(self):
        """Too wide to judge by."""
        return self.upper > (1 + WIDE) * self.lower and self.upper > 0


class Verdict(NamedTuple):
    """What is said of one case."""

    method: str
    outcome: str  # Of `OUTCOMES`
    error: float  # Relative, signed, to the nearer end of the true interval; not-a-number without an answer
    allowed: float  # Relative: `RIGHT`, or as far as its own interval reaches
    note: str  # Words of the refusal or of the warning, or which bound is passed


def truth(scene: Scene) -> Truth:
    """The conductivity, exact or between certain bounds."""
    from references import bracket, exact, multipole

    try:
        k = exact.solve(scene).conductivity
        return Truth(k, k, "exact")
    except NotImplementedError:
        pass
    if scene.perfect or scene.resistances.any():
        k = multipole.solve(scene, accuracy=WITNESS).conductivity
        return Truth(k * (1 - TIMES * WITNESS), k * (1 + TIMES * WITNESS), "multipoles")
    try:
        return _bracketed(bracket, scene)
    except NotImplementedError:
        found = _bracketed(bracket, _shrunk(scene))
        return Truth(found.lower * (1 - CONTACT), found.upper * (1 + CONTACT), "bracket, apart")


def _bracketed(bracket, scene):
    from references.mesh.sizes import checked_size

    usual = checked_size(scene, None, 2)
    for step in STEPS:
        found = bracket.solve(scene, size=step * usual)
        if found.width <= NARROW or found.upper <= 1e-9 * max(scene.conductivities):
            break
    return Truth(found.lower, found.upper, "bracket")


def _shrunk(scene):
    less = APART * max(scene.size)
    inclusions = [
        replace(each, radius=each.radius - less) if isinstance(each, Sphere) else each for each in scene.inclusions
    ]
    return replace(scene, inclusions=inclusions)


def refused(name: str, error: Exception) -> Verdict:
    """Verdict of a refusal; one without a reason, in one line of some words, is wrong."""
    words = str(error)
    told = len(words.split()) >= 4 and "\n" not in words
    return Verdict(name, "refused" if told else "wrong", math.nan, math.nan, " ".join(words.split()))


def judged(name: str, field, known: Truth, said) -> Verdict:
    """Verdict of an answer: right to 2 %, or inside of the interval that it has itself."""
    off = error(field.conductivity, known, float(max(_finite(field.scene.conductivities))) or 1.0)
    # Networks claim no elementary bounds.
    passed = "" if name.startswith("dem") or name == "fft-links" else beyond_elementary(field, SLACK)
    if passed or not math.isfinite(off):
        return Verdict(name, "wrong", off, RIGHT, passed or "no number")
    half = RIGHT if abs(off) <= RIGHT else max(RIGHT, half_interval(field, -off))
    if abs(off) <= half:
        # A warning beside a right answer is no harm.
        return Verdict(name, "open" if known.wide else "verified", off, half, "; ".join(said))
    return Verdict(name, "warned" if said else "wrong", off, half, "; ".join(said))


def half_interval(field, way: float) -> float:
    """How far a field's own interval reaches up or down, relative to what it lies about; 0 without one."""
    found, _, refusal = answer(lambda: field.error)
    if refusal is not None or not field.conductivity > 0:
        return 0.0
    # Errors are over what is true, which that end of the interval stands for.
    end = found.upper if way > 0 else found.lower
    return abs(float(value_error(field.conductivity, end))) if end > 0 else math.inf


def _finite(conductivities):
    return conductivities[np.isfinite(conductivities)]


def error(found: float, known: Truth, scale: float) -> float:
    """Signed relative error to the nearer end of an interval, 0 inside; of heat that is stopped over a scale."""
    if known.lower <= found <= known.upper:
        return 0.0
    end = known.upper if found > known.upper else known.lower
    return float(value_error(found, end, scale=scale) if end == 0 else value_error(found, end))


def beyond_elementary(field, slack: float) -> str:
    """Which of Voigt's and Reuss's bounds, for the fractions that the method saw, a field passes; empty if none."""
    shares, k = np.asarray(field.fractions), field.scene.conductivities
    # Films are in neither bound, perfect conductors in one.
    if field.scene.resistances.any():
        return ""
    seen = shares > 0
    voigt = float(shares @ k)
    reuss = 1 / float(np.sum(shares[seen] / k[seen])) if np.all(k[seen] > 0) else 0.0
    if field.conductivity > voigt * (1 + slack):
        return f"above Voigt's bound {voigt:.6g}"
    if field.conductivity < reuss * (1 - slack):
        return f"below Reuss's bound {reuss:.6g}"
    return ""
