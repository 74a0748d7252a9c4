"""What others have published of multigrid on many cores: sizes only, for their equations and machines are others."""

from __future__ import annotations

from typing import NamedTuple


class Published(NamedTuple):
    """A figure from the literature, none of ours."""

    what: str
    unknowns: float
    cores: int
    source: str


PUBLISHED = (
    Published(
        "smoothed aggregation (Prometheus, before GAMG), elasticity of bone, .47 Tflop/s",
        5.37e8,
        4088,
        "Adams, Bayraktar, Keaveny, Papadopoulos, SC2004; 7e6 to 5.37e8 unknowns, 131 000 a processor",
    ),
    Published(
        "hypre's multigrids, more than 100 000 cores and a trillion unknowns",
        1e12,
        100_000,
        "Baker, Falgout, Kolev, Yang, in High-Performance Scientific Computing (Springer 2012), LLNL-JRNL-479591",
    ),
    Published(
        "aggregates of equal values, made by each process alone; nearly 300 000 cores, more than 1e11 unknowns",
        1e11,
        300_000,
        "Blatt, Ippisch, Bastian, arXiv:1209.0960 (2013)",
    ),
    Published(
        "Trilinos of the second generation, flow at low Mach numbers",
        2.7e10,
        524_288,
        "Lin, Bettencourt, Domino et al., Parallel Processing Letters 24 (2014)",
    ),
)
