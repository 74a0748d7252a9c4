"""Certain bounds of a scene's conductivity: the energies of a temperature and of a flux that are both admissible.

By Dirichlet's principle the energy of any temperature that fits the load bounds the conductivity from above, by
Thomson's the energy of any balanced flux bounds it from below. Both are worked out on one mesh whose curved interfaces
are pushed to that side of the true ones which keeps the bound.
"""

from typing import TYPE_CHECKING

from demheat.runtime.lazy import lazy_names
from references.bracket import voxels

if TYPE_CHECKING:
    from references.bracket.answers import Bracket, Tensor
    from references.bracket.solver import solve
    from references.bracket.tensor import solve_tensor

__all__ = ["Bracket", "Tensor", "solve", "solve_tensor", "voxels"]

HOMES = {
    "references.bracket.answers": ("Bracket", "Tensor"),
    "references.bracket.solver": ("solve",),
    "references.bracket.tensor": ("solve_tensor",),
}
# What is heavy loads with the first use; type checkers do not see it, see `lazy_names`.
if not TYPE_CHECKING:
    __getattr__, __dir__ = lazy_names(__name__, HOMES)
