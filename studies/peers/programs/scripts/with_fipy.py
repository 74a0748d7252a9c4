"""An image in FiPy: finite volumes on a grid of cells, harmonic means of the conductivities on faces.

Reads one JSON object: `image` (an .npz of `labels` and `spacing`, m), `conductivities` by label, `walls` (K across x);
prints another.
"""

import json
import os
import sys

import numpy as np
from spent import Spent

os.environ.setdefault("FIPY_SOLVERS", "scipy")
from fipy import CellVariable, DiffusionTerm, Grid3D, ImplicitSourceTerm  # noqa: E402
from fipy.solvers.scipy import JacobiPreconditioner, LinearCGSolver  # noqa: E402

TOLERANCE, MOST = 1e-10, 20_000


def _solved(values, spacing, walls):
    """Heat through both walls, W, and iterations."""
    counts = dict(zip(("nx", "ny", "nz"), values.shape, strict=True))
    mesh = Grid3D(**counts, dx=spacing, dy=spacing, dz=spacing)
    # FiPy counts cells along x first.
    conductivity = CellVariable(mesh=mesh, value=values.ravel(order="F"))
    t = CellVariable(mesh=mesh, value=(walls["x-"] + walls["x+"]) / 2)
    t.constrain(walls["x-"], mesh.facesLeft)
    t.constrain(walls["x+"], mesh.facesRight)
    on_faces = conductivity.harmonicFaceValue
    equation = DiffusionTerm(coeff=on_faces)
    empty = CellVariable(mesh=mesh, value=(values == 0).ravel(order="F").astype(float))
    if empty.value.any():
        # Held by a source, as its manual does inside of a domain: nothing else would fix them.
        equation = equation - ImplicitSourceTerm(coeff=empty) + empty * t.value[0]
    solver = LinearCGSolver(tolerance=TOLERANCE, iterations=MOST, precon=JacobiPreconditioner())
    equation.solve(var=t, solver=solver)
    if solver.convergence.status_code != 0:
        raise RuntimeError(f"conjugate gradients: {solver.convergence.status_name}")
    outward = (on_faces * t.faceGrad.dot(mesh.faceNormals)).value * spacing**2
    heat = [float(outward[faces.value].sum()) for faces in (mesh.facesLeft, mesh.facesRight)]
    return heat, solver.convergence.iterations


def main():
    """Read what is asked for, answer."""
    given = json.loads(sys.stdin.read())
    with np.load(given["image"]) as file:
        labels, spacing = file["labels"], float(file["spacing"])
    walls = given["walls"]
    clock = Spent()
    values = np.array(given["conductivities"])[labels]
    (first, last), iterations = _solved(values, spacing, walls)
    sides = spacing * np.array(labels.shape)
    found = (first - last) / 2 / (walls["x-"] - walls["x+"]) * sides[0] / (sides[1] * sides[2])
    lost = abs(first + last) / abs(first)
    answer = {"conductivity": found, "iterations": int(iterations), "unknowns": labels.size, "lost": lost}
    print(json.dumps({**answer, "cost": clock.so_far()}))


if __name__ == "__main__":
    main()
