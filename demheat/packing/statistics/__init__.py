"""Is a packing what it should be: how dense, how connected, how isotropic.

Functions of a packing, and of its links as `contacts` or `neighbours` list them, that return arrays and tuples.
"""

from demheat.packing.statistics.contacts import (
    Backbone,
    Coordination,
    Directions,
    Fabric,
    backbone,
    coordination,
    directions,
    fabric,
)
from demheat.packing.statistics.correlations import RadialDistribution, TwoPoint, radial_distribution, two_point
from demheat.packing.statistics.regions import packing_fraction

__all__ = [
    "Backbone",
    "Coordination",
    "Directions",
    "Fabric",
    "RadialDistribution",
    "TwoPoint",
    "backbone",
    "coordination",
    "directions",
    "fabric",
    "packing_fraction",
    "radial_distribution",
    "two_point",
]
