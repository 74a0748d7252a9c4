"""The ways to a conductivity: a method with what it fixes, its knob, and the values of it that are walked."""

import math
from collections.abc import Mapping
from typing import NamedTuple

# From one value of a knob to the next the cost grows by about so much; neighbours nearer than NEAR are near enough.
STEP, NEAR = 1.5, 1.2
# Voxels along the longest side: halves and quarters of them are whole, and transforms of their lengths are fast.
PRIMES, MULTIPLE = (2, 3, 5, 7), 4
# Parts of an image's voxels along each edge, before whole ones.
COARSENED = (0.25, 0.5)


# Particles to begin with, as a power of the number of bodies: 250 of 83, 42 000 of 5000.
BEGIN = 1.25

# With which power of its value a knob is expected to cost, roughly.
POWERS = {"particles": 1.0, "voxels": 3.0, "parts": 3.0, "size": -3.0, "order": 2.0}


# The way of rows that are no search: `effective` itself is asked, and seconds after which nobody waits (`asked`).
ASKED, ASKED_S = "effective", 20.0


class Way(NamedTuple):
    """One way; sizes are in edges of a cube as large as the box, voxels along such an edge."""

    title: str
    look: str  # The method whose colour and line it has in figures
    method: str  # Module
    knobs: Mapping  # What it fixes
    knob: str
    first: float  # Value to begin with
    point: float  # Of the row that a replay makes again
    extrapolates: bool = False
    own: bool = False  # Whether it is what the method does by itself
    spheres: bool = False  # Whether it knows disjoint spheres only
    peer: bool = False  # Whether others wrote it
    marches: bool = False  # Whether it goes through time


WAYS = {
    "dem": Way("DEM", "dem", "dem", {}, "particles", 250, 2000, own=True),
    # What is extrapolated from the same particles is mostly the same: by itself, and on few scenes.
    "dem-limit": Way("DEM", "dem", "dem", {}, "particles", 4000, 8000, extrapolates=True),
    # As little as a conductivity asks for, as the FFT's by its own way; beside the record (`frontier.second`).
    "dem-loose": Way("DEM, tolerance 1e-3", "dem", "dem", {"tolerance": 1e-3}, "particles", 250, 2000),
    # As printed by Haddad et al.: particles in packings, calibrated surfaces.
    "dem-paper": Way(
        "DEM, paper", "dem-calibrated", "dem", {"law": "calibrated", "conforming": False}, "particles", 500, 2000
    ),
    "fem": Way("FEM, degree 2", "fem", "fem", {"order": 2}, "size", 0.35, 0.2, extrapolates=True, own=True),
    "fem-p1": Way("FEM, degree 1", "fem-p1", "fem", {"order": 1}, "size", 0.2, 0.15),
    # As "dem-loose".
    "fem-loose": Way(
        "FEM, tolerance 1e-3", "fem", "fem", {"order": 2, "tolerance": 1e-3}, "size", 0.35, 0.2, extrapolates=True
    ),
    "fft": Way("FFT", "fft", "fft", {}, "voxels", 8, 24, extrapolates=True, own=True),
    # As little as the conductivity asks for (`fft.solve`): its error is then a hundredth of the voxels'.
    "fft-loose": Way("FFT, tolerance 1e-3", "fft", "fft", {"tolerance": 1e-3}, "voxels", 8, 24, extrapolates=True),
    "fft-laminate": Way("FFT, laminate", "fft", "fft", {"rule": "laminate"}, "voxels", 8, 24),
    "fft-links": Way("FFT, links", "fft-links", "fft", {"rule": "links"}, "voxels", 8, 24),
    "fft-em": Way("FFT, Eyre-Milton", "fft-em", "fft", {"scheme": "eyre-milton", "rule": "laminate"}, "voxels", 8, 24),
    # An image's own voxels, each of them split into so many along each edge, or so many of them made one.
    "fft-image": Way("FFT", "fft", "fft", {}, "parts", 0.25, 1, own=True),
    "fft-image-loose": Way("FFT, tolerance 1e-3", "fft", "fft", {"tolerance": 1e-3}, "parts", 0.25, 1),
    "multipole": Way("multipoles", "multipole", "multipole", {}, "order", 1, 3, own=True, spheres=True),
    # As exactly as a conductivity to .003 % asks for: what is left then is a hundredth of that.
    "multipole-loose": Way(
        "multipoles, accuracy 1e-3", "multipole", "multipole", {"accuracy": 1e-3}, "order", 1, 3, own=True, spheres=True
    ),
    # Through time, steps as fine as elements ask for, or as the methods have them by themselves.
    "dem-time": Way("DEM", "dem", "dem", {}, "particles", 250, 2000, marches=True),
    "dem-time-own": Way("DEM, its own steps", "dem", "dem", {}, "particles", 250, 2000, own=True, marches=True),
    "fem-time": Way("FEM, degree 2", "fem", "fem", {"order": 2}, "size", 0.4, 0.2, marches=True),
    "fem-p1-time": Way("FEM, degree 1", "fem-p1", "fem", {"order": 1}, "size", 0.2, 0.1, marches=True),
    "fem-bricks-time": Way(
        "FEM, bricks", "fem-bricks", "fem", {"elements": "hexahedra"}, "size", 0.2, 0.1, marches=True
    ),
    "ngsolve": Way("NGSolve, degree 3", "fem", "ngsolve", {"order": 3}, "size", 0.5, 0.2, peer=True),
}


