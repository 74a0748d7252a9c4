"""Beds of grains out of DEM simulations: contacts and gaps as a network, their temperatures, and the heat of each pair.

    from demheat import grains
    from demheat.io import packings

    bed = packings.read("bed.liggghts").scaled(1e-3)  # a file in millimetres
    field = grains.solve(bed, 16.0, walls={"z-": 80.0, "z+": 20.0}, gap=grains.Gap(conductivity=0.026))
    field.conductivity, field.temperature, field.pairs, field.heat
    field.write("flows.csv")

Unlike the methods, which solve a Scene as a continuum, this is a model of its own, standard for granular matter: one
temperature for each grain. What it is worth beside the continuum is measured by study `grains`.
"""

from demheat.grains.contact_files import read_contacts
from demheat.grains.field import GrainField
from demheat.grains.laws import Fixed, Gap, Hertz, Overlap
from demheat.grains.pairs import Contacts
from demheat.grains.solver import solve

__all__ = ["Contacts", "Fixed", "Gap", "GrainField", "Hertz", "Overlap", "read_contacts", "solve"]
