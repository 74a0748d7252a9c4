"""The Platonic law on crystals: on simple cubic it is the 7-point finite-difference stencil, on the others it is not.

Terreros, Iordanoff, Charles, Comput. Mater. Sci. 69 (2013) 46, section 3: on a simple cubic crystal of touching spheres
each has six neighbours (walls count), surfaces (2 R)^2 and a volume (2 R)^3. The network, made as for any packing, is
compared with finite differences on a grid, written apart: conductances, capacities, one explicit step from a rough
field and a steady solution, homogeneous and with a sphere ten times as conducting. On the other crystals from which the
law takes its packing fractions, the polyhedra do not fill space: conductivity over that of the material is the volume
of the polyhedron over that of the cell, n s(n) f(n) / (4 pi).
"""

import math

import numpy as np

from demheat import Flux, Material, Scene, Sphere, referee
from demheat.scene import WALLS
from studies.harness.figures import BLUE, GREY, ORANGE
from studies.harness.pick import pick

# Edge of a cell, and materials with the density and the heat capacity of aluminium (Terreros et al. 2013).
EDGE, MATRIX, SPHERE = 2e-3, Material(134.0, 2790.0, 880.0), Material(1340.0, 2000.0, 500.0)
LOADS = {
    "two walls": {"x-": 298.0, "x+": 798.0},
    "corner": {"x-": 298.0, "y+": 798.0, "z-": Flux(2e5)},
}
QUANTITIES = ("conductance", "wall_conductance", "capacity", "step", "steady")
NAMES = ("conductances of links", "conductances to walls", "heat capacities", "one explicit step", "steady solution")
CRYSTALS = ("diamond", "simple cubic", "body-centred cubic", "face-centred cubic")
METHOD, SPAN = "dem", 500.0


def _cases():
    for cells in ((10, 11, 12), (20, 21, 22)):
        for walls in LOADS:
            for sphere in (False, True):
                size = "x".join(map(str, cells))
                yield {"part": "stencil", "cells": size, "walls": walls, "sphere": sphere, "method": METHOD}
    for crystal in CRYSTALS:
        yield from (
            {"part": "other", "cells": cells, "crystal": crystal, "method": METHOD} for cells in ("3x3x3", "6x6x6")
        )


CASES = list(_cases())
PAPER = {}


def QUICK(case):
    """The small ones."""
    return case["cells"] in ("10x11x12", "3x3x3")


def run(part, cells, method, **case):
    """Compare one crystal."""
    cells = tuple(map(int, cells.split("x")))
    return _compared(cells, **case) if part == "stencil" else _conducting(cells, **case)


def spheres(cells, crystal="simple cubic", *, periodic):
    """Touching spheres of a crystal in a box of so many cubic cells, as a Packing."""
    from demheat.network.platonic import CRYSTALS
    from demheat.packing.base import make_packing

    sites = np.array(CRYSTALS[crystal], dtype=float)
    corners = np.stack(np.meshgrid(*map(np.arange, cells), indexing="ij"), axis=-1).reshape(-1, 1, 3)
    centers = (corners + sites + (0.0 if periodic else 0.5)).reshape(-1, 3) * EDGE
    nearest = np.linalg.norm(sites[1:], axis=1).min() if len(sites) > 1 else 1.0
    radii = np.full(len(centers), 0.5 * nearest * EDGE)
    return make_packing(centers, radii, np.array(cells) * EDGE, periodic, {"algorithm": "crystal"})


def _compared(cells, walls, sphere):
    """Largest differences between network and grid, relative to the largest value or the span of temperature."""
    from demheat import solve
    from studies.crystal import stencil

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
    from studies.crystal.stencil import Grid

    centers = (np.stack(np.meshgrid(*map(np.arange, cells), indexing="ij"), axis=-1) + 0.5) * EDGE
    k, heat = np.full(cells, MATRIX.conductivity), np.full(cells, MATRIX.density * MATRIX.heat_capacity)
    if scene.inclusions:
        inside = np.linalg.norm(centers - np.array(cells) * EDGE / 2, axis=-1) < scene.inclusions[0].radius
        k[inside], heat[inside] = SPHERE.conductivity, SPHERE.density * SPHERE.heat_capacity
    return Grid(EDGE, k, heat * EDGE**3, scene.wall_temperatures, scene.wall_fluxes)


def _network(scene, packing):
    """The Platonic network of the crystal, as `solve` makes it, and its heat capacities."""
    from demheat.build import network_of
    from demheat.conduction.transient import capacities
    from demheat.laws import Platonic

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


