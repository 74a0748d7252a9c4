"""Rows of the paper's network: a sphere in a cube at all contrasts, by one packing."""

from demheat.gallery import sphere_in_cube
from studies.common import paper_network
from studies.fig14_single_inclusion.scenes import FRACTIONS, SCENES, label


def _cubes(held):
    cube = {"periodic": held == "periodic"}
    return {f"k_{label(*each)}": sphere_in_cube(each[1], fraction=FRACTIONS[each[0]], **cube) for each in SCENES}


def network_row(held, **case):
    """All scenes by one packing of the network."""
    return paper_network.row_of(_cubes(held), held=held, **case)
