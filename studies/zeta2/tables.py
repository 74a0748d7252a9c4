"""The table of the study of zeta_2: a line for each array and each kind of random cell."""

from studies.harness.pick import pick
from studies.zeta2.means import KEYS, pooled, with_bounds


def lines(df):
    """Lines of the table: arrays on their finest grid, then random cells."""
    arrays = [group for _, group in pick(df, part="array").groupby(["array", "fraction"], sort=False)]
    return [*map(_array_line, arrays), *(_cell_line(df, mean) for _, mean in pooled(df).iterrows())]


SOLVED = {"k": "conductivity", "lower": "lower", "upper": "upper", "Torquato": "torquato"}
SOLVED |= {"with polynomial": "torquato_polynomial"}
NOTHING = {"grid": "", "voxels": float("nan"), "raw": float("nan")}


def _array_line(group):
    last = group.loc[group["voxels"].idxmax()]
    line = {"structure": last["array"].upper(), "gap": "", "L/D": "", "f": last["fraction"], "cells": ""}
    line |= {"zeta_2": f"{last['exact']:.6f}", "+-": "", "scatter": float("nan"), "polynomial": ""}
    return line | {"off, %": float("nan")} | _errors(last) | {"surface": ""} | dict.fromkeys(SOLVED, "")


def _errors(row):
    return {"grid": f"{row['voxels']:.0f}^3", "voxels": row["error_percent"], "raw": row["raw_percent"]}


def _cell_line(df, mean):
    here = {key: mean[key] for key in KEYS}
    voxels, surface = pick(df, part="voxels", **here), pick(df, part="surface", **here)
    solved = pick(with_bounds(df), **here)
    line = {"structure": mean["placed"].upper(), "gap": f"{mean['gap']:g} D", "L/D": f"{mean['ratio']:g}"}
    line |= {"f": mean["fraction"], "cells": str(mean["cells"]), "zeta_2": f"{mean['zeta2']:.5f}"}
    line |= {"+-": f"{mean['half']:.5f}", "scatter": 100 * mean["scatter"] / mean["zeta2"]}
    line |= {"polynomial": f"{mean['polynomial']:.5f}", "off, %": mean["off_percent"]}
    line |= _errors(voxels.loc[voxels["voxels"].idxmax()]) if len(voxels) else NOTHING
    line["surface"] = "".join(f"{row.error_percent:+.2f} +- {row.error_se:.2f}" for row in surface.itertuples())
    return line | {title: f"{solved[name].iloc[0]:.4f}" if len(solved) else "" for title, name in SOLVED.items()}
