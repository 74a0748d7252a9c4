"""PETSc by petsc4py: conjugate gradients on our network, preconditioned by its algebraic multigrid or by hypre's.

The equations of a body's particles (radical tessellation, twins at interfaces) go over as arrays; PETSc sets up and
solves with one process, from the temperatures that ours begins with, down to a true residual of 1e-10; set-up and
solve are the cost, reading and copying the matrix are not. "gamg" is smoothed aggregation with its defaults,
"boomeramg" hypre's with the settings that its manual advises in three dimensions. Debian's build, 32-bit indices.
https://petsc.org, version 3.18.5. Its documentation prints no value of a conductivity: no `own`.
"""

from studies.peers import networks, packages

TITLE = "PETSc"
KIND = "network"
GET = "apt: python3-petsc4py-real"
CANNOT = {"pores": "particles without an equation, which only our own solver knows"}
EXPLAINED = "all of it: the error is that of our network, whoever solves it"
CASES = networks.cases(("gamg", "boomeramg"))
missing, version = packages.asked_of("petsc", GET, module="petsc4py")


def solve(scene, *, particles, solver="gamg"):
    """Solve our network of a body."""
    return networks.solved_by("petsc", scene, particles=particles, solver=solver, module="petsc4py")
