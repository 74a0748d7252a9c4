"""Each rank's slab of particles and of cells."""

from __future__ import annotations

from demheat.build import warn_of_twins
from demheat.dem.options import Particles
from demheat.laws import Laguerre
from demheat.packing.base import Packing
from demheat.scene import Scene
from demheat.tiles import cells as tiles
from demheat.tiles.cells import Cells
from demheat.tiles.slabs import Slabs


def part_of(scene: Scene, law: Laguerre, wanted: Particles, slabs: Slabs, comm) -> Packing:
    """The particles and twins that lie in a slab or near it, in the box."""
    # One makes what all read.
    for turn in (0, 1):
        if turn == min(comm.rank, 1):
            packing, part = tiles.packed(scene, law, wanted, slabs)
        comm.Barrier()
    packing = tiles.conformed(packing, part, scene, law, wanted)
    if law.conforming and comm.rank == 0:
        warn_of_twins(packing, wanted.particles)
    return packing


def cells_of(scene: Scene, law: Laguerre, packing: Packing, slabs: Slabs, comm) -> Cells:
    """Cells of a rank's part of a packing, and their conductances."""
    # Handed over and not kept.
    given = [packing]
    del packing
    cells = tiles.cells_of(scene, law, given.pop(), slabs)
    tiles.check_filled(comm.allreduce(float(cells.network.volumes[: cells.own].sum())), scene)
    return cells


def check_unknowns(comm, own: int) -> int:
    """The number of unknowns of all ranks, which PETSc counts in 32 bits."""
    total = comm.allreduce(own)
    if total >= 2**31:
        raise ValueError(f"particles: {total} unknowns, and this PETSc counts to {2**31 - 1}; must be fewer")
    return total
