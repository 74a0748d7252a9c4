"""Fourier transforms of a field in two sweeps over it, with room for other work on what is in the cache meanwhile.

A transform in three dimensions reads and writes the whole field once or more per axis, and memory is what large grids
wait for. Here one sweep transforms blocks of planes along y and z; the other takes columns of modes along x into a
buffer that fits the cache, transforms them, lets a kernel change them, transforms them back and puts them back. A
kernel between two sweeps over planes, and one between the two transforms of a column, then touch memory no more.
"""

from collections.abc import Callable, Sequence
from time import perf_counter
from typing import NamedTuple

import numpy as np

from references.fft import sweep_kernels as kernels
from references.threads import Team

# Of all components of a block of planes, and of a buffer of columns: half of a second-level cache of 2 MB.
BLOCK_BYTES = 2**20
# Blocks that a grid is divided into at least, so that threads share them evenly.
BLOCKS = 16


class Plans(NamedTuple):
    """Transforms there and back, one per component: callables (source, target), in place."""

    forward: Sequence[Callable]
    backward: Sequence[Callable]


class Worker(NamedTuple):
    """What one thread needs for itself."""

    planes: dict  # By the number of planes in a block: callables (values, modes) and back
    buffer: np.ndarray  # (components, columns, mx) complex or float array
    columns: Plans  # Callables () that transform each component of the buffer along its last axis


class Transform:
    """A field of one or more components and what transforms it in place; neither way is normalised."""

    def __init__(self, real, modes, scale, depth, threads, worker):
        self.real, self.modes, self.scale, self.seconds = real, modes, scale, 0.0
        self._depth, self._team = depth, Team(threads)
        self._block, self._count = _shares(modes)
        self._workers = [worker(self._sizes(), self._count) for _ in range(threads)]

    def forward(self):
        """Fill `modes` from `real`."""
        self.planes(forward=True)
        self.columns(backward=False)

    def backward(self):
        """Fill `real` from `modes`."""
        self.columns(forward=False)
        self.planes(backward=True)

    def planes(self, kernel=None, *arguments, backward=False, forward=False):
        """Block by block: transform back along y and z, call kernel(*arguments, low, high), transform along y and z."""
        job = (kernel, arguments, backward, forward)
        self._share(self._planes, job, -(-self.modes.shape[1] // self._block))

    def columns(self, kernel=None, *arguments, forward=True, backward=True):
        """Some columns at a time: transform along x, call kernel(rows, first, count, *arguments), transform back."""
        job = (kernel, arguments, forward, backward)
        self._share(self._columns, job, -(-self.modes[0, 0].size // self._count))

    def _sizes(self):
        """Numbers of planes that blocks have."""
        planes = self.modes.shape[1]
        return {min(self._block, planes), planes % self._block or self._block}

    def _share(self, function, job, count):
        spent = []

        def part(low, high):
            worker = self._workers.pop()
            spent.append(function(worker, *job, low, high))
            self._workers.append(worker)

        self._team.run(part, count)
        self.seconds += sum(spent) / len(spent)

    def _planes(self, worker, kernel, arguments, backward, forward, low, high):
        seconds, planes = 0.0, self.modes.shape[1]
        for first in range(low * self._block, min(high * self._block, planes), self._block):
            last = min(first + self._block, planes)
            plans = worker.planes[last - first]
            values, modes = self.real[:, first:last, :, : self._depth], self.modes[:, first:last]
            if backward:
                seconds += _timed(plans.backward, modes, values)
            if kernel:
                kernel(*arguments, first, last)
            if forward:
                seconds += _timed(plans.forward, values, modes)
        return seconds

    def _columns(self, worker, kernel, arguments, forward, backward, low, high):
        seconds, buffer, size = 0.0, worker.buffer, self.modes[0, 0].size
        modes = self.modes.reshape(*self.modes.shape[:2], size)
        rows = buffer.view(self.real.dtype)
        for first in range(low * self._count, min(high * self._count, size), self._count):
            count = min(self._count, size - first)
            start = perf_counter()
            kernels.take(modes, buffer, first, count)
            if forward:
                _all(worker.columns.forward)
            seconds += perf_counter() - start
            if kernel:
                kernel(rows, first, count, *arguments)
            start = perf_counter()
            if backward:
                _all(worker.columns.backward)
            kernels.put(modes, buffer, first, count)
            seconds += perf_counter() - start
        return seconds


def _shares(modes):
    """Planes in a block and columns in a buffer."""
    components, mx, my, mz = modes.shape
    plane, column = components * my * mz * modes.itemsize, components * mx * modes.itemsize
    block = max(1, min(BLOCK_BYTES // plane, mx // BLOCKS))
    return block, max(1, min(BLOCK_BYTES // column, my * mz // BLOCKS))


def _timed(plans, sources, targets):
    start = perf_counter()
    for plan, source, target in zip(plans, sources, targets, strict=True):
        plan(source, target)
    return perf_counter() - start


def _all(plans):
    for plan in plans:
        plan()
