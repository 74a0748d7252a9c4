"""Compiled search of a network for bodies: particles that conducting links join, over any number of others."""

from typing import NamedTuple

import numpy as np
from numba import njit

# Labels of particles that are looked for, and of those that belong to no body.
OPEN, NONE = -2, -1
# Of the rises that cancel in a sum: those of a closed way across the mean gradient leave rounding only.
ROUNDING = 1e-12


class Found(NamedTuple):
    """Bodies of a network, as far as they are known."""

    label: np.ndarray  # (n,) int32 array: Body of each particle; OPEN before it is known, NONE outside all
    # (n, 3) int16 array: Boxes by which a particle is moved to where its body reaches it from its first particle
    shift: np.ndarray
    # (n,) bool array: Of the first entries, one for each body: whether a way in it back to the same particle, across
    # the box, rises with the mean gradient
    climbs: np.ndarray
    queue: np.ndarray  # (n,) uint32 array: Particles in the order in which they are found


@njit(cache=True)
def gather(links, image, jump, found, state, most):
    """Go on with the search for bodies, through at most so many particles.

    links : Links
    image : (m,) uint8 array; which periodic image of its other end each link leads to, see `Facets`
    jump : (3,) float array, K; rise of the mean temperature over the box along each axis
    found : Found; in and out
    state : (4,) int64 array; zeros at first: particles done, in the queue, looked at as first ones; bodies. In and out
    most : int
    Returns bool: whether anything is left to do
    """
    indptr, indices, conductance = links
    label, shift, climbs, queue = found.label, found.shift, found.climbs, found.queue
    head, tail, seed, bodies = state[0], state[1], state[2], state[3]
    end = head + most
    while head < end:
        if head == tail:
            while seed < len(label) and label[seed] != OPEN:
                seed += 1
            if seed == len(label):
                break
            label[seed], queue[tail] = bodies, seed
            bodies, tail = bodies + 1, tail + 1
        i = queue[head]
        head += 1
        body = label[i]
        climbing = climbs[body]
        x, y, z = shift[i, 0], shift[i, 1], shift[i, 2]
        for e in range(indptr[i], indptr[i + 1]):
            j = indices[e]
            # Where links lead is worked out for few: mostly both ends are known, of a body that climbs.
            known = label[j] != OPEN
            if (known and (climbing or label[j] == NONE)) or conductance[e] <= 0.0:
                continue
            code = np.int64(image[e])
            u, v, w = x + code // 9 - 1, y + code // 3 % 3 - 1, z + code % 3 - 1
            if not known:
                label[j], queue[tail] = body, j
                tail += 1
                shift[j, 0], shift[j, 1], shift[j, 2] = u, v, w
                continue
            u, v, w = u - shift[j, 0], v - shift[j, 1], w - shift[j, 2]
            if u != 0 or v != 0 or w != 0:
                climbing = _climbs(u * jump[0], v * jump[1], w * jump[2])
        climbs[body] = climbing
    state[0], state[1], state[2], state[3] = head, tail, seed, bodies
    return head < tail or seed < len(label)


@njit(cache=True)
def _climbs(rise_x, rise_y, rise_z):
    """Whether rises along x, y and z do not cancel."""
    return abs(rise_x + rise_y + rise_z) > ROUNDING * (abs(rise_x) + abs(rise_y) + abs(rise_z))


@njit(cache=True)
def level_off(temperature, label, volumes, total, mass):
    """Take off each body its mean, in place.

    temperature : (n,) float array, K
    label : (n,) int array; body of each particle; negative in none
    volumes : (n,) float array, m3
    total, mass : (number of bodies,) float arrays; zeros at first: sums of volume times temperature, and of volumes
    """
    for i in range(len(label)):
        if label[i] >= 0:
            total[label[i]] += volumes[i] * temperature[i]
            mass[label[i]] += volumes[i]
    for i in range(len(label)):
        if label[i] >= 0:
            temperature[i] -= total[label[i]] / mass[label[i]]
