"""MPI and PETSc, found by import or refused in one line."""

from demheat.beyond import ranks


def world():
    """The communicator of all ranks."""
    return _both()[0].COMM_WORLD


def petsc():
    """The module `petsc4py.PETSc`, begun."""
    return _both()[1]


def _both():
    return ranks.imported("petsc4py.PETSc", instead="demheat.solve")
