"""Flux of particles in a homogeneous block: how far it scatters, and how wide a halo must be.

Haddad et al. (Int. J. Thermal Sciences 164, 2021, 106799), figures 10 to 12, eqs. 20, 22 and 23: a cube of 0.1 m of
33 W/(m K) between 25 C at y = 0 and 35 C at y = L, so that the flux is 3300 W/m2 everywhere. "calibrated" is the
paper's network of contacts, 7.5 links on average in the bulk; its particle fluxes take one half of each link as printed
("half"), or the part R_p / (R_p + R_q) that belongs to the particle ("radii"). "laguerre" has facets of the radical
tessellation and needs no halo. Fluxes are components along the load, in units of 3300 W/m2; halo radii are in mean
radii, 0 being the particle's own flux; halos end at walls. The coefficient of variation (CoV) is the standard deviation
over the mean, by number of particles or by volume; over all particles, or over the bulk, which is farther from every
wall than the halo's radius (and 2 mean radii, where particles touch the wall) and counts if it is as wide as a halo.
"periodic" is a cell without walls. Costs are those of the halos of 11 radii; for "laguerre", of its fluxes.
"""

import numpy as np

from demheat import referee
from studies.fig10_halo.figure import BINS, DENSITIES, PAPER, RATIOS, SEEDS, STATISTICS, long, plot
from studies.harness.cells import cell
from studies.harness.pick import pick, present

__all__ = ["CASES", "PAPER", "QUICK", "claims", "plot", "run", "table", "warm_up"]

SPLITS = ("half", "radii")
COSTED, TOUCHING = 11.0, 2.0
LENGTH, CONDUCTIVITY, COLD, HOT = 0.1, 33.0, 25.0, 35.0
TIMEOUT = 3600.0


def _case(law, split, walls, particles, seed):
    return {"law": law, "split": split, "walls": walls, "particles": particles, "seed": seed, "method": "dem"}


CASES = [
    _case(law, split, walls, number, seed)
    for law, split, walls in (
        *(("calibrated", split, "held") for split in SPLITS),
        ("calibrated", "half", "periodic"),
        ("laguerre", None, "held"),
    )
    for number, seeds in SEEDS.items()
    for seed in seeds
    # The bulk of a cell is all of it: a fifth of the particles is as good.
    if walls == "held" or number <= 100_000
]


def QUICK(case):
    """The smallest packing of each kind."""
    return case["particles"] == min(SEEDS)


def run(law, split, walls, particles, seed, method):
    """Statistics of the flux by halo radius, each a list in one cell, and density functions."""
    from demheat.sampling.halo import halo_flux
    from studies.harness.cost import measured

    packing = _packing(walls, particles, seed)
    if law == "laguerre":
        field, row = _laguerre(packing)
        _, cost = measured(lambda: field.samples)
        return row | _statistics(field, {0.0: field.samples.flux}) | cost
    field, row = _calibrated(packing, walls, split)
    # Halos no wider than the periodic cell.
    most = LENGTH / 2 if walls == "periodic" else LENGTH
    fluxes, cost = {0.0: field.samples.flux}, {}
    for ratio in RATIOS[1:]:
        if ratio * field.stats["mean_radius"] <= most:
            fluxes[ratio], spent = measured(halo_flux, field, ratio=ratio)
            cost = spent if ratio == COSTED else cost
    return row | _statistics(field, fluxes) | cost


def _scene(walls):
    from demheat.scene import Material, Scene

    gradient = (0.0, (HOT - COLD) / LENGTH, 0.0)
    load = {"gradient": gradient} if walls == "periodic" else {"walls": {"y-": COLD, "y+": HOT}}
    return Scene(size=(LENGTH,) * 3, matrix=Material(CONDUCTIVITY), **load)


def _packing(walls, particles, seed):
    from demheat.packing.cache import relaxed

    return relaxed(particles, size=(LENGTH,) * 3, periodic=walls == "periodic", seed=seed)


def _laguerre(packing):
    from demheat.dem import solve

    field = solve(_scene("held"), packing=packing)
    return field, {name: field.stats[name] for name in ("unknowns", "iterations", "residual")}


