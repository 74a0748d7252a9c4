"""Rows of the paper's network: the first cells of all fractions by one packing."""

from __future__ import annotations

from studies.common import paper_network, silica_epoxy
from studies.common.paper_network import unscaled
from studies.fig17_etc.scenes import WALLED, first_cells


def network_row(packing, held, particles, seed):
    """All first cells by one packing of the network.

    Parameters
    ----------
    packing, held : str
        As of `studies.common.paper_network`.
    particles, seed : int
    """
    scenes = first_cells(held)
    made = paper_network.packed(scenes[f"{WALLED:g}"].size, packing, held, particles, seed)
    fields, row = paper_network.solved(scenes, made, held)
    return row | {f"k_{where}": unscaled(field, silica_epoxy.EPOXY.conductivity) for where, field in fields.items()}


def warm_up(packing, held, particles, seed):
    """Make and keep the dispersions and the packing, which are not part of what is compared; load what solves.

    Parameters
    ----------
    packing, held : str
    particles, seed : int
    """
    paper_network.packed(first_cells(held)[f"{WALLED:g}"].size, packing, held, particles, seed)
    paper_network.warm_up(held)
