"""Rows of the paper's network: the cell by one packing, or by replicas of it."""

from __future__ import annotations

from studies.common import paper_network, silica_epoxy
from studies.common.paper_network import unscaled
from studies.many_inclusions.scenes import inside, spheres


def network_row(packing, held, particles, seed, replicas=1):
    """The cell of 83 spheres by one packing of the network.

    Parameters
    ----------
    packing, held, particles, seed, replicas
        As of `studies.common.paper_network`.
    """
    scene = spheres()
    one = paper_network.packed(scene.size, packing, held, particles, seed, replicas)
    fields, row = paper_network.solved({"k": scene}, one, held, replicas)
    k = unscaled(fields["k"], silica_epoxy.EPOXY.conductivity)
    return row | {"k_spheres": k, "number": len(scene.inclusions), "inside": inside(fields["k"])}


def warm_up(packing, held, particles, seed, replicas=1):
    """Make and keep the dispersion and the packing, which are not part of what is compared; load what solves.

    Parameters
    ----------
    packing, held, particles, seed, replicas
        As those of `network_row`.
    """
    paper_network.packed(spheres().size, packing, held, particles, seed, replicas)
    paper_network.warm_up(held)
