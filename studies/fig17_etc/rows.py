"""Rows of the paper's network: the first cells of all fractions by one packing."""

from studies.common import paper_network
from studies.fig17_etc.scenes import first_cells


def _cells(held):
    return {f"k_{fraction}": scene for fraction, scene in first_cells(held).items()}


def network_row(held, **case):
    """All first cells by one packing of the network."""
    return paper_network.row_of(_cells(held), held=held, **case)
