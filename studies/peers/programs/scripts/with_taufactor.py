"""An image in TauFactor: finite volumes by successive over-relaxation, in single precision.

Reads one JSON object: `image` (an .npz of `labels`), `conductivities` by label, `solver` (the class's name) and
`tolerance` (spread of the flux along x); prints another.
"""

import json
import sys

import numpy as np
import taufactor
from spent import Spent

MOST = 10_000


def _solver_of(labels, conductivities, name):
    """A solver on its own labels, 0 where nothing is conducted, and what one of its units is in W/(m K)."""
    own = np.cumsum(np.array(conductivities) > 0) * (np.array(conductivities) > 0)
    numbered = own[labels].astype(np.uint8)
    if name == "Solver":
        return taufactor.Solver(numbered, device="cpu"), max(conductivities)
    shares = {int(i): k for i, k in zip(own, conductivities, strict=True) if i}
    present = set(np.unique(numbered).tolist())
    shares = {i: k for i, k in shares.items() if i in present}
    return taufactor.MultiPhaseSolver(numbered, shares, device="cpu"), 1.0


def main():
    """Read what is asked for, answer."""
    given = json.loads(sys.stdin.read())
    with np.load(given["image"]) as file:
        labels = file["labels"]
    clock = Spent()
    solver, unit = _solver_of(labels, given["conductivities"], given["solver"])
    solver.solve(iter_limit=MOST, verbose=False, conv_crit=given["tolerance"])
    if not solver.converged:
        raise RuntimeError(f"flux differs along x by more than {given['tolerance']} after {MOST} iterations")
    found = unit * float(np.ravel(solver.D_eff)[0])
    answer = {"conductivity": found, "iterations": solver.iter, "unknowns": int(np.sum(labels >= 0))}
    print(json.dumps({**answer, "cost": clock.so_far()}))


if __name__ == "__main__":
    main()
