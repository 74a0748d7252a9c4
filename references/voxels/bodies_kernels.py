"""Compiled search of a grid for bodies: voxels that open faces join, over any number of others."""

from typing import NamedTuple

import numpy as np
from numba import njit

# Labels of voxels that are looked for, and of those that belong to no body.
OPEN, NONE = -2, -1
# Of the rises that cancel in a sum: those of a closed way across the mean gradient leave rounding only.
ROUNDING = 1e-12


class Found(NamedTuple):
    """Bodies of a grid, as far as they are known."""

    label: np.ndarray  # (nx, ny, nz) int32 array: Body of each voxel; OPEN before it is known, NONE outside all
    # (n, 3) int16 array: Boxes by which each voxel, in flat order, is moved to where its body reaches it from its first
    # voxel
    shift: np.ndarray
    # (n,) bool array: Of the first entries, one for each body: whether a way in it back to the same voxel, across the
    # box, rises with the mean gradient
    climbs: np.ndarray
    queue: np.ndarray  # (n,) int32 array: Voxels in the order in which they are found


@njit(cache=True)
def gather(below, periodic, jump, found, state, most):
    """Go on with the search for bodies, through at most so many voxels.

    below : tuple of three (nx, ny, nz) bool arrays; for each axis whether heat passes the face between a voxel and the
      one before it, around the box
    periodic : bool; whether faces of the box count
    jump : (3,) float array, K; rise of the mean temperature over the box along each axis
    found : Found; in and out
    state : (4,) int64 array; zeros at first: voxels done, in the queue, looked at as first ones; bodies. In and out
    most : int
    Returns bool: whether anything is left to do
    """
    shape = np.array(found.label.shape)
    label, shift, climbs, queue = found.label.reshape(-1), found.shift, found.climbs, found.queue
    head, tail, seed, bodies = state[0], state[1], state[2], state[3]
    end = head + most
    place, step = np.empty(3, np.int64), np.empty(3, np.int64)
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
        for side in range(6):
            axis, up = side // 2, side % 2
            place[0], rest = divmod(i, shape[1] * shape[2])
            place[1], place[2] = divmod(rest, shape[2])
            step[:] = 0
            edge = place[axis] == (shape[axis] - 1 if up else 0)
            if edge and not periodic:
                continue
            if edge:
                step[axis] = 1 if up else -1
            x, y, z = place[0], place[1], place[2]
            place[axis] = (place[axis] + (1 if up else -1)) % shape[axis]
            if up:
                x, y, z = place[0], place[1], place[2]
            # The face belongs to the upper one of the two.
            if axis == 0:
                passes = below[0][x, y, z]
            elif axis == 1:
                passes = below[1][x, y, z]
            else:
                passes = below[2][x, y, z]
            if not passes:
                continue
            j = (place[0] * shape[1] + place[1]) * shape[2] + place[2]
            if label[j] == OPEN:
                label[j], queue[tail] = label[i], j
                tail += 1
                for k in range(3):
                    shift[j, k] = shift[i, k] + step[k]
            elif label[j] != NONE and not climbs[label[i]]:
                rise, size = 0.0, 0.0
                for k in range(3):
                    part = (shift[i, k] + step[k] - shift[j, k]) * jump[k]
                    rise, size = rise + part, size + abs(part)
                climbs[label[i]] = abs(rise) > ROUNDING * size
    state[0], state[1], state[2], state[3] = head, tail, seed, bodies
    return head < tail or seed < len(label)
