"""Certain bounds on voxels: of an image whose voxels conduct each as they are told, or of a scene that a grid cuts.

The two principles of `references.bracket` with the simplest admissible fields of a grid, both found by conjugate
gradients that Fourier transforms precondition: a temperature, trilinear in each voxel and continuous, and a flux whose
normal part is constant on each face of a voxel (Raviart and Thomas's of lowest order) and which Fourier modes balance.
J. Vondrejc, J. Zeman and I. Marek, Comput. Methods Appl. Mech. Engrg. 297 (2015) 258-291, bound the same from both
sides with trigonometric polynomials; those are spread over the whole cell and ring at interfaces, while the energies of
these are exact voxel by voxel and fall wherever voxels do.
"""

__all__ = ["bounds", "bounds_tensor", "solve", "solve_tensor", "upper_bound"]  # noqa: F822, found by `__getattr__`


def __getattr__(name):
    # What is heavy loads with the first call.
    if name in __all__:
        from references.bracket.voxels import image, solver, tensor

        home = tensor if "tensor" in name else solver if name == "solve" else image
        return getattr(home, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
