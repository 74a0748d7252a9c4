"""The heat balance of all ranks' particles, by PETSc's conjugate gradients and, below the finest level, its multigrid.

The finest level is that of one process, each rank's rows a block of it: the network is read as it is, and there is no
second copy of the matrix. What all ranks' aggregates exchange is a matrix of PETSc's, on an eighth of the unknowns.
"""

import math

import numpy as np
from scipy import sparse

from demheat.beyond.petsc import PREFIX, conjugate_gradients, know
from demheat.conduction import multigrid_kernels
from demheat.conduction.balance import System, residual, throughput
from demheat.conduction.multigrid import aggregated, cycle
from demheat.conduction.products import apply
from demheat.mpi.numbers import Ghosts
from demheat.network.links_kernels import Links

# Solved anew so often: the heat that passes, which sets the limit, is known only once the solution nearly is.
ROUNDS, MOST = 10, 20_000


class Equations:
    """The rows of a rank's own particles and what solves those of all; `free` gives its memory back."""

    def __init__(self, system: System, ghosts: Ghosts, options, petsc, comm):
        self.petsc, self.comm, self.own = petsc, comm, ghosts.own
        know(options, petsc)
        rows = own_rows(system, self.own)
        sizes = ((self.own, None), (self.own, None))
        self.matrix = petsc.Mat().createPython(sizes, _Balance(*rows, ghosts), comm=comm)
        self.matrix.setUp()
        self.below = _Below(petsc, comm, constant=bool(system.network.periodic.any()))
        self.cycle = _Cycle(preconditioner(*rows, ghosts, self.below, comm))
        if self.below.constant:
            self.matrix.setNullSpace(petsc.NullSpace().create(constant=True, comm=comm))
        self.solver = _solver(self.matrix, self.cycle, petsc, comm)
        self.r, self.x = self.matrix.createVecs()

    def correction(self, r: np.ndarray, limit: float, most: int) -> tuple[np.ndarray, int]:
        """What takes a residual below a limit, and the iterations that took."""
        self.r.array[:] = r
        # In single precision numbers are of order one.
        self.cycle.norm = self.r.norm()
        self.solver.setTolerances(rtol=1e-30, atol=limit, max_it=most)
        self.solver.solve(self.r, self.x)
        if self.solver.reason < 0 and self.solver.reason != self.petsc.KSP.ConvergedReason.DIVERGED_MAX_IT:
            raise RuntimeError(f"demheat.mpi: PETSc gave up, reason {self.solver.reason} of its KSPConvergedReason")
        return self.x.array_r.copy(), self.solver.its

    def free(self) -> None:
        """Give back the memory of the multigrid."""
        for each in (self.solver, self.matrix, self.below, self.r, self.x):
            each.destroy()
        self.cycle.apply_to = None


def own_rows(system: System, own: int):
    """Links and diagonal of a rank's own rows, without copies."""
    network = system.network
    end = network.indptr[own]
    return Links(network.indptr[: own + 1], network.indices[:end], network.conductance[:end]), system.diagonal[:own]


def preconditioner(links: Links, diagonal: np.ndarray, ghosts, below, comm):
    """One symmetric cycle for the equations of all ranks: as in one process, aggregates end at slabs' ends."""
    own, scale = len(diagonal), 1.0 / max(comm.allgather(float(diagonal.max())))
    aggregates = aggregated(links, own)
    count = len(aggregates.start) - 1
    first = comm.scan(count) - count
    # Aggregates of others come after the rank's own.
    theirs = ghosts.filled(np.where(aggregates.owner < 0, np.nan, aggregates.owner + float(first)))[own:]
    known = np.isfinite(theirs)
    numbers, place = np.unique(theirs[known].astype(np.int64), return_inverse=True)
    owner = np.full(own + len(theirs), -1, np.int32)
    owner[:own] = aggregates.owner
    owner[own:][known] = count + place
    pointers, columns, values = multigrid_kernels.galerkin(links, diagonal, scale, aggregates._replace(owner=owner))
    below.takes(pointers, np.concatenate([first + np.arange(count), numbers])[columns], values)
    return cycle(links, diagonal, scale, aggregates, below.solve, seen=len(owner), beside=ghosts.update)


