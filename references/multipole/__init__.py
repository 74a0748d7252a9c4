"""Rayleigh's multipole method for any number of disjoint spheres in a periodic cell."""

from references.multipole.solver import solve, zeta2

__all__ = ["solve", "zeta2"]
