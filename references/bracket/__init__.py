"""Certain bounds of a scene's conductivity: the energies of a temperature and of a flux that are both admissible.

By Dirichlet's principle the energy of any temperature that fits the load bounds the conductivity from above, by
Thomson's the energy of any balanced flux bounds it from below. Both are worked out on one mesh whose curved interfaces
are pushed to that side of the true ones which keeps the bound.
"""

from importlib import import_module

__all__ = ["Bracket", "Tensor", "solve", "solve_tensor", "voxels"]  # noqa: F822, found by `__getattr__`


def __getattr__(name):
    # What is heavy loads with the first call.
    if name == "voxels":
        return import_module("references.bracket.voxels")
    if name in __all__:
        from references.bracket import solver, tensor

        return getattr(tensor if "ensor" in name else solver, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
