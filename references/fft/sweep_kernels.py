"""Numba kernels that take columns of modes to a buffer, where each lies in one piece, and put them back."""

import numba

import demheat.runtime.compiled  # noqa: F401 (where compiled kernels are kept)

compiled = numba.njit(cache=True, nogil=True)

# Values of a column moved at a time: a cache line or more of each of the buffer's rows.
TILE = 8


@compiled
def take(modes, buffer, first, count):
    """buffer[c, r, i] = modes[c, i, first + r].

    modes : (components, mx, columns) complex or float array
    buffer : (components, count or more, mx) complex or float array; out
    first, count : int
    """
    for component in range(modes.shape[0]):
        source, target = modes[component], buffer[component]
        for low in range(0, source.shape[0], TILE):
            high = min(low + TILE, source.shape[0])
            for r in range(count):
                for i in range(low, high):
                    target[r, i] = source[i, first + r]


@compiled
def put(modes, buffer, first, count):
    """modes[c, i, first + r] = buffer[c, r, i].

    modes, buffer, first, count : see `take`; out: `modes`
    """
    for component in range(modes.shape[0]):
        target, source = modes[component], buffer[component]
        for low in range(0, target.shape[0], TILE):
            high = min(low + TILE, target.shape[0])
            for r in range(count):
                for i in range(low, high):
                    target[i, first + r] = source[r, i]
