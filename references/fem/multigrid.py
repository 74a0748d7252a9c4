"""Conjugate gradients with a multigrid preconditioner: quadratic to linear elements, then smoothed aggregation."""

import math
from functools import partial

import numpy as np
import pyamg
from pyamg.multilevel import MultilevelSolver
from pyamg.relaxation.smoothing import change_smoothers
from scipy.sparse import csr_matrix, diags

from demheat.runtime.process_state import seeded
from demheat.runtime.progress import stage
from references.mesh import EDGE_COLUMN

MOST_ITERATIONS = 500
SMOOTHER = ("gauss_seidel", {"sweep": "symmetric"})
# A small coarsest matrix, factorised: the default dense pseudo-inverse of 500 rows costs as much as the whole solve.
COARSEST = {"max_coarse": 100, "coarse_solver": "splu", "presmoother": SMOOTHER, "postsmoother": SMOOTHER}


def solve_free(mesh, matrix, load, fixed, dof, tolerance, *, kept=None):
    """Solve for the free nodes, those that are not fixed and have a row."""
    diagonal, solution = matrix.diagonal(), np.zeros(len(load))
    free = np.flatnonzero(~fixed & (diagonal > 0))
    stats = {"unknowns": len(free), "iterations": 0, "residual": 0.0}
    if not load[free].any():
        return solution, stats
    kept = {} if kept is None else kept
    if not np.array_equal(kept.get("free"), free):
        kept |= {"free": free, "equations": _equations(mesh, matrix, free, dof)}
    A, scale, precondition = kept["equations"]
    b = scale @ load[free]
    with stage("equations") as done:
        x, stats["iterations"], stats["residual"] = conjugate_gradients(A, b, precondition, tolerance, done)
    if not stats["residual"] <= tolerance:
        raise RuntimeError(
            f"finite elements: residual {stats['residual']:.2e} > tolerance {tolerance:.2e} after "
            f"{stats['iterations']} iterations on {len(free)} unknowns"
        )
    solution[free] = scale @ x
    return solution, stats


def renewed(kept, matrix):
    """What `solve_free` keeps, with the equations of another matrix: scale and multigrid still serve."""
    if kept:
        _, scale, precondition = kept["equations"]
        kept["equations"] = (scale @ matrix[kept["free"]][:, kept["free"]] @ scale).tocsr(), scale, precondition
    return kept


def _equations(mesh, matrix, free, dof):
    """The free nodes' equations scaled to a unit diagonal, their scale, and one cycle of multigrid."""
    root = np.sqrt(matrix.diagonal()[free])
    scale = diags(1 / root)
    A = (scale @ matrix[free][:, free] @ scale).tocsr()
    return A, scale, multigrid(A, root, prolongation(mesh, free, dof))


def conjugate_gradients(A, b, precondition, tolerance, done=None):
    """Solve A x = b from x = 0."""
    x, scale, iterations = np.zeros_like(b), math.sqrt(_dot(b, b)), 0
    # Rounding can part the recursive residual from the true one: start again from there, twice at most.
    for _ in range(3):
        r = b - A @ x
        residual = math.sqrt(_dot(r, r)) / scale
        if residual <= tolerance:
            break
        p, old = np.zeros_like(b), np.inf
        while math.sqrt(_dot(r, r)) > tolerance * scale and iterations < MOST_ITERATIONS:
            z = precondition(r)
            new = _dot(r, z)
            p = z + (new / old) * p
            Ap = A @ p
            step = new / _dot(p, Ap)
            x += step * p
            r -= step * Ap
            old, iterations = new, iterations + 1
            if done is not None:
                done(_share(math.sqrt(_dot(r, r)) / scale, tolerance))
        residual = math.sqrt(_dot(b - A @ x, b - A @ x)) / scale
    return x, iterations, residual


def _share(residual, tolerance):
    """Of the way from a residual of 1 to the tolerance, by logarithms."""
    return min(max(math.log(residual) / math.log(tolerance), 0.0), 1.0) if 0 < residual < 1 else float(residual == 0)


def _dot(a, b):
    # Not BLAS: its threads, spinning between short products, cost several times the whole solve on a shared machine.
    return float(np.einsum("i,i->", a, b))


def _cycle(levels, b, number=0):
    """One V-cycle from zero, without the residual norms of pyamg's own driver."""
    level = levels.levels[number]
    if number == len(levels.levels) - 1:
        return levels.coarse_solver(level.A, b)
    x = np.zeros_like(b)
    level.presmoother(level.A, x, b)
    x += level.P @ _cycle(levels, level.R @ (b - level.A @ x), number + 1)
    level.postsmoother(level.A, x, b)
    return x


def prolongation(mesh, free, dof):
    """From corners to all free nodes: a middle is the mean of its edge's ends; None where no element has middles."""
    if mesh.cells.shape[1] != 10:
        return None
    count = len(dof)
    ends = np.repeat(np.arange(count)[:, None], 2, axis=1)
    for (a, b), c in EDGE_COLUMN.items():
        ends[dof[mesh.cells[:, c]]] = dof[mesh.cells[:, [a, b]]]
    corners = np.unique(dof[mesh.cells[:, :4]])
    ends[corners] = corners[:, None]
    coarse = np.intersect1d(corners, free)
    column = np.full(count, -1)
    column[coarse] = np.arange(len(coarse))
    rows, columns = np.repeat(np.arange(len(free)), 2), column[ends[free]].ravel()
    kept = columns >= 0
    return csr_matrix((np.full(kept.sum(), 0.5), (rows[kept], columns[kept])), shape=(len(free), len(coarse)))


def multigrid(A, constant, quadratic=None):
    """One V-cycle as a preconditioner."""
    return partial(_cycle, _hierarchy(A, constant, quadratic))


def _hierarchy(A, constant, prolongation):
    with seeded():
        if prolongation is None or prolongation.shape[1] == 0:
            return pyamg.smoothed_aggregation_solver(A, B=constant[:, None], **COARSEST)
        fine = MultilevelSolver.Level()
        fine.A, fine.P = A, (diags(constant) @ prolongation).tocsr()
        fine.R = fine.P.T.tocsr()
        coarse = pyamg.smoothed_aggregation_solver((fine.R @ A @ fine.P).tocsr(), **COARSEST)
        levels = MultilevelSolver([fine, *coarse.levels], coarse_solver=COARSEST["coarse_solver"])
        change_smoothers(levels, SMOOTHER, SMOOTHER)
        return levels
