"""A symmetric system in PyAMG: conjugate gradients, multigrid with its defaults.

Reads and prints what `with_petsc.py` does.
"""

import json
import sys

import numpy as np
import pyamg
from scipy.sparse import csr_matrix
from spent import Spent

MOST = 500


def main():
    """Read what is asked for, answer."""
    given = json.loads(sys.stdin.read())
    with np.load(given["system"]) as file:
        parts = {name: file[name] for name in file.files}
    n = len(parts["b"])
    matrix = csr_matrix((parts["data"], parts["indices"], parts["indptr"]), shape=(n, n))
    clock, history = Spent(), []
    levels = getattr(pyamg, f"{given['solver']}_solver")(matrix)
    made = clock.so_far()
    x = levels.solve(parts["b"], x0=parts["start"], tol=given["tolerance"], accel="cg", maxiter=MOST, residuals=history)
    cost = clock.so_far()
    np.save(given["answer"], x)
    # What follows from the temperatures is told by whoever knows the network.
    answer = {"conductivity": None, "unknowns": n, "iterations": len(history) - 1, "set_up": made}
    print(json.dumps({**answer, "cost": cost}))


if __name__ == "__main__":
    main()
