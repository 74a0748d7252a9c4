"""Memory and room on disk that a solve in slabs is expected to take."""

from __future__ import annotations

from demheat.dem import memory as whole
from demheat.tiles.slabs import GHOSTS, MARGIN, Slabs

# Bytes of the solve for each unknown: its preconditioner and vectors; the matrix is mapped.
SOLVE = 240
# Bytes of each particle of a packing that is relaxed, as one from the cache is not: 530 found of 40 thousand.
RELAXED = 530
# Bytes on disk of each particle that a slab sees, and of each unknown while the matrix is there.
SEEN, MATRIX = 325, 205


def expected(number: float, slabs: Slabs, relaxed: float = 0.0) -> float:
    """Bytes at the peak, besides Python and libraries: of the packing, of the cells of one slab, or of the solve.

    Found with four slabs of a cube: 603 an unknown of 212 thousand, 300 of 1.03 million, by cells; with eight 536.
    """
    return max(whole.expected(number * _share(slabs, GHOSTS + MARGIN)), SOLVE * number, RELAXED * relaxed)


def on_disk(number: float, slabs: Slabs) -> float:
    """Bytes that the folder holds at most."""
    return (SEEN * slabs.ranks * _share(slabs, GHOSTS) + MATRIX) * number


def _share(slabs, beyond):
    """Of the body, that one slab sees with so many radii on either side."""
    return min(1.0, 1.0 / slabs.ranks + 2 * beyond * slabs.unit / slabs.length)
