"""Requests that no machine can do are refused before anything is made, whoever is asked."""

import re
from dataclasses import replace

import numpy as np
import pytest

from demheat import Box, Material, MovingCylinder, Scene, evolve, gallery, solve
from demheat.packing.base import make_packing
from demheat.packing.domain import replicate
from demheat.packing.lsa import lsa
from demheat.packing.relax import relax, settle
from demheat.packing.twins.conforming import conform
from demheat.terminal.slices import plane
from references import exact, fem, fft, multipole
from references.fft.zeta import zeta2

HUGE = 10**12
SLAB, CELL = gallery.slab(), gallery.simple_cubic()
IN_TIME = Scene((0.1, 0.1, 0.1), Material(33.0, 7800.0, 900.0), walls={"y-": 25.0, "y+": 35.0}, initial=25.0)
WIRE = MovingCylinder(axis=2, diameter=1e-13, power_density=1.0, start=(0.05, 0.05), velocity=(0.01, 0.0))
SCATTERED = make_packing(np.random.default_rng(0).random((99, 3)) * CELL.size, np.full(99, 1e-9), CELL.size, True, {})
REQUESTS = {
    "particles = 1000000000000: takes": lambda: solve(SLAB, particles=HUGE),
    "particles = 100000000000...": lambda: evolve(IN_TIME, [1.0], particles=10**300),
    "number = 1000000000000: takes": lambda: relax(HUGE),
    "steps = 100000000000...": lambda: relax(100, steps=10**400),
    "steps = 1000000000000: takes": lambda: settle(relax(100), steps=HUGE),
    "number = 100000000000...": lambda: lsa(10**300),
    "pressure = 1e+300: must be >= 10 and <= 1e+12": lambda: lsa(100, pressure=1e300),
    "growth = 1e+300: must be a rate": lambda: lsa(100, growth=1e300),
    "growth = 1e-06: takes some 1.8e+07 collisions": lambda: lsa(1000, growth=1e-6),
    "growth = 1e-09: takes some 3.9e+09 collisions": lambda: lsa(1000, phi=0.3, growth=1e-9),
    "growth = 1e-300: takes some": lambda: lsa(100, phi=0.3, growth=1e-300),
    "growth = [[0.0, 0.02], [1000.0, 1e-09]]: takes": lambda: lsa(1000, growth=[(0, 0.02), (1e3, 1e-9)]),
    "repeats = [10000, 10000, 10000]: takes": lambda: replicate(relax(100), (10_000,) * 3),
    "replicas = 10000: makes": lambda: solve(SLAB, replicas=10_000),
    "n = 1000000: takes": lambda: plane(SLAB, axis=0, at=0.05, n=10**6),
    "n = 100000000000...": lambda: plane(SLAB, axis=0, at=0.05, n=10**200),
    "count = 1000000000000: takes": lambda: gallery.dispersion(HUGE),
    "count = 1000000000000: takes ": lambda: gallery.random_dispersion(HUGE, diameter=1e-5),
    "voxels = 1290: takes": lambda: fft.solve(CELL, voxels=1290),
    "voxels = 1280: takes": lambda: zeta2(CELL, voxels=1280),
    "threads = 1000000000: must": lambda: fft.solve(CELL, threads=10**9),
    "threads = 1000000000: must ": lambda: multipole.solve(CELL, threads=10**9),
    "points_per_axis = 100000: takes": lambda: exact.solve(SLAB, points_per_axis=10**5),
    "points_per_axis = 100000: takes ": lambda: multipole.solve(CELL, points_per_axis=10**5),
    "step = 1e-300: takes inf": lambda: evolve(IN_TIME, [1e10], step=1e-300),
    "step = 1e-12: takes": lambda: evolve(IN_TIME, [1.0], step=1e-12),
    "step = 1e-12: takes ": lambda: next(fem.evolve(IN_TIME, [1.0], step=1e-12)),
    "times, the last = 1000000000000.0: takes": lambda: next(
        evolve(IN_TIME, [1e12], particles=300, integrator="euler")
    ),
    "Scene.sources: diameter over velocity, s = 1e-11: takes": lambda: list(
        evolve(replace(IN_TIME, sources=[WIRE]), [1.0], particles=300)
    ),
    "times, the last = 1000000000000.0: takes ": lambda: next(
        evolve(IN_TIME, [1e12], particles=300, integrator="rkl2")
    ),
    "packing: of mean radius 1e-09 m, by which interfaces would have": lambda: conform(SCATTERED, CELL),
    "packing: of mean radius 1e-40 m, by which interfaces would have": lambda: conform(
        SCATTERED._replace(radii=np.full(99, 1e-40)), CELL
    ),
    "times, the last = 1e+30: takes": lambda: next(evolve(IN_TIME, [1e30], particles=300, integrator="rkl2")),
}


def test_twins_beyond_memory_are_refused(monkeypatch):
    """In a gap of a quarter of a particle there are many more twins than particles were asked for; none is made."""
    monkeypatch.setattr("demheat.packing.twins.patterns.thinned", None)
    monkeypatch.setattr("demheat.runtime.limits.SMALL", 0)
    monkeypatch.setattr("demheat.runtime.limits.free_memory", lambda: 1e6)
    plates = [Box((x, 0.5, 0.5), (0.2, 0.6, 0.6), Material(10.0)) for x in (0.39, 0.61)]
    scene = Scene((1.0, 1.0, 1.0), Material(1.0), plates, walls={"x-": 0.0, "x+": 1.0})
    with pytest.raises(ValueError, match=r"^twins, most of them in narrow gaps, = [0-9]+: takes"):
        solve(scene, particles=1000)


@pytest.mark.parametrize("said", REQUESTS)
def test_too_much_is_refused(said, monkeypatch):
    # What is refused here is so on any machine up to 32 GiB: larger ones are not asked.
    monkeypatch.setattr("demheat.runtime.limits.free_memory", lambda: 2.0**35)
    with pytest.raises(ValueError, match="^" + re.escape(said.strip())):
        REQUESTS[said]()
