"""Conduction in a body by FEniCS, by a Python that has it: reads one JSON object, prints another as its last line."""

import json
import sys

import dolfin
import numpy as np
from dolfin import assemble, dot, ds, dx, grad
from spent import Spent


def read(points, cells):
    """Its mesh."""
    mesh, editor = dolfin.Mesh(), dolfin.MeshEditor()
    editor.open(mesh, "tetrahedron", 3, 3)
    editor.init_vertices(len(points))
    editor.init_cells(len(cells))
    for number, point in enumerate(points):
        editor.add_vertex(number, point)
    for number, nodes in enumerate(cells.astype(np.uintp)):
        editor.add_cell(number, nodes)
    editor.close(True)
    return mesh


def solve(mesh, conductivity, given):
    """Energy (W K), heat through the hot wall (W), and unknowns."""
    space, per_cell = dolfin.FunctionSpace(mesh, "P", given["order"]), dolfin.FunctionSpace(mesh, "DG", 0)
    k = dolfin.Function(per_cell)
    values = k.vector().get_local()
    values[per_cell.dofmap().entity_dofs(mesh, 3)] = conductivity
    k.vector().set_local(values)
    k.vector().apply("insert")
    sides = [dolfin.CompiledSubDomain("on_boundary && near(x[0], at)", at=at) for at in (0.0, given["length"])]
    walls = [dolfin.DirichletBC(space, given[name], side) for name, side in zip(("high", "low"), sides, strict=True)]
    u, v, t = dolfin.TrialFunction(space), dolfin.TestFunction(space), dolfin.Function(space)
    dolfin.solve(k * dot(grad(u), grad(v)) * dx == dolfin.Constant(0.0) * v * dx, t, walls)
    parts = dolfin.MeshFunction("size_t", mesh, 2, 0)
    sides[0].mark(parts, 1)
    normal = dolfin.FacetNormal(mesh)
    heat = assemble(k * dot(grad(t), normal) * ds(1, subdomain_data=parts))
    held = sum(len(wall.get_boundary_values()) for wall in walls)
    return assemble(k * dot(grad(t), grad(t)) * dx), heat, space.dim() - held


def main():
    """Solve."""
    given = json.load(sys.stdin)
    dolfin.set_log_level(dolfin.LogLevel.ERROR)
    # Compile.
    solve(dolfin.UnitCubeMesh(1, 1, 1), np.ones(6), given | {"length": 1.0})
    parts = np.load(f"{given['mesh']}.npz")
    mesh, groups = read(parts["points"], parts["cells"]), parts["groups"]
    phases = {int(phase): k for phase, k in given["phases"].items()}
    conductivity = np.array([phases[group] for group in groups.tolist()])
    clock = Spent()
    energy, heat, unknowns = solve(mesh, conductivity, given)
    cost = clock.so_far()
    print()
    print(json.dumps({"energy": float(energy), "heat": float(heat), "unknowns": int(unknowns), "cost": cost}))


main()
