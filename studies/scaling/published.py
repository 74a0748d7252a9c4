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
        "multigrid of HyTeG on nested grids, Stokes flow; more than 140 000 processes and a trillion unknowns",
        1e12,
        140_000,
        "U. Rüde, project page at konwihr.de, Coarse grid solver optimization for extreme-scale geometric multigrid",
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
        "Lin, Bettencourt, Domino et al., Towards extreme-scale simulations for low Mach fluids with second-generation "
        "Trilinos, preprint of Sandia National Laboratories (2014)",
    ),
)
