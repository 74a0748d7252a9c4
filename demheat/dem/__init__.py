"""The discrete element method: a packing, its network of conductances, and the field they give."""

__all__ = ["evolve", "solve"]  # noqa: F822, found by `__getattr__`


def __getattr__(name):
    # What is heavy loads with the first call.
    if name == "solve":
        from demheat.dem.solver import solve

        return solve
    if name == "evolve":
        from demheat.dem.solver import evolve

        return evolve
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
