"""The scalar scheme on a rank's slab of the grid, with a plane of its neighbours' on either side.

The kernels are those of a whole grid; sums over planes are gathered from all ranks in their order, so that what is
computed differs from the whole by the rounding of the transforms alone.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from demheat.scene import Scene
from references.fft import cg_kernels as kernels
from references.fft.cg import body_of, nodes_of, symbol, vectors_of
from references.fft.cg_kernels import Symbol
from references.fft.hexahedron_kernels import Sums, voxel_state
from references.fft.pencils import divide, share
from references.fft.problem import Problem, total
from references.voxels.paint import Voxels, voxelise


class Slab(NamedTuple):
    """Planes of a grid that a rank has."""

    # low, high: First and end of its own nodes' planes, and of the voxels' beside or below them
    low: int
    high: int
    shape: tuple  # (3,) tuple of int: Voxels of the whole grid
    walls: bool  # Across the first axis
    comm: object  # mpi4py.MPI.Comm

    @property
    def nodes(self) -> slice:
        """Its own among the planes of nodes that it holds."""
        return slice(1, self.high - self.low + 1)

    @property
    def voxels(self) -> slice:
        """Its own among the planes of voxels that it holds: between walls there is one more than of nodes."""
        return slice(1, self.high - self.low + 1 + (self.walls and self.last))

    @property
    def last(self) -> bool:
        """Whether it is the last of all ranks."""
        return self.comm.rank == self.comm.size - 1

    def fill(self, values: np.ndarray) -> None:
        """Fill the planes beside its own from the ranks that own them; those beyond walls stay as they are."""
        rank, size, end = self.comm.rank, self.comm.size, self.nodes.stop
        for own, ghost, way, wall in ((1, end, -1, self.last), (end - 1, 0, 1, rank == 0)):
            got = np.empty_like(values[ghost]) if self.walls and wall else values[ghost]
            self.comm.Sendrecv(values[own], dest=(rank + way) % size, recvbuf=got, source=(rank - way) % size)

    def gathered(self, values: np.ndarray) -> np.ndarray:
        """Own planes of all ranks, one after the other, on each of them."""
        return np.concatenate(self.comm.allgather(np.ascontiguousarray(values)))


def slab_of(shape: tuple, walls: bool, comm) -> Slab:
    """A rank's slab of a grid."""
    return Slab(*share(shape[0] - walls, comm.size, comm.rank), tuple(shape), walls, comm)


def painted(scene: Scene, slab: Slab, *, laminate: bool) -> Voxels:
    """The voxels that a rank holds, and the fractions of all ranks'."""
    planes = slab.shape[0]
    below, above = (slab.low - 1) % planes, slab.high % planes
    ends = (below, below + 1), (slab.low, slab.high), (above, above + 1)
    parts = [voxelise(scene, slab.shape, laminate=laminate, planes=each) for each in ends]
    plane, own = slab.shape[1] * slab.shape[2], slab.high - slab.low
    starts = np.array([0, 1, own + 1]) * plane
    filled = parts[1].fractions * own + parts[2].fractions * (slab.voxels.stop - slab.nodes.stop)
    return parts[1]._replace(
        phase=np.concatenate([part.phase for part in parts]),
        cut=np.concatenate([part.cut + start for part, start in zip(parts, starts, strict=True)]),
        tensor=np.concatenate([part.tensor for part in parts]),
        fractions=slab.comm.allreduce(filled) / planes,
    )


class SlabSystem:
    """What `cg.System` is, on a rank's slab: to be used by all ranks at the same time."""

    def __init__(self, problem: Problem, slab: Slab, transform):
        self.problem, self.slab, self.transform = problem, slab, transform
        self.kernel, self.body = body_of(problem)
        nodes, (_, ny, nz) = nodes_of(problem, slab.shape), slab.shape
        held = (slab.nodes.stop + 1, *nodes[1:])
        self.vectors, self.size = vectors_of(problem, held, np.zeros(held)), slab.shape[0] * ny * nz
        self.unknowns = nodes[0] * nodes[1] * nodes[2]
        self.sums = Sums(np.zeros(slab.nodes.stop + 1), np.zeros((slab.nodes.stop + 1, 3)))
        whole = symbol(transform.counts, slab.shape, problem)
        self.symbol = Symbol(*((x, y[transform.rows], z) for x, y, z in whole))

    def conduct(self, theta: np.ndarray, gradient: np.ndarray) -> Sums:
        """As `cg.System.conduct`; the sums are those of all ranks' planes."""
        self.slab.fill(theta)
        self._run(self.kernel, theta, self.vectors.work, self.body, gradient, self.sums)
        own = np.column_stack([self.sums.energy, self.sums.flux])[self.slab.voxels]
        whole = self.slab.gathered(own)
        return Sums(whole[:, 0], whole[:, 1:])

    def precondition(self, kernel: Callable, *arguments) -> float:
        """As `cg.System.precondition`."""
        transform, own = self.transform, self.slab.nodes
        self._run(kernel, self.vectors, *arguments)
        transform.real[...] = self.vectors.work[own]
        transform.forward()
        divide(transform.modes, self.symbol, transform.scale)
        transform.backward()
        self.vectors.work[own] = transform.real
        self._run(kernels.dot, self.vectors)
        return float(self.slab.gathered(self.vectors.partial[own]).sum())

    def turn(self, beta: float) -> float:
        """Make work + beta direction the direction; returns p.A p."""
        self._run(kernels.turn, self.vectors, beta)
        return total(self.conduct(self.vectors.direction, np.zeros(3)).energy)

    def keeper(self) -> Callable:
        """What makes temperatures and fluxes of the voxels that the rank holds, those beside its own included."""
        slab, gradient, body, theta = self.slab, self.problem.gradient, self.body, self.vectors.theta
        shape = self.problem.voxels.phase.shape

        def centers():
            temperature, flux = np.zeros(shape), np.zeros((3, *shape))
            voxel_state(theta, body, gradient, temperature, flux, slab.voxels.start, slab.voxels.stop)
            for each in (temperature, *flux):
                slab.fill(each)
            return temperature, flux

        return centers

    def _run(self, kernel, *arguments):
        kernel(*arguments, self.slab.nodes.start, self.slab.nodes.stop)
