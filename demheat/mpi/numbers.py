"""One number for each unknown of all ranks, and the temperatures of particles that a rank sees of others."""

import numpy as np

from demheat.mpi.slabs import NOBODY, Slabs, found_at
from demheat.packing.base import wrap


def numbers_of(network, own: int, slabs: Slabs, comm) -> np.ndarray:
    """Global numbers of the particles that a rank sees: its own in one run, of others those that their owners tell."""
    first = comm.scan(own) - own
    numbers = np.full(len(network.volumes), NOBODY, dtype=np.int32)
    numbers[:own] = first + np.arange(own)
    centers = wrap(network.centers[own:], network.size, np.broadcast_to(slabs.periodic, 3))
    owner = slabs.owner(centers)
    rows = [np.flatnonzero(owner == rank) for rank in range(comm.size)]
    asked = comm.alltoall([centers[each] for each in rows])
    told = comm.alltoall([found_at(points, network.centers[:own], slabs) for points in asked])
    for each, found, rank in zip(rows, told, range(comm.size), strict=True):
        start = comm.bcast(first, root=rank)
        numbers[own + each] = np.where(found >= 0, start + found, NOBODY)
    if np.any(numbers[network.indices[: network.indptr[own]]] == NOBODY):
        raise RuntimeError("demheat.mpi: a particle beside a rank's own is unknown to its owner")
    return numbers


def linked(network, own: int) -> np.ndarray:
    """Particles that a rank's own rows link to, and its own, (n,) bool array."""
    found = np.arange(len(network.volumes)) < own
    found[network.indices[: network.indptr[own]]] = True
    return found


class Ghosts:
    """What a rank sees of a quantity of which each rank has its own part."""

    def __init__(self, numbers, own, petsc, comm):
        self.own, self.known = own, np.flatnonzero(numbers[own:] != NOBODY) + own
        self.size = len(numbers)
        self.whole = petsc.Vec().createMPI((own, None), comm=comm)
        self.beside = petsc.Vec().createSeq(len(self.known))
        chosen = petsc.IS().createGeneral(numbers[self.known], comm=petsc.COMM_SELF)
        self.scatter = petsc.Scatter().create(self.whole, chosen, self.beside, None)

    def filled(self, values: np.ndarray) -> np.ndarray:
        """Values of a rank's own particles, (own,) float array, with those of all it sees, NaN where nobody tells."""
        seen = np.full(self.size, np.nan)
        seen[: self.own] = values
        self.update(seen)
        return seen

    def update(self, seen: np.ndarray) -> None:
        """Put the others' values where a rank sees them, (size,) float array; its own are those of `seen` itself."""
        self.whole.array[:] = seen[: self.own]
        self.scatter.scatter(self.whole, self.beside)
        seen[self.known] = self.beside.array_r
