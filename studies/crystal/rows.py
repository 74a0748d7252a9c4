"""Rows of the study of crystals: the Platonic network beside finite differences, and its conductivity."""

from __future__ import annotations

import math

import numpy as np

from demheat import Flux, Material, Scene, Sphere, referee, solve
from demheat.conduction.transient import capacities
from demheat.dem.networks import network_of
from demheat.laws import Platonic
from demheat.network.platonic import CRYSTALS, crystal_packing, fraction_factors, surface_factors
from demheat.packing.base import make_packing
from demheat.scene import WALLS
from studies.crystal import stencil
from studies.crystal.stencil import Grid

# Edge of a cell, and materials with the density and the heat capacity of aluminium (Terreros et al. 2013).
EDGE, MATRIX, SPHERE = 2e-3, Material(134.0, 2790.0, 880.0), Material(1340.0, 2000.0, 500.0)
LOADS = {
    "two walls": {"x-": 298.0, "x+": 798.0},
    "corner": {"x-": 298.0, "y+": 798.0, "z-": Flux(2e5)},
}
SPAN = 500.0


def spheres(cells, crystal="simple cubic", *, periodic):
    """Touching spheres of a crystal in a box of cubic cells."""
    sites = np.array(CRYSTALS[crystal], dtype=float)
    corners = np.stack(np.meshgrid(*map(np.arange, cells), indexing="ij"), axis=-1).reshape(-1, 1, 3)
    centers = (corners + sites + (0.0 if periodic else 0.5)).reshape(-1, 3) * EDGE
    nearest = np.linalg.norm(sites[1:], axis=1).min() if len(sites) > 1 else 1.0
    radii = np.full(len(centers), 0.5 * nearest * EDGE)
    return make_packing(centers, radii, np.array(cells) * EDGE, periodic, {"algorithm": "crystal"})


def stencil_row(cells, walls, sphere):
    """Largest differences between network and grid, relative to the largest value or the span of temperature."""
    size = np.array(cells) * EDGE
    # A radius that passes no centre of a cell.
    inclusions = [Sphere(tuple(size / 2), 3.3 * EDGE, SPHERE)] if sphere else []
    scene = Scene(tuple(size), MATRIX, inclusions, walls=LOADS[walls])
    packing, grid = spheres(cells, periodic=False), _grid(scene, cells)
    network, capacity = _network(scene, packing)
    place = tuple(np.floor(packing.centers / EDGE).astype(int).T)
    row = {"particles": packing.number}
    pairs = zip(_links(network, place, cells), stencil.links(grid), strict=True)
    row["conductance"] = max(_off(ours, theirs) for ours, theirs in pairs)
    pairs = [(_wall_links(network, place, cells, name), stencil.wall_links(grid, name)) for name in WALLS]
    row["wall_conductance"] = max(_off(ours, theirs) for ours, theirs in pairs)
    row["capacity"] = _off(capacity, grid.capacity[place])
    rough = np.random.default_rng(0).uniform(298.0, 798.0, grid.k.shape)
    dt = float((grid.capacity / (12.0 * EDGE * grid.k)).min())
    after = rough[place] + dt / capacity * _received(network, scene, rough[place])
    row["step"] = _off(after, stencil.explicit_step(grid, rough, dt)[place], scale=SPAN)
    knobs = {"law": "platonic", "coordination": 6.0, "wall": "surface"}
    field = solve(scene, packing=packing, tolerance=1e-14, **knobs)
    at = tuple(np.floor(field.samples.points / EDGE).astype(int).T)
    row["steady"] = _off(field.samples.temperature, stencil.steady(grid)[at], scale=SPAN)
    return row | {name: field.stats[name] for name in ("unknowns", "iterations", "residual")}


def _grid(scene, cells):
    """The same scene on a grid of cells."""
    centers = (np.stack(np.meshgrid(*map(np.arange, cells), indexing="ij"), axis=-1) + 0.5) * EDGE
    k, heat = np.full(cells, MATRIX.conductivity), np.full(cells, MATRIX.density * MATRIX.heat_capacity)
    if scene.inclusions:
        inside = np.linalg.norm(centers - np.array(cells) * EDGE / 2, axis=-1) < scene.inclusions[0].radius
        k[inside], heat[inside] = SPHERE.conductivity, SPHERE.density * SPHERE.heat_capacity
    return Grid(EDGE, k, heat * EDGE**3, scene.wall_temperatures, scene.wall_fluxes)


def _network(scene, packing):
    """The Platonic network of the crystal, as `solve` makes it, and its heat capacities."""
    network = network_of(scene, packing, Platonic(coordination=6.0, wall="surface"))
    return network, capacities(network, scene)


def _links(network, place, cells):
    """Conductances on a grid, one array per axis; NaN where the network lacks a link that the grid has."""
    rows = np.repeat(np.arange(len(place[0])), np.diff(network.indptr))
    step = np.stack([x[network.indices] - x[rows] for x in place])
    for axis in range(3):
        found = np.full(np.array(cells) - (np.arange(3) == axis), np.nan)
        ahead = step[axis] == 1
        found[tuple(x[rows[ahead]] for x in place)] = network.conductance[ahead]
        yield found
    # A link that the grid does not have.
    assert np.all(abs(step).sum(axis=0) == 1)


def _wall_links(network, place, cells, name):
    """Conductances to a wall, on the grid of its cells."""
    axis = "xyz".index(name[0])
    here = network.wall_side == WALLS.index(name)
    across = [k for k in range(3) if k != axis]
    found = np.full([cells[k] for k in across], np.nan)
    found[tuple(place[k][network.wall_particle[here]] for k in across)] = network.wall_conductance[here]
    return found


def _received(network, scene, temperature):
    """Heat that each particle receives (Terreros et al. 2013, eq. 7), (n,) float array, W."""
    rows = np.repeat(np.arange(len(temperature)), np.diff(network.indptr))
    flow = network.conductance * (temperature[network.indices] - temperature[rows])
    received = np.bincount(rows, flow, minlength=len(temperature))
    for name, value in scene.wall_temperatures.items():
        here = network.wall_side == WALLS.index(name)
        particle = network.wall_particle[here]
        received[particle] += network.wall_conductance[here] * (value - temperature[particle])
    for name, value in scene.wall_fluxes.items():
        here = network.wall_side == WALLS.index(name)
        received[network.wall_particle[here]] += value * network.wall_area[here]
    return received


def _off(ours, theirs, scale=None):
    """Largest difference over a scale, by default the largest value; NaN if any is missing."""
    return float(abs(referee.value_error(ours, theirs, scale=scale or abs(theirs).max())).max())


def crystal_row(cells, crystal):
    """Steady conductivity and heat capacity of a periodic crystal; arguments as those of `spheres`."""
    packing = spheres(cells, crystal, periodic=True)
    number, _ = crystal_packing(CRYSTALS[crystal])
    scene = Scene(tuple(packing.size), MATRIX, gradient=(0.0, 1.0, 0.0))
    field = solve(scene, law="platonic", packing=packing, coordination=number, tolerance=1e-13, allow_few=True)
    n = np.array([number])
    formula = float(number * surface_factors(n)[0] * fraction_factors(n)[0] / (4 * math.pi))
    row = {"particles": packing.number, "neighbours": number, "conductivity": field.conductivity / MATRIX.conductivity}
    row |= {"formula": formula, "capacity_ratio": float(field.samples.volumes.sum() / packing.volume)}
    return row | {name: field.stats[name] for name in ("unknowns", "iterations", "residual")}
