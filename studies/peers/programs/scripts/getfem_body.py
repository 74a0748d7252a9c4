"""Conduction in a body by GetFEM, by a Python that has it: reads one JSON object, prints another as its last line."""

import json
import sys

import getfem
import numpy as np
from spent import Spent

# Of the walls in the file.
HOT, COLD = 1, 2


def main():
    """Solve."""
    given = json.load(sys.stdin)
    getfem.util_trace_level(0)
    mesh = getfem.Mesh("import", "gmsh", f"{given['mesh']}.msh")
    clock = Spent()
    field = getfem.MeshFem(mesh, 1)
    field.set_classical_fem(given["order"])
    per_cell = getfem.MeshFem(mesh, 1)
    per_cell.set_classical_discontinuous_fem(0)
    # Exact for products of two gradients.
    rule = getfem.MeshIm(mesh, max(1, 2 * given["order"] - 2))
    k = np.zeros(per_cell.nbdof())
    for phase, value in given["phases"].items():
        k[per_cell.basic_dof_on_region(int(phase))] = value
    model = getfem.Model("real")
    model.add_fem_variable("t", field)
    model.add_initialized_fem_data("k", per_cell, k)
    model.add_generic_elliptic_brick(rule, "t", "k")
    for wall, name in ((HOT, "high"), (COLD, "low")):
        model.add_initialized_data(name, given[name])
        model.add_Dirichlet_condition_with_simplification("t", wall, name)
    model.solve()
    energy = getfem.asm("generic", rule, 0, "k*Norm_sqr(Grad_t)", -1, model)
    heat = getfem.asm("generic", rule, 0, "k*Grad_t.Normal", HOT, model)
    held = sum(len(field.basic_dof_on_region(wall)) for wall in (HOT, COLD))
    cost = clock.so_far()
    unknowns = int(field.nbdof() - held)
    print(json.dumps({"energy": float(energy), "heat": float(heat), "unknowns": unknowns, "cost": cost}))


main()