def _conducting(cells, crystal):
    """Steady conductivity and heat capacity of a periodic crystal."""
    from demheat import solve
    from demheat.network.platonic import CRYSTALS, crystal_packing, fraction_factors, surface_factors

    packing = spheres(cells, crystal, periodic=True)
    number, _ = crystal_packing(CRYSTALS[crystal])
    scene = Scene(tuple(packing.size), MATRIX, gradient=(0.0, 1.0, 0.0))
    field = solve(scene, law="platonic", packing=packing, coordination=number, tolerance=1e-13, allow_few=True)
    n = np.array([number])
    formula = float(number * surface_factors(n)[0] * fraction_factors(n)[0] / (4 * math.pi))
    row = {"particles": packing.number, "neighbours": number, "conductivity": field.conductivity / MATRIX.conductivity}
    row |= {"formula": formula, "capacity_ratio": float(field.samples.volumes.sum() / packing.volume)}
    return row | {name: field.stats[name] for name in ("unknowns", "iterations", "residual")}


def warm_up(**case):
    """Load the solver."""
    run(**case | {"cells": "10x10x10" if case["part"] == "stencil" else "3x3x3"})


def claims(df):
    """Section 3 of the paper holds to rounding; beyond simple cubic it says nothing."""
    grids, others = pick(df, part="stencil"), pick(df, part="other")
    for quantity, name in zip(QUANTITIES, NAMES, strict=True):
        # The steady solution is iterated to 1e-14 of the heat; errors of temperature are larger by the number of cells.
        limit = 1e-11 if quantity == "steady" else 1e-13
        text = f"Simple cubic crystal, network against finite differences: {name}, largest relative difference"
        yield text, grids[quantity].max(skipna=False), limit
    off = referee.value_error(others["conductivity"], others["formula"]).abs().max(skipna=False)
    yield "Crystals: conductivity off polyhedron over cell, n s f / (4 pi), relative", off, 1e-11
    off = referee.value_error(others["capacity_ratio"], 1.0).abs().max(skipna=False)
    yield "Crystals: heat capacity off that of the body, relative", off, 1e-12
    wrong = others[others["crystal"] != "simple cubic"]
    least = referee.value_error(wrong["conductivity"], 1.0).abs().min()
    yield "Crystals other than simple cubic: least error of the conductivity", least, ">= 0.01"


def table(df):
    """Largest relative differences between the Platonic network and finite differences; conductivities of crystals.

    Differences of conductances and capacities are relative to the largest, those of temperatures to the span of 500 K.
    Conductivity and capacity of crystals are relative to those of the material.
    """
    columns = ["cells", "walls", "sphere", *QUANTITIES, "crystal", "neighbours", "conductivity", "capacity_ratio"]
    shown = df[columns].copy()
    shown["sphere"] = shown["sphere"].map({True: "yes", False: "no", "True": "yes", "False": "no"})
    words = ["walls", "sphere", "crystal"]
    return shown.astype({name: object for name in words}).fillna({name: "" for name in words})


def plot(df):
    """Differences to the grid by quantity; conductivity of the crystals."""
    from matplotlib import pyplot

    figure, (left, right) = pyplot.subplots(1, 2, figsize=(12, 4.6), width_ratios=(1.3, 1))
    grids, others = pick(df, part="stencil"), pick(df, part="other")
    floor = 2e-17
    for number, quantity in enumerate(QUANTITIES):
        values = grids[quantity].clip(lower=floor)
        left.plot(values, np.full(len(values), number), "o", color=BLUE, alpha=0.7)
    left.axvline(np.finfo(float).eps, color=GREY, linewidth=1)
    left.annotate(" rounding of one number", (np.finfo(float).eps, len(NAMES) - 0.6), fontsize=8, color=GREY)
    left.set(
        xscale="log", yticks=range(len(NAMES)), yticklabels=NAMES, xlim=(1e-17, 1e-8), ylim=(-0.5, len(NAMES) - 0.3)
    )
    left.set(xlabel=f"largest relative difference to finite differences (0 drawn at {floor:g})")
    left.set_title("Simple cubic: the Platonic network is the 7-point stencil")
    one = others.drop_duplicates("crystal")
    right.bar(
        one["crystal"], one["conductivity"], color=[BLUE if c == "simple cubic" else ORANGE for c in one["crystal"]]
    )
    for place, (value, n) in enumerate(zip(one["conductivity"], one["neighbours"], strict=True)):
        text = f"{value:.4f}\n{n:.0f} neighbours"
        right.annotate(text, (place, max(value, 1.0)), ha="center", va="bottom", fontsize=9)
    right.axhline(1.0, color=GREY, linewidth=1)
    right.set(ylabel="conductivity of the network over the material's", ylim=(0, 1.35))
    right.set_axisbelow(True)
    right.tick_params(axis="x", rotation=15)
    right.set_title("Other crystals: its polyhedra do not fill space")
    return figure
