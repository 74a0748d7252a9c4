"""Rayleigh's multipole method for any number of disjoint spheres in a periodic cell or between isothermal walls."""

__all__ = ["solve", "zeta2"]  # noqa: F822, found by `__getattr__`


def __getattr__(name):
    # What is heavy loads with the first call.
    if name == "solve":
        from references.multipole.solver import solve

        return solve
    if name == "zeta2":
        from references.multipole.third_order import zeta2

        return zeta2
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
