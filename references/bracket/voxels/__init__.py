"""Certain bounds on voxels: of an image whose voxels conduct each as they are told, or of a scene that a grid cuts.

The two principles of `references.bracket` with the simplest admissible fields of a grid, both found by conjugate
gradients that Fourier transforms precondition: a temperature, trilinear in each voxel and continuous, and a flux whose
normal part is constant on each face of a voxel (Raviart and Thomas's of lowest order) and which Fourier modes balance.
J. Vondrejc, J. Zeman and I. Marek, Comput. Methods Appl. Mech. Engrg. 297 (2015) 258-291, bound the same from both
sides with trigonometric polynomials; those are spread over the whole cell and ring at interfaces, while the energies of
these are exact voxel by voxel and fall wherever voxels do.
"""

from typing import TYPE_CHECKING

from demheat.runtime.lazy import lazy_names

if TYPE_CHECKING:
    from references.bracket.voxels.image import bounds, upper_bound
    from references.bracket.voxels.solver import solve
    from references.bracket.voxels.tensor import bounds_tensor, solve_tensor

__all__ = ["bounds", "bounds_tensor", "solve", "solve_tensor", "upper_bound"]

HOMES = {
    "references.bracket.voxels.image": ("bounds", "upper_bound"),
    "references.bracket.voxels.solver": ("solve",),
    "references.bracket.voxels.tensor": ("bounds_tensor", "solve_tensor"),
}
# What is heavy loads with the first use; type checkers do not see it, see `lazy_names`.
if not TYPE_CHECKING:
    __getattr__, __dir__ = lazy_names(__name__, HOMES)
