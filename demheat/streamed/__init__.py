"""One steady solve by the discrete element method that is larger than the memory: slab after slab, kept on disk.

`demheat.streamed.solve(scene, folder=..., particles=...)`. Particles, twins and cells of one slab at a time are in
memory; networks go into a folder, and the matrix is mapped from it while its equations are solved.
"""

__all__ = ["solve"]  # noqa: F822, found by `__getattr__`


def __getattr__(name):
    # What is heavy loads with the first call.
    if name == "solve":
        from demheat.streamed.solver import solve

        return solve
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
