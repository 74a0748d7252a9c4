"""One integrator on one body: its work, its temporal error and, for explicit Euler, its share of the memory bandwidth.

The sphere is that of Haddad et al. (Int. J. Thermal Sciences 164, 2021, 106799), figure 7: diameter 0.1 m, 20 C, its
surface at 200 C from time 0 on.
"""

import time

import numpy as np

from demheat import referee
from demheat.conduction import transient
from demheat.conduction.integrators import control, euler, march
from demheat.conduction.integrators.spectrum import spectrum
from demheat.conduction.integrators.system import initial_state, semi_discrete
from demheat.dem.networks import network_of
from demheat.laws import Laguerre
from demheat.packing.cache import relaxed
from demheat.scene import Material, Scene
from demheat.scene.functions import initial_at
from studies.common.slab import packing_of, slab
from studies.harness.cost import measured, triad_gbs
from studies.harness.provenance import threads

ENDS = {"slab": 0.2, "sphere": 10.0}
# The reference is this much finer than the row's own accuracy, and never coarser than the least error of interest.
FINER, COARSEST = 30.0, 1e-5
# Steps of Euler timed where a whole run would take a quarter of an hour.
SAMPLE, MOST_STEPS = 400, 12_000


def system_of(body, particles):
    """Balance of a body's Laguerre network, and its temperatures at time 0."""
    if body == "slab":
        scene, packing = slab(), packing_of(particles)
    else:
        metal = Material(185.0, density=2700.0, heat_capacity=900.0)
        scene = Scene(size=(0.1,) * 3, matrix=metal, domain="sphere", walls={"round": 200.0}, initial=20.0)
        packing = relaxed(particles, size=scene.size, periodic=False, domain="sphere", seed=0)
    network = network_of(scene, packing, Laguerre())
    start = initial_at(scene, network.centers)
    return semi_discrete(network, scene, transient.capacities(network, scene), level=float(start.mean())), start


def marched(body, particles, integrator, accuracy):
    """Run one integrator to the end and say what it cost and how far off it is."""
    system, start = system_of(body, particles)
    if integrator == "euler":
        return _euler(system, start, ENDS[body])
    states, cost = measured(_integrated, system, start, ENDS[body], integrator, accuracy)
    return {**cost, **_described(system, start, ENDS[body], states, accuracy)}


def _integrated(system, start, end, integrator, accuracy):
    return list(march.integrate(system, start, [end], integrator=integrator, accuracy=accuracy))[-1]


def _described(system, start, end, state, accuracy):
    finest = min(accuracy / FINER, COARSEST)
    right = _integrated(system, start, end, "tr-bdf2", finest).temperature
    span = float(np.ptp(np.append(start - system.level, system.held_at(end))))
    names = ("steps", "rejected", "stages", "iterations", "residual", "unknowns", "energy_error", "spectral_ratio")
    row = {name: state.stats[name] for name in names} | {"taken": state.stats["integrator"]}
    error = referee.rms(referee.value_error(state.temperature, right, scale=1.0)) / span
    return row | {"error_percent": 100 * error, "reference": finest, "extrapolated": False}


def _euler(system, start, end):
    """Explicit Euler at its limit; over a few hundred steps only where a whole run takes too many."""
    limit = spectrum(system).limit
    count = int(np.ceil(end / limit))
    kernel = _kernel_speed(system, start, limit)
    if count <= MOST_STEPS:
        state, cost = measured(_integrated, system, start, end, "euler", 1e-3)
        return {**cost, **_described(system, start, end, state, 1e-3), **kernel}
    state, cost = measured(_integrated, system, start, SAMPLE * limit, "euler", 1e-3)
    cost |= {name: cost[name] * count / SAMPLE for name in ("wall_s", "cpu_s")}
    stats = state.stats
    row = {name: stats[name] for name in ("energy_error", "spectral_ratio", "unknowns", "residual", "iterations")}
    return {**cost, **row, **kernel, "taken": "euler", "steps": count, "stages": count, "extrapolated": True}


def _kernel_speed(system, start, limit):
    """Best of several chunks of Euler steps: particle-steps per second and bytes moved over the triad's."""
    advance, x = euler.stepper(system, None), initial_state(system, start, 0.0)
    span = control.span_of(system, x)
    steps = max(3, 3_000_000 // len(x))
    best, triad = np.inf, 0.0
    # In turns, so that what else the machine does meanwhile slows both.
    for _ in range(6):
        begin = time.perf_counter()
        next(control.fixed_steps(advance, system, x.copy(), [steps * limit], step=limit, span=span))
        best = min(best, (time.perf_counter() - begin) / steps)
        triad = max(triad, triad_gbs(threads=threads(), repeats=2))
    # Each link: conductance and index; each node: row pointer, temperature old and new, inverse capacity, heat.
    moved = 12 * len(system.links.indices) + 40 * len(x)
    return {
        "million_particle_steps": 1e-6 * system.particles / best,
        "bandwidth_gbs": 1e-9 * moved / best,
        "bandwidth_share": 1e-9 * moved / best / triad,
        "triad_then_gbs": triad,
    }
