"""One big steady solve by the discrete element method on several processes, which PETSc solves.

`mpiexec -n 4 python -m demheat.mpi scene.toml --particles 16000000`; or, on every rank alike, `demheat.mpi.solve`. Each
rank makes its slab of the body and nothing else: particles, twins, cells, rows. Needs petsc4py and mpi4py, see the
manual.
"""

from typing import TYPE_CHECKING

from demheat.runtime.lazy import lazy_names

if TYPE_CHECKING:
    from demheat.mpi.solver import solve

__all__ = ["solve"]

# What is heavy loads with the first use; type checkers do not see it, see `lazy_names`.
if not TYPE_CHECKING:
    __getattr__, __dir__ = lazy_names(__name__, {"demheat.mpi.solver": ("solve",)})
