"""Rows of the study of halos: the fluxes of particles in a homogeneous block, and their averages."""

from demheat.dem import solve
from demheat.laws import Calibrated
from demheat.packing.cache import relaxed
from demheat.sampling.halo import halo_flux
from studies.common.block import LENGTH, contact_field, scene_of
from studies.fig10_halo.statistics import COSTED, RATIOS, by_radius, near_wall
from studies.harness.cost import measured


def flux_row(law, split, walls, particles, seed):
    """Statistics of the flux by halo radius, each a list in one cell, density functions, and the flux near a wall."""
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
    row |= near_wall(field, fluxes) if walls == "held" else {}
    return row | by_radius(field, fluxes) | cost


def packing_of(walls, particles, seed):
    """Packing between the walls or in the cell, kept in the cache."""
    return relaxed(particles, size=(LENGTH,) * 3, periodic=walls == "periodic", seed=seed)


def _laguerre(packing):
    field = solve(scene_of("held"), packing=packing)
    return field, {name: field.stats[name] for name in ("unknowns", "iterations", "residual")}


def _calibrated(packing, walls, split):
    """Field of the paper's network, with the flux of each particle by one of the two splits."""
    field = contact_field(scene_of(walls), packing, Calibrated(), split)
    row = {"ct": field.stats["calibration"]}
    return field, row | {name: field.stats[name] for name in ("unknowns", "iterations", "residual")}
