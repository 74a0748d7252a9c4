"""The heat balance of all ranks' particles as PETSc's matrix, solved by its conjugate gradients and multigrid."""

from __future__ import annotations

import math

import numpy as np

from demheat.conduction.balance import System, residual, throughput
from demheat.mpi.numbers import Halo
from demheat.petsc import solver_of
from demheat.tiles.cells import Cells

# Rows that are handed over at once: some 20 MB.
BLOCK = 65536
# Solved anew so often: the heat that passes, which sets the limit, is known only once the solution nearly is.
ROUNDS, MOST = 10, 20_000


class Equations:
    """A matrix of all ranks and what solves it; `free` gives its memory back.

    Parameters
    ----------
    cells : Cells
    system : System
        Of what the rank sees.
    numbers : (n,) int32 array
    options : str
        Of PETSc, such as "-pc_type hypre".
    petsc : module
    comm : mpi4py.MPI.Comm
    """

    def __init__(self, cells: Cells, system: System, numbers, options, petsc, comm):
        self.petsc, self.comm, self.own = petsc, comm, cells.own
        self.matrix = _matrix(cells, system, numbers, petsc, comm)
        self.solver = solver_of(self.matrix, options, petsc, comm)
        self.r, self.x = self.matrix.createVecs()

    def correction(self, r: np.ndarray, limit: float, most: int) -> tuple[np.ndarray, int]:
        """What takes a residual below a limit, and the iterations that took.

        Parameters
        ----------
        r : (own,) float array, W
        limit : float, W
            On its norm over all ranks.
        most : int
            Iterations.
        """
        self.r.array[:] = r
        self.solver.setTolerances(rtol=1e-30, atol=limit, max_it=most)
        self.solver.solve(self.r, self.x)
        if self.solver.reason < 0 and self.solver.reason != self.petsc.KSP.ConvergedReason.DIVERGED_MAX_IT:
            raise RuntimeError(f"demheat.mpi: PETSc gave up, reason {self.solver.reason} of its KSPConvergedReason")
        return self.x.array_r.copy(), self.solver.its

    def free(self) -> None:
        """Give back the memory of the matrix and its multigrid."""
        for each in (self.solver, self.matrix, self.r, self.x):
            each.destroy()


def solved(equations: Equations, system: System, halo: Halo, x: np.ndarray, tolerance: float):
    """Temperatures above the level that leave no more than a part of the heat that passes.

    Parameters
    ----------
    equations : Equations
    system : System
        Of what the rank sees.
    halo : Halo
    x : (own,) float array, K
        To begin with.
    tolerance : float
        As of `demheat.conduction.steady.solve_steady`.

    Returns
    -------
    x : (own,) float array, K
    iterations : int
    residual : float
        Relative, recomputed.

    Raises
    ------
    RuntimeError
        If the residual misses the tolerance.
    """
    total = 0
    for _ in range(ROUNDS):
        size, r, unit = _left(system, halo, x, equations)
        if size <= tolerance or total >= MOST:
            break
        change, count = equations.correction(r, 0.9 * tolerance * unit, MOST - total)
        x, total = x + change, total + count
    if not size <= tolerance:
        raise RuntimeError(
            f"demheat.mpi: relative residual {size:.2e} after {total} iterations, asked for {tolerance:.1e}"
        )
    return x, total, size


def _left(system, halo, x, equations):
    """Norm of the residual over that of the heat that passes, our part of the residual, and the latter norm."""
    seen, own = halo.filled(x), equations.own
    r, through = residual(system, seen)[:own], throughput(system, seen)[:own]
    norm, passing = (math.sqrt(equations.comm.allreduce(float(np.sum(each**2)))) for each in (r, through))
    return (norm / passing, r, passing) if passing > 0 else (float(norm > 0), r, norm)


def _matrix(cells, system, numbers, petsc, comm):
    """Rows of the rank's own particles, handed over block by block."""
    network, own = cells.network, cells.own
    matrix = petsc.Mat().createAIJ(((own, None), (own, None)), comm=comm)
    matrix.setPreallocationNNZ(_lengths(network, numbers, own))
    for start in range(0, own, BLOCK):
        rows = np.arange(start, min(own, start + BLOCK))
        matrix.setValuesIJV(*_rows(network, system.diagonal, numbers, rows), addv=True, rowmap=numbers[rows])
    matrix.assemble()
    for option in (petsc.Mat.Option.SYMMETRIC, petsc.Mat.Option.SPD):
        matrix.setOption(option, True)
    if system.network.periodic.any():
        matrix.setNullSpace(petsc.NullSpace().create(constant=True, comm=comm))
    return matrix


def _lengths(network, numbers, own):
    """Entries of each row in the rank's own columns, the diagonal besides, and in others'."""
    beside, count = np.empty(own, np.int32), np.diff(network.indptr[: own + 1]).astype(np.int32)
    for start in range(0, own, BLOCK):
        rows = slice(start, min(own, start + BLOCK))
        ends = network.indptr[rows.start : rows.stop + 1]
        column = numbers[network.indices[ends[0] : ends[-1]]]
        others = np.concatenate([[0], np.cumsum((column < numbers[0]) | (column >= numbers[0] + own))])
        beside[rows] = np.diff(others[ends - ends[0]])
    return count - beside + 1, beside


def _rows(network, diagonal, numbers, rows):
    """Some rows as PETSc takes them: pointers, columns and values, the diagonal last in each."""
    begin, end = network.indptr[rows[0]], network.indptr[rows[-1] + 1]
    last = network.indptr[rows + 1] - begin
    columns = np.insert(numbers[network.indices[begin:end]], last, numbers[rows])
    values = np.insert(-network.conductance[begin:end], last, diagonal[rows])
    pointers = np.concatenate([[0], last + np.arange(1, len(rows) + 1)]).astype(np.int32)
    return pointers, columns, values
