"""Small networks on which integrators are tried."""

from functools import cache

import numpy as np

from demheat import Flux, Material, Scene
from demheat.conduction.integrators.system import semi_discrete
from demheat.conduction.transient import capacities
from demheat.dem.networks import network_of as built
from demheat.laws import Calibrated, Laguerre
from demheat.packing.cache import relaxed
from demheat.packing.radii import Bidisperse, Gaussian

MATERIAL = Material(2.0, density=3.0, heat_capacity=5.0)
BOX = (1.0, 1.0, 1.0)
JUMP = Scene(size=BOX, matrix=MATERIAL, walls={"y-": 25.0, "y+": 35.0}, initial=25.0)
# Smooth in space and time: a wall whose temperature swings, a flux that does, the other walls insulated.
SWINGING = Scene(
    size=BOX,
    matrix=MATERIAL,
    walls={"y-": lambda t: 4.0 + np.sin(3.0 * t), "x+": Flux(lambda t: 6.0 + 5.0 * np.cos(4.0 * t))},
    initial=lambda x: 4.0 + np.sin(0.5 * np.pi * x[:, 1]),
)
KINDS = ("laguerre", "ten", "calibrated")


@cache
def network_of(kind, number=600, seed=1):
    """Network of a kind: Laguerre; the same with spheres of size ratio 10; contacts, some with two links only."""
    radii = Bidisperse(10.0, 0.003) if kind == "ten" else Gaussian()
    packing = relaxed(number, size=BOX, periodic=False, seed=seed, radii=radii)
    return built(JUMP, packing, Calibrated() if kind == "calibrated" else Laguerre())


@cache
def system_of(kind, number=600):
    """Balance of a network of a kind, heated at once; contacts have their wall particles held, as in the papers."""
    network = network_of(kind, number)
    held_centers = np.ones(len(network.volumes), dtype=bool) if kind == "calibrated" else None
    return semi_discrete(network, JUMP, capacities(network, JUMP), held_centers=held_centers)


def dense(system):
    """Conductance matrix of all nodes, (N, N) float array, from the rows one by one."""
    a = np.zeros((len(system.capacity),) * 2)
    for i in range(len(a)):
        for e in range(system.links.indptr[i], system.links.indptr[i + 1]):
            a[i, system.links.indices[e]] -= system.links.conductance[e]
            a[i, i] += system.links.conductance[e]
    return a
