"""Exact series in time, see `references.exact.series`."""

from references.exact.series import evolve

__all__ = ["evolve"]
