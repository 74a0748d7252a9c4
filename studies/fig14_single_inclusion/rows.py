"""Rows of the paper's network: a sphere in a cube at all contrasts, by one packing."""

from __future__ import annotations

from demheat.gallery import sphere_in_cube
from studies.common import paper_network
from studies.fig14_single_inclusion.scenes import FRACTIONS, SCENES, label


def _cubes(held):
    cube = {"periodic": held == "periodic"}
    return {f"k_{label(*each)}": sphere_in_cube(each[1], fraction=FRACTIONS[each[0]], **cube) for each in SCENES}


def network_row(held, **case):
    """All scenes by one packing of the network."""
    return paper_network.row_of(_cubes(held), held=held, **case)


def warm_up(held, **case):
    """Make and keep the packing; load what solves."""
    paper_network.warm_up(_cubes(held), held=held, **case)
