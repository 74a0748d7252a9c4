"""Transforms of a field that ranks share by slabs, the one home of mpi4py-fft.

Planes across the first axis are shared out, of modes those across the second. Along the other axes each rank transforms
alone; then all exchange, and transform along the first. What is longer in the first half of the exchange stays as it
is, the rest is done in place.
"""

import math
from functools import partial
from time import perf_counter

import numpy as np

# The last group is transformed first; of its axes the last is halved, and shared out after the exchange.
AXES = ((0,), (2, 1))
# Measured plans would differ from run to run, and sums with them.
EFFORT = "FFTW_ESTIMATE"


class Pencils:
    """A rank's part of a field and of its modes, and what transforms all parts; neither way is normalised."""

    def __init__(self, shape, walls, comm):
        from mpi4py_fft import PFFT, fftw
        from mpi4py_fft.pencil import Subcomm

        if walls:
            kinds = ((0,), fftw.dstn, fftw.idstn), ((2, 1), fftw.dctn, fftw.idctn)
            ways = {axes: (_in_place(there, type=1), _in_place(back, type=1)) for axes, there, back in kinds}
            self.scale = math.prod(1.0 / (2 * (n + side)) for n, side in zip(shape, (1, -1, -1), strict=True))
        else:
            ways = {(0,): (_in_place(fftw.fftn), _in_place(fftw.ifftn))}
            self.scale = 1.0 / math.prod(shape)
        ranks = Subcomm(comm, (comm.size, 1, 1), reorder=False)
        self._plan = PFFT(ranks, shape, axes=AXES, dtype=float, transforms=ways, planner_effort=EFFORT)
        self.real, self.modes = self._plan.forward.input_array, self._plan.forward.output_array
        self.counts, self.rows = self._plan.global_shape(True), self._plan.local_slice(True)[1]
        self.seconds = 0.0

    def forward(self):
        """Fill `modes` from `real`, which is lost."""
        self._timed(partial(self._plan.forward, normalize=False))

    def backward(self):
        """Fill `real` from `modes`, which are lost."""
        self._timed(self._plan.backward)

    def free(self):
        """Give back what MPI keeps of it."""
        self._plan.destroy()

    def _timed(self, transform):
        start = perf_counter()
        transform()
        self.seconds += perf_counter() - start


def share(number: int, ranks: int, rank: int) -> tuple[int, int]:
    """First and end of a rank's own of so many planes: as equal as they can be, larger ones first."""
    each, more = divmod(number, ranks)
    first = rank * each + min(rank, more)
    return first, first + each + (rank < more)


def most_ranks(shape: tuple, walls: bool) -> int:
    """So many ranks have planes of values and rows of modes each."""
    return min(shape[0], shape[1] if walls else shape[1] // 2 + 1)


def divide(modes: np.ndarray, symbol, scale: float) -> None:
    """Divide modes by the symbol of minus the Laplacian, in place; empty modes become 0."""
    (along, y, z), (across, wide_y, wide_z) = symbol
    both = wide_y[:, None] * wide_z
    cross = y[:, None] * wide_z + wide_y[:, None] * z
    for i, plane in enumerate(modes):
        here = along[i] * both + across[i] * cross
        plane *= np.divide(scale, here, out=np.zeros_like(here), where=here > 0)


def _in_place(plan, **knobs):
    """A plan of mpi4py-fft's that puts its output where its input was."""
    return lambda values, **more: plan(values, **(more | knobs | {"output_array": values}))
