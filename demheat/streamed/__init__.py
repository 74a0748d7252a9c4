"""One steady solve by the discrete element method that is larger than the memory: slab after slab, kept on disk.

`demheat.streamed.solve(scene, folder=..., particles=...)`. Particles, twins and cells of one slab at a time are in
memory; networks go into a folder, and the matrix is mapped from it while its equations are solved.
"""

from typing import TYPE_CHECKING

from demheat.lazy import lazy_names

if TYPE_CHECKING:
    from demheat.streamed.solver import solve

__all__ = ["solve"]

# What is heavy loads with the first use.
__getattr__ = lazy_names(__name__, {"demheat.streamed.solver": ("solve",)})
