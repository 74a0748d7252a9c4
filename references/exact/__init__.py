"""Exact solutions: closed forms, cubic arrays by Rayleigh's method, series in time."""

__all__ = ["evolve", "solve"]  # noqa: F822, found by `__getattr__`


def __getattr__(name):
    # What is heavy loads with the first call.
    if name == "solve":
        from references.exact.solver import solve

        return solve
    if name == "evolve":
        from references.exact.series import evolve

        return evolve
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
