"""Rows of the study of halos: the fluxes of particles in a homogeneous block, and their averages."""

from __future__ import annotations

from dataclasses import replace

from demheat.build import network_of
from demheat.conduction.steady import solve_steady
from demheat.dem import solve
from demheat.field import Samples
from demheat.laws import Calibrated
from demheat.packing.cache import relaxed
from demheat.sampling.field_of import field_of
from demheat.sampling.halo import halo_flux
from demheat.sampling.particle_flux import particle_flux
from demheat.scene import Material, Scene
from studies.fig10_halo.statistics import COSTED, RATIOS, by_radius
from studies.harness.cost import measured

LENGTH, CONDUCTIVITY, COLD, HOT = 0.1, 33.0, 25.0, 35.0


def flux_row(law, split, walls, particles, seed):
    """Statistics of the flux by halo radius, each a list in one cell, and density functions.

    Parameters
    ----------
    law, split, walls, particles, seed
        Of a case.

    Returns
    -------
    dict
    """
    packing = packing_of(walls, particles, seed)
    if law == "laguerre":
        field, row = _laguerre(packing)
        _, cost = measured(lambda: field.samples)
        return row | by_radius(field, {0.0: field.samples.flux}) | cost
    field, row = _calibrated(packing, walls, split)
    # Halos no wider than the periodic cell.
    most = LENGTH / 2 if walls == "periodic" else LENGTH
    fluxes, cost = {0.0: field.samples.flux}, {}
    for ratio in RATIOS[1:]:
        if ratio * field.stats["mean_radius"] <= most:
            fluxes[ratio], spent = measured(halo_flux, field, ratio=ratio)
            cost = spent if ratio == COSTED else cost
    return row | by_radius(field, fluxes) | cost


def scene_of(walls):
    """Block under the same mean gradient between two walls ("held") or in a periodic cell ("periodic")."""
    gradient = (0.0, (HOT - COLD) / LENGTH, 0.0)
    load = {"gradient": gradient} if walls == "periodic" else {"walls": {"y-": COLD, "y+": HOT}}
    return Scene(size=(LENGTH,) * 3, matrix=Material(CONDUCTIVITY), **load)


def packing_of(walls, particles, seed):
    """Packing between the walls or in the cell, kept in the cache.

    Parameters
    ----------
    walls : {"held", "periodic"}
    particles, seed : int

    Returns
    -------
    Packing
    """
    return relaxed(particles, size=(LENGTH,) * 3, periodic=walls == "periodic", seed=seed)


def _laguerre(packing):
    field = solve(scene_of("held"), packing=packing)
    return field, {name: field.stats[name] for name in ("unknowns", "iterations", "residual")}


def _calibrated(packing, walls, split):
    """Field of the paper's network, with the flux of each particle by one of the two splits."""
    scene = scene_of(walls)
    network = network_of(scene, packing, Calibrated())
    solution = solve_steady(network, scene)
    field = field_of(scene, network, solution, stats={})
    flux = particle_flux(network, solution, split=split)
    samples = Samples(network.centers, network.volumes, solution.temperature, network.phase, flux)
    row = {name: field.stats[name] for name in ("unknowns", "iterations", "residual")}
    row = {"ct": network.stats["calibration"]} | row
    return replace(field, sampler=lambda: samples), row
