"""Conduction by finite elements: linear or quadratic tetrahedra that conform to the scene's interfaces, or bricks.

The only home of scikit-fem. The mesh is gmsh's, the equations are assembled in blocks of elements (memory stays near
that of the matrix) and solved by conjugate gradients with a multigrid preconditioner.
"""

from typing import TYPE_CHECKING

from demheat.method import OVERSHOOT, SIZE, UNTURNED, Errors, Method, Orders
from demheat.runtime.lazy import lazy_names

if TYPE_CHECKING:
    from references.fem.solver import solve, solve_axes
    from references.fem.transient import evolve

__all__ = ["evolve", "solve", "solve_axes"]

SIZED = {"resolution": SIZE, "small": 1 / 4, "tight": {"tolerance": 1e-11}, "exceptions": UNTURNED | OVERSHOOT}
# Elements: conductivity is an energy, twice the flux's order p; temperature p + 1. From a tenth of the cube on elements
# on the sphere, at most 0.4 of its radius, become smaller too. Meshes follow gaps and spheres besides the size that is
# asked for: nothing can be extrapolated in it.
METHODS = (
    Method(
        name="fem",
        title="FEM",
        label="FEM, P2 on curved elements",
        knobs={"order": 2, "curved": True},
        **SIZED,
        coarse=1 / 6,
        errors=Errors(1.6e-3, 1.1e-3, 0.05),
        # Theory 4, 3, 2; found 3.4, 2.7, 2.0.
        orders=Orders((1 / 10, 1 / 12, 1 / 15), 2.8, 2.3, 1.3),
        look=("blue", "^", "-"),
    ),
    Method(
        name="fem-straight",
        title="FEM, P2, straight",
        label="FEM, P2 on straight elements",
        role="beside",
        knobs={"order": 2, "curved": False},
        **SIZED,
        coarse=1 / 6,
        errors=Errors(1.3e-2, 2.5e-3, 0.25),
        # Chords lose volume of the sphere with h^2, whatever the elements, and put a layer of thickness h^2 in the
        # wrong material: 2, 2, 1; found 1.8, 1.8, 4.1 (few of the points lie in that layer).
        orders=Orders((1 / 10, 1 / 12, 1 / 15), 1.4, 1.4, 0.6),
        look=("blue", "^", "--"),
    ),
    Method(
        name="fem-p1",
        title="FEM, P1",
        role="beside",
        knobs={"order": 1, "curved": False},
        **SIZED,
        coarse=1 / 10,
        errors=Errors(2.5e-2, 5e-3, 0.33),
        # Theory 2, 2, 1; found 1.7, 1.8, 1.6.
        orders=Orders((1 / 10, 1 / 14, 1 / 20), 1.5, 1.5, 0.7),
        look=("sky", "^", ":"),
    ),
    Method(
        name="fem-bricks",
        title="FEM, bricks",
        role="beside",
        knobs={"elements": "hexahedra"},
        call="evolve",
        resolution=SIZE,
        small=1 / 4,
        coarse=1 / 12,
        tight={"tolerance": 1e-11},
        exceptions={
            "errors": "its grid follows layers alone, and these are exact",
            "orders": "its grid follows layers alone, and these are exact",
        },
        refuses={"spheres": "hexahedra follow boxes of layers only", "gradient": "a transient needs walls"},
        look=("sky", "s", "--"),
    ),
)

HOMES = {
    "references.fem.solver": ("solve", "solve_axes"),
    "references.fem.transient": ("evolve",),
}
# What is heavy loads with the first use; type checkers do not see it, see `lazy_names`.
if not TYPE_CHECKING:
    __getattr__, __dir__ = lazy_names(__name__, HOMES)
