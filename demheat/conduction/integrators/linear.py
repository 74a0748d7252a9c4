"""Solver of the implicit stages, (C / g + A) y = rhs: conjugate gradients with Jacobi or multigrid preconditioner."""

import math

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph
from scipy.sparse.linalg import LinearOperator, cg

from demheat.conduction.integrators import transient_kernels
from demheat.conduction.multigrid import CYCLE
from demheat.conduction.preconditioned import by_diagonal, preconditioned
from demheat.network.base import row_numbers
from demheat.runtime.process_state import one_blas_thread, seeded
from demheat.runtime.progress import stage

MOST = 5000
# A hierarchy still serves well when g has changed by this factor: both matrices are equivalent within it.
REUSE = 3.0
# No solve is asked for less than the rounding of temperatures, nor of the rates that they make in a stiff stage; but
# where that rounding is more than `COARSEST` of them, the stage has failed.
ROUNDING, COARSEST = 1e-13, 1e-9
# Where steps are longer than heat takes to settle, the bound is far above the error. The size of a correction that
# leaves this part of the residual then tells it, and such a correction is made so often at most.
CORRECTED, CORRECTIONS = 1e-2, 8


def solver(system, preconditioner):
    """A function that solves one implicit stage."""
    free = system.capacity > 0
    total = float(system.capacity.sum())
    cluster = _clusters(system)
    capacities = np.bincount(cluster, system.capacity)
    tied = system.ties.row
    ties = np.bincount(cluster[tied], system.ties.conductance, minlength=len(capacities))
    stiffness = math.sqrt(float(np.einsum("i,i,i->", system.inverse, system.diagonal, system.diagonal)) / total)
    kept = {}

    def rounding(g, known, y):
        """What rounding leaves at least, K, and whether the bound on it says nothing any more."""
        largest = max(float(np.abs(known[free]).max()), float(np.abs(y).max()))
        part = ROUNDING + np.finfo(float).eps * g * stiffness
        return min(part, COARSEST) * largest, part * largest if part > COARSEST else 0.0

    def residual(g, known, heat, y):
        r = np.empty_like(y)
        transient_kernels.rates(system.links, system.inverse, heat, y, r)
        r += (known - y) / g
        r *= system.capacity
        return r

    def balance(g, r, y):
        """Shift the temperature of each cluster so that it neither loses nor gains heat."""
        heat = np.bincount(cluster, r, minlength=len(capacities))
        whole = capacities / g + ties
        shift = np.divide(heat, whole, out=np.zeros_like(heat), where=whole > 0)[cluster] * free
        y += shift
        r -= shift / g * system.capacity
        np.subtract.at(r, tied, shift[tied] * system.ties.conductance)

    def size(g, r):
        # A is positive semidefinite: |error| <= g |C^-1 r| in the norm weighted by capacity.
        return g * math.sqrt(float(np.einsum("i,i,i->", system.inverse, r, r)) / total)

    def correct(iterate, g, known, heat, y):
        """Correct y by what its residual says; iterations, and the rms of the correction, infinite if it failed."""
        r, nothing, step = residual(g, known, heat, y), np.zeros_like(y), np.zeros_like(y)
        norm = _norm(r)
        count = iterate(g, r.copy(), step, 0.1 * CORRECTED * norm)
        left = _norm(r + residual(g, nothing, nothing, step))
        y += step
        rms = math.sqrt(float(np.einsum("i,i,i->", system.capacity, step, step)) / total)
        return count, rms if left <= CORRECTED * norm else math.inf

    def solve(g, known, heat, y, limit):
        iterate = _multigrid(system, free, kept, g) if preconditioner == "multigrid" else _jacobi(system)
        least, unbounded = rounding(g, known, y)
        limit, iterations, reached = max(limit, least), 0, math.inf
        for _ in range(20 if limit > unbounded else 0):
            r = residual(g, known, heat, y)
            reached = size(g, r)
            if reached > limit and iterations < MOST:
                norm = _norm(r)
                iterations += iterate(g, r, y, 0.8 * limit / reached * norm)
                continue
            balance(g, r, y)
            reached = size(g, r)
            if reached <= 1.01 * limit:
                return iterations, reached
        for _ in range(CORRECTIONS):
            count, reached = correct(iterate, g, known, heat, y)
            iterations += count
            balance(g, residual(g, known, heat, y), y)
            if reached <= limit:
                return iterations, reached
        raise RuntimeError(
            f"implicit stage ({preconditioner}): error bound {reached:.2e} K after {iterations} iterations, "
            f"asked for {limit:.1e} K"
        )

    return solve


def _norm(r):
    """Of a vector; not by BLAS, whose order of sums is that of its threads."""
    return math.sqrt(float(np.einsum("i,i->", r, r)))


def _clusters(system):
    """Number of the cluster of particles that each node belongs to; held nodes join none."""
    indptr, indices, _ = system.links
    inside = system.capacity[indices] > 0
    pair = (row_numbers(indptr)[inside], indices[inside].astype(np.int64))
    n = len(system.capacity)
    graph = sparse.csr_matrix((np.ones(len(pair[0]), np.int8), pair), shape=(n, n))
    return csgraph.connected_components(graph, directed=False)[1]


def _jacobi(system):
    def iterate(g, r, y, limit):
        diagonal = system.diagonal + system.capacity / g
        with stage("equations") as done:
            return preconditioned(system.links, diagonal, by_diagonal(diagonal), r, y, limit, MOST, done)

    return iterate


def _multigrid(system, free, kept, g):
    """Conjugate gradients on the free nodes, preconditioned by a hierarchy made for about this g."""
    if kept.get("g") != g:
        kept["g"], kept["matrix"] = g, _matrix(system, free, g)
    made_for = kept.get("made_for", math.inf)
    if max(g / made_for, made_for / g) > REUSE:
        kept["made_for"], kept["precondition"] = g, _hierarchy(kept["matrix"])

    def iterate(g, r, y, limit):
        a, count = kept["matrix"], [0]

        def tick(_):
            count[0] += 1

        with one_blas_thread():
            step, _ = cg(a, r[free], rtol=0.0, atol=limit, maxiter=MOST, M=kept["precondition"], callback=tick)
        y[free] += step
        return count[0]

    return iterate


def _matrix(system, free, g):
    """C / g + A of the free nodes as a SciPy matrix."""
    number = np.cumsum(free) - 1
    indptr, indices, conductance = system.links
    inside = free[indices]
    n = int(free.sum())
    pair = (number[row_numbers(indptr)[inside]], number[indices[inside]])
    off = sparse.csr_matrix((-conductance[inside], pair), shape=(n, n))
    return (off + sparse.diags((system.diagonal + system.capacity / g)[free])).tocsr()


def _hierarchy(a) -> LinearOperator:
    import pyamg

    with one_blas_thread(), seeded():
        # By SuperLU: the bits of a pseudo-inverse were others in the main thread than beside it.
        levels = pyamg.smoothed_aggregation_solver(a, improve_candidates=None, coarse_solver="splu", **CYCLE)
        return levels.aspreconditioner(cycle="V")
