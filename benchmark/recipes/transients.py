"""Heat in time by series, and the benchmarks T2, T3 and T4 of NAFEMS."""

import math
from functools import partial

import numpy as np

from benchmark.recipes.entries import CUBE, Entry
from demheat.io.known import Sine
from demheat.scene import STEFAN_BOLTZMANN, Convection, Flux, Material, Radiation, Scene, UniformSource
from references.exact import series
from references.exact.benchmarks import convecting_plate, radiating_end, swinging_end

UNIT = Material(1.0, density=1.0, heat_capacity=1.0)
TIMES = (0.02, 0.1, 0.5)
ALONG = np.array([(x, 0.5, 0.5) for x in (0.1, 0.25, 0.5, 0.9)])
# From the middle of the ball, in radii: .1, .5 and .9.
RADIAL = np.array([(0.55, 0.5, 0.5), (0.5, 0.75, 0.5), (0.5, 0.5, 0.95), (0.3, 0.35, 0.6)])
SERIES = "series of images at short times and of modes at long ones; terms below 1e-16 are left out"
SOURCE = "Carslaw and Jaeger, Conduction of Heat in Solids, chapters 3 and 9"
NAFEMS = "The Standard NAFEMS Benchmarks (1990), {}; printed there as {}"
# Of the bars, m.
LENGTH = 0.1
# Of what the load imposes.
ROUNDING = 1e-12


def entries():
    """Names, and what makes each."""
    for name, title, points, given in (
        ("slab-step", "slab, a wall at 1 from time 0 on, the other at 0", ALONG, {"walls": {"x-": 1.0, "x+": 0.0}}),
        ("slab-flux", "slab, a flux comes in, the other wall at 0", ALONG, {"walls": {"x-": Flux(2.0), "x+": 0.0}}),
        (
            *("slab-convection", "slab, films on both sides", ALONG),
            {"walls": {"x-": Convection(5.0, 1.0), "x+": Convection(0.5, -0.5)}},
        ),
        (
            *("slab-heated", "slab heated throughout, both walls at 0", ALONG),
            {"walls": {"x-": 0.0, "x+": 0.0}, "sources": [UniformSource(8.0)]},
        ),
        (
            "ball-step",
            "ball whose surface is at 1 from time 0 on",
            RADIAL,
            {"walls": {"round": 1.0}, "domain": "sphere"},
        ),
    ):
        yield name, partial(_in_time, name, title, points, given)
    yield from (("nafems-t2", _radiating), ("nafems-t3", _swinging), ("nafems-t4", _plate))


def _in_time(name, title, points, given):
    scene = Scene(CUBE, UNIT, initial=0.0, **given)
    # A ball of radius 1/2 is through in a quarter of the time.
    times = [t / 4 if scene.domain == "sphere" else t for t in TIMES]
    found = [
        {"position": at, "time": field.time, "temperature": t}
        for field in series.evolve(scene, times)
        for at, t in zip(points.tolist(), field.temperature_at(points).tolist(), strict=True)
    ]
    known = {"by": "series", "how": SERIES, "source": SOURCE}
    known["fields"] = {"temperature_error": ROUNDING, "points": found}
    return Entry(name, "transients", title, scene, known)


def _asked(name, title, scene, known, points):
    """A benchmark of NAFEMS; errors are of rounding, the span is up to 1000."""
    known = known | {"fields": {"temperature_error": 1e-9, "points": points}}
    return Entry(name, "NAFEMS", title, scene, known)


def _radiating():
    length, hot, around = LENGTH, 1000.0, 300.0
    end = radiating_end(length, 55.563, hot, 0.98 * STEFAN_BOLTZMANN, around)
    scene = Scene((length,) * 3, Material(55.563), walls={"x-": hot, "x+": Radiation(0.98, around)})
    points = [
        {"position": (x, 0.05, 0.05), "temperature": hot + (end - hot) * x / length} for x in (length, 0.05, 0.02)
    ]
    how = {"by": "closed form", "how": "k (T_h - T)/L = e b (T^4 - T_a^4) at the end; linear between"}
    how["source"] = NAFEMS.format("T2", "927.0 K at the end")
    return _asked("nafems-t2", "T2, a bar that radiates at its end", scene, how, points)


def _swinging():
    length, period, when, metal = LENGTH, 80.0, 32.0, Material(35.0, density=7200.0, heat_capacity=440.5)
    scene = Scene((length,) * 3, metal, walls={"x-": 0.0, "x+": Sine(100.0, period)}, initial=0.0)
    diffusivity = 35.0 / (7200.0 * 440.5) / length**2
    places = np.array([0.08, 0.05, 0.09])
    warm = 100.0 * swinging_end(places / length, when, diffusivity=diffusivity, rate=2 * math.pi / period)
    points = [
        {"position": (x, 0.05, 0.05), "time": when, "temperature": t}
        for x, t in zip(places.tolist(), warm.tolist(), strict=True)
    ]
    how = {"by": "series", "how": "what swings for ever, in closed form, and modes that make it 0 at the start"}
    how["source"] = NAFEMS.format("T3", "36.60 C at 0.08 m")
    return _asked("nafems-t3", "T3, a bar whose end swings in time", scene, how, points)


def _plate():
    width, height, film, k = 0.6, 1.0, 750.0, 52.0
    outside = Convection(film, 0.0)
    scene = Scene((width, height, 0.2), Material(k), walls={"y-": 100.0, "x+": outside, "y+": outside})
    places = np.array([(width, 0.2), (0.3, 0.2), (0.1, 0.6), (0.5, 0.9)])
    warm = 100.0 * convecting_plate(*places.T, width=width, height=height, film=film / k)
    points = [{"position": (*at, 0.1), "temperature": t} for at, t in zip(places.tolist(), warm.tolist(), strict=True)]
    how = {"by": "series", "how": "cosines by the roots of the Biot number; modes below 1e-16 are left out"}
    how["source"] = NAFEMS.format("T4", "18.25 C at (0.6, 0.2)")
    return _asked("nafems-t4", "T4, a plate that convects at two edges", scene, how, points)
