"""Effective conductivities by walkers: a witness without a grid, which gives the conductivity alone and its interval.

Heat is carried by Brownian walkers that leap from sphere to sphere (first passage), and choose a side at interfaces. I.
C. Kim and S. Torquato, J. Appl. Phys. 68 (1990) 3892 and 69 (1991) 2280; A. Lejay and S. Maire, Commun. Comput. Phys.
13 (2013) 1130, on what kinds of kinetics interfaces allow.
"""

from typing import TYPE_CHECKING

from demheat.runtime.lazy import lazy_names

if TYPE_CHECKING:
    from references.walkers.solver import Walked, solve

__all__ = ["Walked", "solve"]

HOMES = {"references.walkers.solver": ("Walked", "solve")}
# What is heavy loads with the first use; type checkers do not see it, see `lazy_names`.
if not TYPE_CHECKING:
    __getattr__, __dir__ = lazy_names(__name__, HOMES)