def _calibrated(packing, walls, split):
    """Field of the paper's network, with the flux of each particle by one of the two splits."""
    from dataclasses import replace

    from demheat.build import network_of
    from demheat.conduction.steady import solve_steady
    from demheat.field import Samples
    from demheat.laws import Calibrated
    from demheat.sampling.field_of import field_of
    from demheat.sampling.particle_flux import particle_flux

    scene = _scene(walls)
    network = network_of(scene, packing, Calibrated())
    solution = solve_steady(network, scene)
    field = field_of(scene, network, solution, stats={})
    flux = particle_flux(network, solution, split=split)
    samples = Samples(network.centers, network.volumes, solution.fluctuation, network.phase, flux)
    row = {"ct": network.stats["calibration"]} | {
        name: field.stats[name] for name in ("unknowns", "iterations", "residual")
    }
    return replace(field, sampler=lambda: samples), row


def _statistics(field, fluxes):
    """Lists of each statistic over all particles and over the bulk, and histograms."""
    points, volumes = field.samples.points, field.samples.volumes
    radius = field.stats["mean_radius"]
    depth = np.inf if field.scene.periodic else np.minimum(points, LENGTH - points).min(axis=1)
    row = {f"{part}{name}": [] for part in ("", "bulk_") for name in STATISTICS}
    for ratio in RATIOS:
        for part, least in (("", -1.0), ("bulk_", max(ratio, TOUCHING) * radius)):
            inside = np.broadcast_to(depth > least, len(points))
            # In a bulk narrower than a halo all means are of nearly the same particles.
            known = ratio in fluxes and (part == "" or field.scene.periodic or 2 * (least + ratio * radius) <= LENGTH)
            y = -fluxes[ratio][inside, 1] / PAPER["flux"] if known else np.empty(0)
            for name, value in zip(STATISTICS, _of(y, volumes[inside]), strict=True):
                row[part + name].append(value)
            if ratio in DENSITIES and len(y) and field.stats["law"] == "calibrated":
                row[f"{part}density_{ratio:g}"] = np.histogram(y, BINS, DENSITIES[ratio])[0] / len(y)
    return {name: cell(values, ".12g") for name, values in row.items()}


def _of(y, volumes):
    """Number of particles, CoV by number and by volume in per cent, smallest, mean by volume and largest."""
    if len(y) < 2:
        return (len(y), *[np.nan] * 5)
    cov, cov_volume = (100 * referee.variation(y, weights) for weights in (None, volumes))
    return len(y), cov, cov_volume, y.min(), np.average(y, weights=volumes), y.max()


def warm_up(law, split, walls, particles, seed, method):
    """Load and compile; make and keep the packing, which is not part of what is compared."""
    _packing(walls, particles, seed)
    run(law, split, walls, 500, 99, method)


def claims(df):
    """No scatter with Laguerre's facets; the paper's 27, 5 and 2 % with its network; splits, sizes and costs."""
    rows = long(df)
    yield from present([*_exact(rows), *_paper(rows), *_splits(rows), *_size(rows), *_cost(df)])


def _exact(rows):
    own = pick(rows, law="laguerre", ratio=0.0)
    yield "Laguerre, no halo: largest CoV of any packing, %", own[["cov", "cov_volume"]].max().max(), 1e-6
    text = "Laguerre, no halo: any particle's flux off 3300 W/m2, relative"
    most, least = (referee.value_error(value, 1.0) for value in (own["most"].max(), own["least"].min()))
    yield text, max(most, -least), 1e-8


def _means(rows, column, **where):
    """Means over packings by number of particles, without numbers that have no bulk there."""
    return pick(rows, **where).groupby("particles")[column].mean().dropna()


def _factor(values, printed_value):
    """Largest factor between some values and a printed one."""
    values = values.to_numpy()
    return max((values / printed_value).max(), (printed_value / values).max()) if len(values) else None


def _paper(rows):
    """The printed 27, 5 and 2 %."""
    walled = {"law": "calibrated", "split": "half", "walls": "held"}
    raw = _means(rows, "bulk_cov_volume", ratio=0.0, **walled)
    # By volume; by number, where small particles with large neighbours count as much, it is twice as large.
    text = "Contacts, printed weights, bulk: CoV by volume (by number it is twice that) off the paper's 27 %, factor"
    yield text, _factor(raw, PAPER["cov_0"]), 1.25
    halo = _means(rows, "bulk_cov", ratio=4.0, **walled)
    text = "Halo of 4, bulk: CoV off the paper's 5 %, factor"
    yield text, _factor(halo, PAPER["cov_4"]), 1.2
    wide = _means(rows, "cov", ratio=11.0, **walled)
    yield "Halo of 11, all particles: least CoV of any number of particles, %, above 2", wide.min(), "> 2"
    wide = _means(rows, "bulk_cov", ratio=11.0, **walled)
    text = "Halo of 11, bulk: largest CoV of any number of particles, %, below 2"
    yield text, wide.max() if len(wide) else None, "< 2"


