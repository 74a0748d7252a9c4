"""The three benchmarks: each as a scene, with the point that is asked for and the exact temperature."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from demheat.scene import STEFAN_BOLTZMANN, Convection, Material, Radiation, Scene
from references.exact.benchmarks import convecting_plate, radiating_end, swinging_end

HOT, AROUND, EMISSIVITY, STEEL = 1000.0, 300.0, 0.98, 55.563
PERIOD, SWING, WHEN = 80.0, 100.0, 32.0
BASE, FILM, PLATE, WIDTH, HEIGHT = 100.0, 750.0, 52.0, 0.6, 1.0
# All are flat: so thick, m, with insulated sides.
THICK, LENGTH = 0.2, 0.1
# Part of the plate's height next to its base that errors over the plate leave out: series end early above it.
ABOVE = 0.05
POINTS, SEED = 2000, 11


class Problem(NamedTuple):
    """A benchmark."""

    scene: Scene
    time: float | None  # s, or None: When the temperature is asked for; None in a steady state
    point: tuple[float, float, float]  # (3,) tuple of float, m: Where
    span: float  # K: That the load imposes
    exact: Callable  # callable (n, 3) float array, m -> (n,) float array, K or degrees Celsius

    def points(self):
        """Points over the body at which errors are taken, (n, 3) float array, m."""
        part = np.random.default_rng(SEED).random((POINTS, 3))
        part[:, 1] = ABOVE + (1 - ABOVE) * part[:, 1]
        return part * self.scene.size


def problem(name) -> Problem:
    """One of "T2", "T3" and "T4"."""
    return {"T2": _radiating, "T3": _swinging, "T4": _plate}[name]()


def _radiating():
    walls = {"x-": HOT, "x+": Radiation(EMISSIVITY, AROUND)}
    end = radiating_end(LENGTH, STEEL, HOT, EMISSIVITY * STEFAN_BOLTZMANN, AROUND)
    scene = Scene((LENGTH,) * 3, Material(STEEL), walls=walls)
    middle = LENGTH / 2

    def exact(points):
        return HOT + (end - HOT) * points[:, 0] / LENGTH

    return Problem(scene, None, (LENGTH, middle, middle), HOT - AROUND, exact)


def _swinging():
    rate, metal = 2 * math.pi / PERIOD, Material(35.0, density=7200.0, heat_capacity=440.5)
    diffusivity = metal.conductivity / (metal.density * metal.heat_capacity) / LENGTH**2
    walls = {"x-": 0.0, "x+": lambda time: SWING * math.sin(rate * time)}
    scene = Scene((LENGTH,) * 3, metal, walls=walls, initial=0.0)

    def exact(points):
        return SWING * swinging_end(points[:, 0] / LENGTH, WHEN, diffusivity=diffusivity, rate=rate)

    return Problem(scene, WHEN, (0.08, LENGTH / 2, LENGTH / 2), SWING, exact)


def _plate():
    film = Convection(FILM, 0.0)
    scene = Scene((WIDTH, HEIGHT, THICK), Material(PLATE), walls={"y-": BASE, "x+": film, "y+": film})

    def exact(points):
        x, y = points[:, 0], points[:, 1]
        return BASE * convecting_plate(x, y, width=WIDTH, height=HEIGHT, film=FILM / PLATE)

    return Problem(scene, None, (WIDTH, 0.2, THICK / 2), BASE, exact)
