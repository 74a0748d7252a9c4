"""MPI and PETSc, found by import or refused in one line."""

from __future__ import annotations

from importlib import import_module

NEEDED = (
    "demheat.mpi needs mpi4py and petsc4py, which this Python does not find ({}): see the page mpi of the manual for "
    "their commands; without them demheat.solve does the same on one machine"
)


def world():
    """The communicator of all ranks.

    Returns
    -------
    mpi4py.MPI.Comm

    Raises
    ------
    ImportError
        In one line, if MPI or PETSc is missing.
    """
    petsc()
    return _found("mpi4py.MPI").COMM_WORLD


def petsc():
    """The module `petsc4py.PETSc`, begun.

    Raises
    ------
    ImportError
        In one line, if it is missing.
    """
    # MPI first: both then share one.
    _found("mpi4py.MPI")
    return _found("petsc4py.PETSc")


def _found(name):
    try:
        return import_module(name)
    except (ImportError, RuntimeError) as error:  # mpi4py says so of a missing MPI
        raise ImportError(NEEDED.format(" ".join(str(error).split()))) from None
