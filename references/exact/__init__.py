"""Exact solutions: closed forms, cubic arrays by Rayleigh's method, series in time."""

from demheat.method import Method

__all__ = ["evolve", "solve", "solve_axes"]  # noqa: F822, found by `__getattr__`

METHODS = (
    Method(
        name="exact",
        title="exact",
        label="exact (Rayleigh)",
        role="witness",
        exceptions={
            "errors": "it is what the others are held against",
            "integral": "its samples are the middles of equal cells, blind to interfaces",
        },
        refuses={"several": "no closed form"},
        look=("black", "", "-"),
    ),
)


def __getattr__(name):
    # What is heavy loads with the first call.
    if name == "solve":
        from references.exact.solver import solve

        return solve
    if name == "solve_axes":
        from references.exact.solver import solve_axes

        return solve_axes
    if name == "evolve":
        from references.exact.series import evolve

        return evolve
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
