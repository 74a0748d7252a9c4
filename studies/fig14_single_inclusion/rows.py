"""Rows of the paper's network: a sphere in a cube at all contrasts, by one packing."""

from __future__ import annotations

from demheat.gallery import EDGE, sphere_in_cube
from studies.common import paper_network
from studies.common.paper_network import unscaled
from studies.fig14_single_inclusion.scenes import FRACTIONS, SCENES, label
from studies.harness import methods


def network_row(packing, held, particles, seed):
    """All scenes by one packing of the network.

    Parameters
    ----------
    packing, held : str
        As of `studies.common.paper_network`.
    particles, seed : int
    """
    scenes = {
        label(*where): sphere_in_cube(where[1], fraction=FRACTIONS[where[0]], periodic=held == "periodic")
        for where in SCENES
    }
    made = paper_network.packed((EDGE,) * 3, packing, held, particles, seed)
    fields, row = paper_network.solved(scenes, made, held)
    return row | {f"k_{where}": unscaled(field, methods.MATRIX) for where, field in fields.items()}


def warm_up(packing, held, particles, seed):
    """Make and keep the packing, which is not part of what is compared; load what solves.

    Parameters
    ----------
    packing, held : str
    particles, seed : int
    """
    paper_network.packed((EDGE,) * 3, packing, held, particles, seed)
    paper_network.warm_up(held)