def begun(way: Way, scene) -> Way:
    """The same, begun where its knob begins to matter.

    Among thousands of bodies few particles cost as much as many; elements are no longer than what is near them allows.
    """
    if way.knob == "particles":
        return way._replace(first=max(way.first, round(len(scene.inclusions) ** BEGIN)))
    if way.knob == "size" and not way.peer:
        from studies.common.searches.elements import longest

        return way._replace(first=min(way.first, longest(scene)))
    return way


def value_at(way: Way, number: float) -> float | int:
    """The knob's value at a place on the walk: the first at 0, each next place about STEP times as dear."""
    if way.knob == "particles":
        return round(way.first * STEP**number)
    if way.knob == "size":
        return way.first / STEP ** (number / 3)
    if way.knob == "parts":
        return COARSENED[number] if number < len(COARSENED) else number - len(COARSENED) + 1
    if way.knob == "order":
        # Amplitudes go with the square of the degree, their equations with that squared, or less.
        return max(round(way.first * STEP ** (number / 3)), math.ceil(way.first + number / 2))
    return smooth(way.first * STEP ** (number / 3), MULTIPLE)


def growth(way: Way, value: float, finer: float) -> float:
    """How many times as much a finer value is expected to cost."""
    return (finer / value) ** POWERS[way.knob]


def between(way: Way, low, high):
    """A value between two neighbours, None if there is none."""
    if way.knob == "size":
        return math.sqrt(low * high)
    middle = math.sqrt(low * high)
    value = smooth(middle, 2) if way.knob == "voxels" else round(middle)
    return value if low < value < high else None


def smooth(number: float, multiple: int) -> int:
    """The whole multiple nearest to a number whose other prime factors are small."""
    middle = max(round(number / multiple), 1)
    found = (k for off in range(middle + 1) for k in (middle - off, middle + off) if k > 0 and _small(k))
    return multiple * next(found)


def _small(number):
    for prime in PRIMES:
        while number % prime == 0:
            number //= prime
    return number == 1


def knobs_at(way: Way, value, scene) -> dict:
    """Keywords of `solve` at a value of the knob."""
    edge = scene.volume ** (1 / 3)
    if way.knob == "size":
        return {**way.knobs, "size": value * edge}
    if way.knob == "parts":
        return {**way.knobs, "voxels": tuple(max(1, round(n * value)) for n in scene.image.shape)}
    if way.knob == "voxels":
        return {**way.knobs, "voxels": [max(1, round(side * value / edge)) for side in scene.size]}
    more = {"seed": 0, "allow_few": True} if way.knob == "particles" else {}
    return {**way.knobs, **more, way.knob: value}