def _splits(rows):
    held = {"law": "calibrated", "walls": "held"}
    half, radii = (_means(rows, "bulk_cov", ratio=0.0, split=split, **held) for split in SPLITS)
    yield "Own part of each link instead of one half: CoV by number, bulk, over that", (radii / half).max(), 0.7
    half, radii = (_means(rows, "bulk_cov", ratio=4.0, split=split, **held) for split in SPLITS)
    yield "The same in halos of 4: relative change of the CoV", abs(referee.value_error(radii, half)).max(), 0.03
    # The first moment of heat flows gives C_t its value: the solver's tolerance.
    means = pick(rows, walls="periodic", ratio=0.0)
    off = abs(referee.value_error(means["mean"], 1.0)).max()
    yield "Periodic cell: mean flux off 3300 W/m2, relative", off, 1e-6


def _size(rows):
    held = {"law": "calibrated", "split": "half", "walls": "held"}
    for ratio, column, least, limit in (
        (0.0, "bulk_cov_volume", 10_000, 1.1),
        (4.0, "bulk_cov", 10_000, 1.1),
        # Some 70 halos of 11 fit side by side into the bulk of 1e5: a standard error of 1 / sqrt(2 70) = 8 %.
        (11.0, "bulk_cov", 100_000, 1.25),
    ):
        means = _means(rows, column, ratio=ratio, **held)
        means = means[means.index >= least]
        value = means.max() / means.min() if len(means) > 1 else None
        yield f"Halo of {ratio:g}, bulk, {least} particles and more: largest CoV over smallest", value, limit
    wide = _means(rows, "cov", ratio=11.0, **held)
    small, large = wide.get(10_000), wide.get(500_000)
    value = None if small is None or large is None else small / large
    yield "Halo of 11, all particles: CoV at 1e4 over that at 5e5 (walls, whose share falls)", value, ">= 1.2"


def _cost(df):
    full = pick(df, law="calibrated", particles=max(SEEDS))
    known = len(full) > 0
    yield "Halo of 11 of 5e5 particles: CPU-s", full["cpu_s"].max() if known else None, 5.0
    # A stored list of neighbours would take 4 bytes for each of 700: 2800.
    bytes_each = 2**20 * full["peak_mib"].max() / max(SEEDS) if known else None
    yield "Halo of 11 of 5e5 particles: peak memory, bytes per particle", bytes_each, 600.0


def table(df):
    """CoV in per cent by number of particles (by volume without halo), means over packings; fluxes over 3300 W/m2.

    `cov_volume_0` and `cov_0` are without halo; least and most are over all particles at halos of 11 (without halo for
    Laguerre); CPU seconds are those of all halos of radius 11, on however many threads.
    """
    import pandas as pd

    shown = []
    key = ["law", "split", "walls", "particles"]
    for names, rows in long(df).fillna({"split": ""}).groupby(key, sort=False):
        means = rows.groupby("ratio")[["cov_volume", "cov", "bulk_cov_volume", "bulk_cov"]].mean()
        row = dict(zip(key, names, strict=True))
        row |= {f"{name}_0": means.loc[0.0, name] for name in ("cov_volume", "cov", "bulk_cov_volume", "bulk_cov")}
        row |= {f"{part}_{ratio:g}": means.loc[ratio, part] for ratio in (4.0, 11.0) for part in ("cov", "bulk_cov")}
        last = rows[rows["ratio"] == (0.0 if row["law"] == "laguerre" else COSTED)]
        row |= {"least": last["least"].min(), "most": last["most"].max()}
        same = pick(df, law=row["law"], split=row["split"] or None, walls=row["walls"], particles=row["particles"])
        shown.append(row | {"cpu_s": same["cpu_s"].mean(), "peak_mib": same["peak_mib"].mean()})
    paper = {"law": "paper", "split": "half", "walls": "held"}
    shown.append(paper | {"cov_0": PAPER["cov_0"], "cov_4": PAPER["cov_4"], "cov_11": PAPER["cov_11"]})
    return pd.DataFrame(shown).fillna({"split": "", "walls": ""})
