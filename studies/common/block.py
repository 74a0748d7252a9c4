"""The homogeneous block of Haddad et al. (2021), sections 3 and on heat flux, and fields of contact networks in it."""

from dataclasses import replace

from demheat.conduction.steady import solve_steady
from demheat.dem.networks import network_of
from demheat.field import Samples
from demheat.sampling.field_of import field_of
from demheat.sampling.particle_flux import particle_flux
from demheat.scene import Material, Scene

LENGTH, CONDUCTIVITY, COLD, HOT = 0.1, 33.0, 25.0, 35.0


def scene_of(walls, conductivity=CONDUCTIVITY):
    """Block under a mean gradient of 100 K/m."""
    gradient = (0.0, (HOT - COLD) / LENGTH, 0.0)
    load = {"gradient": gradient} if walls == "periodic" else {"walls": {"y-": COLD, "y+": HOT}}
    return Scene(size=(LENGTH,) * 3, matrix=Material(conductivity), **load)


def contact_field(scene, packing, law, split):
    """Field of a network of contacts whose samples have the particles' fluxes by one of the splits."""
    network = network_of(scene, packing, law)
    solution = solve_steady(network, scene)
    field = field_of(scene, network, solution, stats={})
    flux = particle_flux(network, solution, split=split)
    samples = Samples(network.centers, network.volumes, solution.temperature, network.phase, flux)
    return replace(field, sampler=lambda: samples)
