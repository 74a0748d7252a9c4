"""What pores leave of a network: bodies of conducting particles, and those that no heat can pass in a steady state.

Pores are phases of conductivity 0. Without them, and without damage, nothing here is asked: networks are one body.
"""

from typing import NamedTuple

import numpy as np

from demheat.conduction import components_kernels as kernels
from demheat.network.base import SIDES
from demheat.network.links_kernels import links_of
from demheat.runtime.progress import stage

# Particles of one compiled call: a tenth of a second.
BLOCK = 500_000


class Bodies(NamedTuple):
    """Bodies of a network with pores, and their temperatures where these need no solving."""

    label: np.ndarray  # (n,) int32 array: Body of each particle; -1 in pores
    # (n,) bool array: Particles that no heat passes: pores, and bodies that reach one temperature or none, or in a
    # periodic cell do not join their own images up the mean gradient
    still: np.ndarray
    # (n,) float array, K: Of bodies that no heat passes: that of the wall that they reach; in a periodic cell constant
    # over the body, less the linear field of the mean gradient, with zero mean over the body. NaN in pores, where no
    # wall is reached, and where heat passes
    temperature: np.ndarray


def bodies(network, scene):
    """Bodies of a network; None if all phases and links conduct."""
    conductivity = scene.conductivities
    if conductivity.min() > 0 and network.whole:
        return None
    solid = conductivity[network.phase] > 0
    gradient = np.array(scene.gradient if scene.periodic else (0.0, 0.0, 0.0))
    found, count = gathered(network, solid, gradient * network.size)
    if scene.periodic:
        passing = found.climbs[:count]
    else:
        passing, level = _at_walls(network, scene, found.label, count)
    still = np.append(~passing, True)[found.label]
    if scene.periodic:
        temperature, here = np.full(len(solid), np.nan), np.flatnonzero(still & solid)
        path = network.centers[here] + found.shift[here] * network.size
        temperature[here] = -(path @ gradient)
        level_off(temperature, np.where(still, found.label, -1), network.volumes)
    else:
        temperature = np.append(np.where(passing, np.nan, level), np.nan)[found.label]
    return Bodies(found.label, still, temperature)


def level_off(temperature, label, volumes):
    """Take off each body its mean, in place."""
    count = label.max(initial=-1) + 1
    kernels.level_off(temperature, label, volumes, np.zeros(count), np.zeros(count))


def gathered(network, solid, jump):
    """What the search finds, and the number of bodies."""
    n, state = len(solid), np.zeros(4, dtype=np.int64)
    found = kernels.Found(
        label=np.where(solid, np.int32(kernels.OPEN), np.int32(kernels.NONE)),
        shift=np.zeros((n, 3), np.int16),
        climbs=np.zeros(n, bool),
        queue=np.empty(n, np.uint32),
    )
    with stage("components") as done:
        while kernels.gather(links_of(network), network.image, jump, found, state, BLOCK):
            done(state[0] / n)
    return found, int(state[3])


def _at_walls(network, scene, label, count):
    """Which bodies pass heat, by what their walls impose; the temperature of the wall that a body reaches, else NaN."""
    low, high, fed = np.full(count, np.inf), np.full(count, -np.inf), np.zeros(count, bool)
    body = label[network.wall_particle]
    for name, value in scene.imposed_temperatures.items():
        here = (network.wall_side == SIDES.index(name)) & (network.wall_conductance > 0) & (body >= 0)
        low[body[here]] = np.minimum(low[body[here]], value)
        high[body[here]] = np.maximum(high[body[here]], value)
    for name, value in scene.wall_fluxes.items():
        here = (network.wall_side == SIDES.index(name)) & (network.wall_area > 0) & (body >= 0)
        fed[body[here]] |= value != 0
    return fed | (high > low), np.where(np.isfinite(low), low, np.nan)
