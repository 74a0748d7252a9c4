"""Where the DEM's error of a conductivity comes from: the energy of the exact temperature, and that of what is off it.

The network minimises the power of temperatures at its particles. With u the exact temperature there, v what it finds,
P the power and K, K_h the exact conductivity and its own (unit volume and gradient):

    K_h - K = (P(u) - K) - P(u - v).

The first is what quadrature by two-point fluxes makes of the exact temperature, signed; the second is how far the
network's temperature is from the exact one, in energy, and always lowers the conductivity.
"""

from functools import cache

import numpy as np

from demheat import Laguerre
from demheat.conduction.steady import solve_steady
from demheat.dem.networks import network_of
from demheat.packing.tile import tiled
from demheat.referee import value_error
from demheat.sampling.field_of import field_of
from demheat.scene import Layer, Material, Scene, Sphere
from references import exact, multipole
from studies.harness.cells import cell
from studies.tuning.constants import constant_set

# Packings of these seeds are those of no drawn scene.
FIRST_SEED = 100
RADIUS = 1 / 3
# What is asked of the witness, and of the network's solver: a thousandth of the smallest error of the rows.
ACCURACY, TOLERANCE = 1e-8, 1e-10
INCLINED = (0.48, 0.6, 0.64)


def sphere(contrast):
    """A sphere in a periodic cell, as large as that of the benchmark, under a gradient along no axis."""
    inclusion = Sphere((0.5, 0.5, 0.5), RADIUS, Material(contrast))
    return Scene((1.0, 1.0, 1.0), Material(1.0), [inclusion], gradient=INCLINED)


def layer(contrast):
    """A layer, whose interfaces are flat, under the same gradient."""
    return Scene((1.0, 1.0, 1.0), Material(1.0), [Layer(1, 0.21, 0.57, Material(contrast))], gradient=INCLINED)


@cache
def _solution(shape, contrast):
    scene = {"sphere": sphere, "layer": layer}[shape](contrast)
    return scene, multipole.solve(scene, accuracy=ACCURACY) if shape == "sphere" else exact.solve(scene)


def decomposed(shape, contrast, particles, packings, *, constant=None, factor=1.0):
    """Errors of the conductivity, and their two parts, on several packings; all in per cent of the exact one."""
    scene, known = _solution(shape, contrast)
    parts = []
    for seed in range(FIRST_SEED, FIRST_SEED + packings):
        with constant_set(constant, factor):
            network = network_of(scene, tiled(particles, size=scene.size, seed=seed), Laguerre(), seed=seed)
        parts.append(_parts(scene, known, network, particles))
    columns = {name: cell([part[name] for part in parts], ".6g") for name in parts[0]}
    return columns | {"unknowns": len(network.volumes)}


def _parts(scene, known, network, particles):
    found = field_of(scene, network, solve_steady(network, scene, tolerance=TOLERANCE), stats={})
    right, gradient = known.temperature_at(network.centers), np.array(scene.gradient)
    off = found.samples.temperature - right
    power = _powers(network, off, np.zeros(3))
    # Twins stand half a mean radius from the interface; other particles begin further out.
    radius = (3 * 0.64 / (4 * np.pi * particles)) ** (1 / 3)
    twin = np.abs(_distance(scene, network.centers)) < 0.55 * radius
    row = np.repeat(np.arange(len(twin)), np.diff(network.indptr))
    beside = twin[row] | twin[network.indices]
    k, exactly = known.conductivity, [1 - sum(known.fractions[1:]), *known.fractions[1:]]
    return {
        "error": 100 * value_error(found.conductivity, k),
        "quadrature": 100 * value_error(_powers(network, right, gradient).sum(), k),
        "misfit": 100 * power.sum() / k,
        "misfit_beside": 100 * power[beside].sum() / k,
        "volume": 100 * value_error(float(sum(found.fractions[1:])), float(sum(exactly[1:]))),
    }


def _distance(scene, points):
    return scene.inclusions[0].distance(points, period=scene.period)


def _powers(network, potential, gradient):
    """Power of each link under a temperature and a mean gradient, half for either end, (m,) float array, W K."""
    row, code = np.repeat(np.arange(len(network.volumes)), np.diff(network.indptr)), network.image.astype(int)
    image = np.stack([code // 9 - 1, code // 3 % 3 - 1, code % 3 - 1], axis=1) * network.size
    jump = potential[network.indices] - potential[row] + image @ gradient
    return 0.5 * network.conductance * jump**2
