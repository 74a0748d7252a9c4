"""Exact solutions: closed forms, cubic arrays by Rayleigh's method, series in time."""

from references.exact.series import evolve
from references.exact.solver import solve

__all__ = ["evolve", "solve"]
