"""Conduction in a body by SfePy, by a Python that has it: reads one JSON object, prints another as its last line."""

import json
import sys

import numpy as np
from sfepy.base.base import Struct, output
from sfepy.discrete import Equation, Equations, FieldVariable, Integral, Material, Problem
from sfepy.discrete.conditions import Conditions, EssentialBC
from sfepy.discrete.fem import FEDomain, Field, Mesh
from sfepy.solvers import Solver
from sfepy.solvers.nls import Newton
from sfepy.terms import Term
from spent import Spent

# Of PETSc's conjugate gradients, by the norm of the preconditioned residual.
TOLERANCE = 1e-12


def body(mesh, given):
    """The problem, and its material."""
    parts = Mesh.from_data("body", mesh["points"], None, [mesh["cells"]], [mesh["groups"]], ["3_4"])
    domain = FEDomain("domain", parts)
    omega = domain.create_region("Omega", "all")
    near = 1e-9 * given["length"]
    hot = domain.create_region("Hot", f"vertices in (x < {near!r})", "facet")
    cold = domain.create_region("Cold", f"vertices in (x > {given['length'] - near!r})", "facet")
    for phase in given["phases"]:
        domain.create_region(f"Phase{phase}", f"cells of group {phase}")
    field = Field.from_args("temperature", np.float64, 1, omega, approx_order=given["order"])
    t = FieldVariable("t", "unknown", field)
    s = FieldVariable("s", "test", field, primary_var_name="t")
    k = {f"Phase{phase}": k for phase, k in given["phases"].items()}
    # The term of the flux wants tensors.
    m = Material("m", values={"k": k, "K": {name: value * np.eye(3) for name, value in k.items()}})
    term = Term.new("dw_laplace(m.k, s, t)", Integral("i", order=2 * given["order"]), omega, m=m, s=s, t=t)
    problem = Problem("conduction", equations=Equations([Equation("balance", term)]))
    held = [EssentialBC("hot", hot, {"t.0": given["high"]}), EssentialBC("cold", cold, {"t.0": given["low"]})]
    problem.set_bcs(ebcs=Conditions(held))
    return problem, m


def main():
    """Solve."""
    given = json.load(sys.stdin)
    output.set_output(quiet=True)
    mesh = dict(np.load(f"{given['mesh']}.npz"))
    clock = Spent()
    problem, m = body(mesh, given)
    # What `ls.auto_iterative` tries first, with a residual of ours.
    knobs = {"method": "cg", "precond": "icc", "eps_r": TOLERANCE, "eps_a": 1e-30, "i_max": 100_000}
    linear = Solver.any_from_conf(Struct(name="ls", kind="ls.petsc", **knobs))
    # One step: the equations are linear.
    problem.set_solver(Newton({"i_max": 1, "eps_a": 1e-300, "eps_r": 1.0}, lin_solver=linear))
    problem.solve(save_results=False)
    degree = 2 * given["order"]
    energy = problem.evaluate(f"dw_laplace.{degree}.Omega(m.k, t, t)", mode="eval", m=m)
    flux = problem.evaluate(f"ev_surface_flux.{degree}.Hot(m.K, t)", mode="eval", m=m)
    unknowns = int(problem.equations.variables.adi.ptr[-1])
    cost = clock.so_far()
    # Its flux is -k grad T, and leaves.
    print(json.dumps({"energy": float(energy), "heat": abs(float(np.sum(flux))), "unknowns": unknowns, "cost": cost}))


main()
