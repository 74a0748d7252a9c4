"""An image in MFEM: a Cartesian mesh of hexahedra with an attribute for each label, solved as its example 1 does.

Reads one JSON object: `image` (an .npz of `labels` and `spacing`, m), `conductivities` by label, `walls` (K across x)
and `order`; prints another.
"""

import json
import sys

import mfem.ser as mfem
import numpy as np
from spent import Spent

TOLERANCE, MOST = 1e-10, 20_000


def _meshed(labels, spacing, conducting):
    """Mesh of the voxels that conduct, their attributes the labels and one."""
    sides = (spacing * n for n in labels.shape)
    # Not along a curve: voxels in the order of x, then y, then z.
    mesh = mfem.Mesh.MakeCartesian3D(*labels.shape, mfem.Element.HEXAHEDRON, *sides, False)
    for element, label in enumerate(labels.ravel(order="F").tolist()):
        mesh.SetAttribute(element, label + 1)
    mesh.SetAttributes()
    if conducting.all():
        return mesh
    return mfem.SubMesh.CreateFromDomain(mesh, mfem.intArray([i + 1 for i in np.flatnonzero(conducting).tolist()]))


def _walls_of(mesh, space, name):
    """Unknowns on a wall, which MakeCartesian3D calls 5 (low x) or 3 (high x)."""
    marker = mfem.intArray([int(i == {"x-": 5, "x+": 3}[name]) for i in range(1, mesh.bdr_attributes.Max() + 1)])
    unknowns = mfem.intArray()
    space.GetEssentialTrueDofs(marker, unknowns)
    return unknowns


def _solved(mesh, values, walls, order):
    """Energy at the solution, iterations and free unknowns."""
    collection = mfem.H1_FECollection(order, 3)
    space = mfem.FiniteElementSpace(mesh, collection)
    form = mfem.BilinearForm(space)
    conductivity = mfem.PWConstCoefficient(mfem.Vector(values))
    form.AddDomainIntegrator(mfem.DiffusionIntegrator(conductivity))
    form.Assemble()
    t, load = mfem.GridFunction(space), mfem.LinearForm(space)
    t.Assign(0.0)
    load.Assign(0.0)
    held = []
    for name, value in walls.items():
        unknowns = _walls_of(mesh, space, name).ToList()
        held += unknowns
        for unknown in unknowns:
            t[unknown] = value
    matrix, right, x = mfem.SparseMatrix(), mfem.Vector(), mfem.Vector()
    form.FormLinearSystem(mfem.intArray(held), t, load, matrix, x, right)
    smoother = mfem.GSSmoother(matrix)
    solver = mfem.CGSolver()
    solver.SetRelTol(TOLERANCE)
    solver.SetMaxIter(MOST)
    solver.SetPreconditioner(smoother)
    solver.SetOperator(matrix)
    solver.Mult(right, x)
    if not solver.GetConverged():
        raise RuntimeError(f"conjugate gradients: not done after {MOST} iterations")
    form.RecoverFEMSolution(x, load, t)
    # With what the walls' values took out of the matrix.
    return form.FullInnerProduct(t, t), solver.GetNumIterations(), space.GetTrueVSize() - len(held)


def main():
    """Read what is asked for, answer."""
    given = json.loads(sys.stdin.read())
    with np.load(given["image"]) as file:
        labels, spacing = file["labels"], float(file["spacing"])
    walls, values = given["walls"], np.array(given["conductivities"])
    clock = Spent()
    mesh = _meshed(labels, spacing, values > 0)
    energy, iterations, unknowns = _solved(mesh, values.tolist(), walls, given["order"])
    found = energy / (walls["x-"] - walls["x+"]) ** 2 * labels.shape[0] / (labels.shape[1] * labels.shape[2] * spacing)
    print(json.dumps({"conductivity": found, "iterations": iterations, "unknowns": unknowns, "cost": clock.so_far()}))


if __name__ == "__main__":
    main()