def solved(equations: Equations, system: System, ghosts: Ghosts, x: np.ndarray, tolerance: float):
    """Temperatures above the level that leave no more than a part of the heat that passes."""
    total = 0
    for _ in range(ROUNDS):
        size, r, unit = _left(system, ghosts, x, equations)
        if size <= tolerance or total >= MOST:
            break
        change, count = equations.correction(r, 0.9 * tolerance * unit, MOST - total)
        x, total = x + change, total + count
    if not size <= tolerance:
        raise RuntimeError(
            f"demheat.mpi: relative residual {size:.2e} after {total} iterations, asked for {tolerance:.1e}"
        )
    return x, total, size


def _left(system, ghosts, x, equations):
    """Norm of the residual over that of the heat that passes, our part of the residual, and the latter norm."""
    seen, own = ghosts.filled(x), equations.own
    r, through = residual(system, seen)[:own], throughput(system, seen)[:own]
    norm, passing = (math.sqrt(equations.comm.allreduce(float(np.sum(each**2)))) for each in (r, through))
    return (norm / passing, r, passing) if passing > 0 else (float(norm > 0), r, norm)


class _Balance:
    """The product of all ranks' matrix with a vector, as PETSc asks for it."""

    def __init__(self, links, diagonal, ghosts):
        self.links, self.diagonal, self.ghosts, self.seen = links, diagonal, ghosts, np.zeros(ghosts.size)

    def mult(self, _, x, y):
        """PETSc's name for y = A x."""
        self.seen[: self.ghosts.own] = x.array_r
        self.ghosts.update(self.seen)
        apply(self.links, self.diagonal, self.seen, y.array)


class _Cycle:
    """The preconditioner, as PETSc asks for it."""

    def __init__(self, apply_to):
        self.apply_to, self.norm = apply_to, 1.0

    def apply(self, _, r, z):
        """PETSc's name for z = M r."""
        self.apply_to(r.array_r, self.norm, z.array)


class _Below:
    """The aggregates' equations, by a preconditioner of PETSc's."""

    def __init__(self, petsc, comm, *, constant):
        self.petsc, self.comm, self.constant = petsc, comm, constant

    def takes(self, pointers, columns, values):
        """Rows of the matrix, as `preconditioner` has them."""
        petsc, count = self.petsc, len(pointers) - 1
        total = self.comm.allreduce(count)
        rows = sparse.csr_matrix((values, columns, pointers), shape=(count, total))
        rows.sort_indices()
        csr = rows.indptr.astype(petsc.IntType), rows.indices.astype(petsc.IntType), rows.data
        self.matrix = petsc.Mat().createAIJ(((count, None), (count, None)), csr=csr, comm=self.comm)
        for option in (petsc.Mat.Option.SYMMETRIC, petsc.Mat.Option.SPD):
            self.matrix.setOption(option, True)
        if self.constant:
            self.matrix.setNullSpace(petsc.NullSpace().create(constant=True, comm=self.comm))
        self.solver = petsc.PC().create(self.comm)
        self.solver.setOptionsPrefix(PREFIX)
        self.solver.setOperators(self.matrix)
        self.solver.setFromOptions()
        self.solver.setUp()
        self.r, self.x = self.matrix.createVecs()

    def solve(self, r):
        self.r.array[:] = r
        self.solver.apply(self.r, self.x)
        return self.x.array_r

    def destroy(self):
        for each in (self.solver, self.matrix, self.r, self.x):
            each.destroy()


def _solver(matrix, cycle, petsc, comm):
    solver = conjugate_gradients(matrix, petsc, comm)
    # After the options, which are those of the preconditioner below.
    outer = solver.getPC()
    outer.setType("python")
    outer.setPythonContext(cycle)
    solver.setUp()
    return solver
