"""What is known of a conductivity: a number, exact or within its doubt, or a bound."""

from typing import NamedTuple

import numpy as np

from demheat.scene import Scene
from references import exact, fem, multipole
from references.exact import ellipsoids
from studies.common.drawn import ACCURACY

# Edges of the finer elements, of the box.
FINE = 1 / 18
ROUNDING = 1e-9
# Of the conductivity: where multipoles judge others that are ten times rougher at least.
FINER = 2e-5


class Truth(NamedTuple):
    """Between which the conductivity along the load lies, W/(m K), and who says so."""

    lower: float
    upper: float
    source: str


def axis_of(scene: Scene) -> int:
    """Along which the load is."""
    return int(np.argmax(np.abs(scene.gradient))) if scene.periodic else scene.axis


def number(value: float, source: str):
    """What is known already."""
    return lambda: _within(value, ROUNDING * value, source)


def closed(scene: Scene):
    """The closed form of a scene, or of one that must conduct alike."""

    def known():
        field = exact.solve(scene)
        off = field.conductivity * (10.0 ** -field.stats["digits"] + ROUNDING)
        return _within(field.conductivity, off, field.stats["form"])

    return known


def multipoles(scene: Scene):
    """Of spheres at random."""

    def known():
        k = multipole.solve(scene, accuracy=ACCURACY).conductivity
        return _within(k, 10 * ACCURACY * k, "multipoles")

    return known


def few(scene: Scene, contrast: float, axes):
    """Of a small ellipsoid: Maxwell's estimate, in doubt by what it adds to the first order."""

    def known():
        along = axis_of(scene)
        fraction = scene.inclusions[0].volume / scene.volume
        both = (each(contrast, axes, fraction)[along, along] for each in (ellipsoids.maxwell, ellipsoids.dilute))
        k, first = map(float, both)
        return _within(k, abs(k - first) + ROUNDING, "Maxwell's estimate of few")

    return known


def finer(scene: Scene):
    """By finite elements that are finer than those that are judged, in doubt by what they say of themselves."""

    def known():
        field = fem.solve(scene, size=FINE * max(scene.size))
        return Truth(field.error.lower, field.error.upper, "finer elements")

    return known


def finer_multipoles(scene: Scene):
    """By multipoles that are finer than those that are judged, in doubt by what they say."""

    def known():
        error = multipole.solve(scene, accuracy=FINER).error
        return Truth(error.lower, error.upper, "finer multipoles")

    return known


def _within(k, off, source):
    return Truth(k - off, k + off, source)
