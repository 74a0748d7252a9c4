"""One big steady solve by the discrete element method on several processes, which PETSc solves.

`mpiexec -n 4 python -m demheat.mpi scene.toml --particles 16000000`; or, on every rank alike, `demheat.mpi.solve`. Each
rank makes its slab of the body and nothing else: particles, twins, cells, rows. Needs petsc4py and mpi4py, see the
manual.
"""

__all__ = ["solve"]  # noqa: F822, found by `__getattr__`


def __getattr__(name):
    # What is heavy loads with the first call.
    if name == "solve":
        from demheat.mpi.solver import solve

        return solve
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
