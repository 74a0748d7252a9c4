"""Exact solutions: closed forms, cubic arrays by Rayleigh's method, series in time."""

from typing import TYPE_CHECKING

from demheat.method import Method
from demheat.runtime.lazy import lazy_names

if TYPE_CHECKING:
    from references.exact.series import evolve
    from references.exact.solver import solve, solve_axes

__all__ = ["evolve", "solve", "solve_axes"]

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

HOMES = {
    "references.exact.solver": ("solve", "solve_axes"),
    "references.exact.series": ("evolve",),
}
# What is heavy loads with the first use; type checkers do not see it, see `lazy_names`.
if not TYPE_CHECKING:
    __getattr__, __dir__ = lazy_names(__name__, HOMES)
