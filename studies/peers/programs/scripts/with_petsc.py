"""A symmetric system in PETSc: conjugate gradients, algebraic multigrid of its own or of hypre.

Reads one JSON object: `system` (an .npz of CSR arrays `indptr`, `indices`, `data`, of `b` and of `start`), `answer`
(where the solution goes), `solver` and `tolerance`; prints another.
"""

import json
import sys

import numpy as np
import petsc4py
from spent import Spent

petsc4py.init([])
from petsc4py import PETSc  # noqa: E402

MOST = 2000
# What hypre's manual advises in three dimensions: fewer and smaller coarse matrices.
HYPRE = {"strong_threshold": 0.5, "coarsen_type": "HMIS", "interp_type": "ext+i", "P_max": 4, "agg_nl": 1}


def _solver_of(matrix, kind, tolerance):
    """Conjugate gradients that stop at a true residual."""
    options = PETSc.Options()
    for name, value in HYPRE.items():
        options[f"pc_hypre_boomeramg_{name}"] = value
    solver = PETSc.KSP().create(PETSc.COMM_SELF)
    solver.setOperators(matrix)
    solver.setType("cg")
    solver.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
    solver.setInitialGuessNonzero(True)
    preconditioner = solver.getPC()
    preconditioner.setType("hypre" if kind == "boomeramg" else kind)
    if kind == "boomeramg":
        preconditioner.setHYPREType("boomeramg")
    # The test is on the norm of b, also from a first guess.
    solver.setTolerances(rtol=tolerance, atol=0.0, max_it=MOST)
    solver.setFromOptions()
    return solver


def main():
    """Read what is asked for, answer."""
    given = json.loads(sys.stdin.read())
    with np.load(given["system"]) as file:
        parts = {name: file[name] for name in file.files}
    n = len(parts["b"])
    rows = (parts["indptr"].astype(PETSc.IntType), parts["indices"].astype(PETSc.IntType), parts["data"])
    matrix = PETSc.Mat().createAIJ((n, n), csr=rows, comm=PETSc.COMM_SELF)
    matrix.setOption(PETSc.Mat.Option.SPD, True)
    b, x = (PETSc.Vec().createWithArray(parts[name], comm=PETSc.COMM_SELF) for name in ("b", "start"))
    clock = Spent()
    solver = _solver_of(matrix, given["solver"], given["tolerance"])
    solver.setUp()
    made = clock.so_far()
    solver.solve(b, x)
    cost = clock.so_far()
    if solver.getConvergedReason() <= 0:
        raise RuntimeError(f"reason {solver.getConvergedReason()} after {solver.getIterationNumber()} iterations")
    np.save(given["answer"], x.getArray())
    # What follows from the temperatures is told by whoever knows the network.
    answer = {"conductivity": None, "unknowns": n, "iterations": solver.getIterationNumber(), "set_up": made}
    print(json.dumps({**answer, "cost": cost}))


if __name__ == "__main__":
    main()
