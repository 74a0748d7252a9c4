"""What a row keeps of the fluxes of particles, by the halo's radius: written from fields, read from tables."""

import numpy as np

from demheat import referee
from studies.harness.cells import cell, numbers
from studies.harness.printed import printed

COSTED = 11.0  # mean radii of the halo whose cost is a row's
TOUCHING = 2.0  # mean radii from a wall within which particles may touch it
# Halo radii in mean radii; 0 is no halo.
RATIOS = (0.0, 1.5, 2.0, 3.0, 4.0, 5.5, 7.0, 9.0, 11.0, 13.0, 15.0)
STATISTICS = ("number", "cov", "cov_volume", "least", "mean", "most")
# Halo radii whose density functions are kept, and their range in units of the flux, in equal bins.
DENSITIES = {0.0: (0.0, 3.0), 2.0: (0.0, 3.0), 4.0: (0.6, 1.4), 11.0: (0.8, 1.2)}
BINS = 80
# Depths below the walls with a temperature, in mean radii, between which the mean flux there is kept; of these halos.
DEPTHS, SHOWN = np.arange(17.0), (0.0, 4.0, 11.0)
# How a scatter may be counted: over which particles, and by what; and the column of each.
WEIGHTINGS = {
    ("all", "number"): "cov",
    ("all", "volume"): "cov_volume",
    ("bulk", "number"): "bulk_cov",
    ("bulk", "volume"): "bulk_cov_volume",
}
PAPER = printed("fig10_halo")


def by_radius(field, fluxes):
    """Cells of each statistic over all particles and over the bulk, and of histograms."""
    points, volumes, length = field.samples.points, field.samples.volumes, field.scene.size[0]
    radius = field.stats["mean_radius"]
    depth = np.inf if field.scene.periodic else np.minimum(points, length - points).min(axis=1)
    row = {f"{part}{name}": [] for part in ("", "bulk_") for name in STATISTICS}
    for ratio in RATIOS:
        for part, least in (("", -1.0), ("bulk_", max(ratio, TOUCHING) * radius)):
            inside = np.broadcast_to(depth > least, len(points))
            # In a bulk narrower than a halo all means are of nearly the same particles.
            known = ratio in fluxes and (part == "" or field.scene.periodic or 2 * (least + ratio * radius) <= length)
            y = -fluxes[ratio][inside, 1] / PAPER["flux"] if known else np.empty(0)
            for name, value in zip(STATISTICS, _of(y, volumes[inside]), strict=True):
                row[part + name].append(value)
            if ratio in DENSITIES and len(y) and field.stats["law"] == "calibrated":
                row[f"{part}density_{ratio:g}"] = np.histogram(y, BINS, DENSITIES[ratio])[0] / len(y)
    return {name: cell(values, ".12g") for name, values in row.items()}


def near_wall(field, fluxes):
    """Mean flux by the depth below the two walls with a temperature, in halos, as cells `near_RATIO`."""
    points, volumes, length = field.samples.points, field.samples.volumes, field.scene.size[0]
    away = np.minimum(points, length - points) / field.stats["mean_radius"]
    row = {}
    for ratio in SHOWN:
        if ratio not in fluxes:
            continue
        inside = np.minimum(away[:, 0], away[:, 2]) > max(ratio, TOUCHING)
        depth, part = away[inside, 1], volumes[inside]
        sums, weights = (
            np.histogram(depth, DEPTHS, weights=part * y)[0]
            for y in (-fluxes[ratio][inside, 1] / PAPER["flux"], np.ones(len(part)))
        )
        row[f"near_{ratio:g}"] = cell(np.divide(sums, weights, out=np.full(len(sums), np.nan), where=weights > 0))
    return row


def _of(y, volumes):
    """Number of particles, CoV by number and by volume in per cent, smallest, mean by volume and largest."""
    if len(y) < 2:
        return (len(y), *[np.nan] * 5)
    cov, cov_volume = (100 * referee.variation(y, weights) for weights in (None, volumes))
    return len(y), cov, cov_volume, y.min(), np.average(y, weights=volumes), y.max()


def long(df):
    """One row per halo radius."""
    import pandas as pd

    rows = []
    for row in df[df["status"] == "ok"].to_dict("records"):
        lists = [numbers(row[f"{part}{name}"]) for part in ("", "bulk_") for name in STATISTICS]
        names = [f"{part}{name}" for part in ("", "bulk_") for name in STATISTICS]
        case = {name: row[name] for name in ("law", "split", "walls", "particles", "seed")}
        rows += [case | {"ratio": r} | dict(zip(names, v, strict=True)) for r, *v in zip(RATIOS, *lists, strict=True)]
    return pd.DataFrame(rows)
