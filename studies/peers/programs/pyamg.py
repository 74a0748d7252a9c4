"""PyAMG: conjugate gradients on our network, preconditioned by classical or aggregated multigrid.

The same equations, first temperatures, residual and cost as those of PETSc; its defaults else.
https://pyamg.readthedocs.io, version 5.3.0. Its documentation prints no value of a conductivity: no `own`.
"""

from studies.peers import networks, packages

TITLE = "PyAMG"
KIND = "network"
GET = "pip: pyamg"
CANNOT = {"pores": "particles without an equation, which only our own solver knows"}
EXPLAINED = "all of it: the error is that of our network, whoever solves it"
CASES = networks.cases(("ruge_stuben", "smoothed_aggregation"))
missing, version = packages.asked_of("pyamg", GET)


def solve(scene, *, particles, solver="ruge_stuben"):
    """Solve our network of a body."""
    return networks.solved_by("pyamg", scene, particles=particles, solver=solver)
