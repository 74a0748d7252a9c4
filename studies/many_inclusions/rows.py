"""Rows of the paper's network: the cell by one packing, or by replicas of it."""

from __future__ import annotations

from studies.common import paper_network
from studies.many_inclusions.scenes import inside, spheres

COLUMN = "k_spheres"


def network_row(**case):
    """The cell of 83 spheres by one packing of the network."""
    fields, row = paper_network.fields_and_row({COLUMN: spheres()}, **case)
    field = fields[COLUMN]
    return row | {"number": len(field.scene.inclusions), "inside": inside(field)}


def warm_up(**case):
    """Make and keep the dispersion and the packing; load what solves."""
    paper_network.warm_up({COLUMN: spheres()}, **case)
