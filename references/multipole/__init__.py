"""Rayleigh's multipole method for any number of disjoint spheres in a periodic cell or between isothermal walls."""

from typing import TYPE_CHECKING

from demheat.method import DEGREE, Errors, Method, Orders
from demheat.runtime.lazy import lazy_names

if TYPE_CHECKING:
    from references.multipole.solver import solve, solve_axes
    from references.multipole.third_order import zeta2

__all__ = ["solve", "solve_axes", "zeta2"]

METHODS = (
    Method(
        name="multipole",
        title="multipoles",
        role="witness",
        resolution=DEGREE,
        small=3,
        coarse=16,
        errors=Errors(1e-12, 5e-10, 3.2e-8),
        # Errors fall by a factor with each degree, faster than any power of it; found 9.1, 5.1, 4.5 over these.
        orders=Orders((3, 5, 7, 9), 6.0, 4.0, 3.0),
        exceptions={"integral": "its samples are the middles of equal cells, blind to interfaces"},
        refuses={
            "flux": "multipole: walls",
            "cut": "is cut by a wall",
            "layers": "multipole knows disjoint spheres",
            "nested": "nested in",
        },
        look=("grey", "*", "-"),
    ),
)

HOMES = {
    "references.multipole.solver": ("solve", "solve_axes"),
    "references.multipole.third_order": ("zeta2",),
}
# What is heavy loads with the first use; type checkers do not see it, see `lazy_names`.
if not TYPE_CHECKING:
    __getattr__, __dir__ = lazy_names(__name__, HOMES)
