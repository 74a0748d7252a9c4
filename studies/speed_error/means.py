"""Figures read off the rows: points of error against cost, the cheapest way to a target, and where the DEM loses."""

from __future__ import annotations

import numpy as np

from studies.harness import methods
from studies.harness.methods import EDGE, resolution
from studies.harness.pick import with_size
from studies.speed_error.cases import LENGTHS
from studies.speed_error.scenes import IN_TIME, STEADY

TARGETS = (1.0, 0.1, 0.01)  # per cent
# What is compared: its column, and the targets that are asked of it. Fluxes at points are first order at best.
QUANTITIES = {"conductivity": "error_percent", "temperature": "temperature_rms", "flux": "flux_rms"}
COSTS = ("unknowns", "cpu_s", "wall_s", "peak_mib", "cached_cpu_s")
COLUMNS = ("scene", "quantity", "target", "name", "resolution", "error", *COSTS)


def points(df, quantity="conductivity"):
    """One point per method, scene and resolution: largest |error| of its packings, %, mean costs."""
    import pandas as pd

    rows, column = [], QUANTITIES[quantity]
    solves = df[df["scene"].notna() & (df["status"] == "ok")]
    if "tolerance" in solves:
        solves = solves[solves["tolerance"].isna()]
    if column not in solves:
        return pd.DataFrame(columns=["scene", "name", "error", *COSTS, "resolution"])
    solves = solves[solves[column].notna()]
    for (scene, name, _), group in with_size(solves).groupby(["scene", "name", "h"], dropna=False, sort=False):
        row = {"scene": scene, "name": name, "error": group[column].abs().max()}
        row |= {key: group[key].mean() if key in group else np.nan for key in COSTS}
        # Asking at the points costs too.
        row["cpu_s"] += 0.0 if quantity == "conductivity" else group["points_cpu_s"].mean()
        rows.append(row | {"resolution": words(group.iloc[0])})
    return pd.DataFrame(rows, columns=["scene", "name", "error", *COSTS, "resolution"])


def words(row):
    """Resolution of a row in words, sizes in lengths of its scene."""
    length = LENGTHS.get(row["scene"], EDGE)
    return resolution({**row, "size": row["size"] * EDGE / length} if "size" in row else row)


def cheapest(df, quantity="conductivity", targets=TARGETS):
    """For each scene, target and method the cheapest resolution from which on all are within it."""
    import pandas as pd

    found = []
    for (scene, _), group in points(df, quantity).groupby(["scene", "name"], sort=False):
        group = group.sort_values("unknowns")
        # An error may cross zero by luck: only a resolution after which all stay good counts.
        lasting = group["error"][::-1].cummax()[::-1]
        for target in targets:
            good = group[lasting <= target]
            if len(good):
                best = good.loc[good["cpu_s"].idxmin()]
                found.append({"quantity": _said(scene, quantity), "target": target, **best})
    frame = pd.DataFrame(found, columns=list(COLUMNS))
    place = {name: number for number, name in enumerate((*STEADY, *IN_TIME))}
    order = pd.DataFrame({"place": frame["scene"].map(place), "target": -frame["target"], "cpu_s": frame["cpu_s"]})
    return frame.loc[order.sort_values(["place", "target", "cpu_s"]).index]


def _said(scene, quantity):
    return "temperature" if scene in IN_TIME else quantity


def winners(df, quantity="conductivity", targets=TARGETS):
    """The cheapest method of each scene and target, and what the DEM costs beside it."""
    every = cheapest(df, quantity, targets)
    first = every.groupby(["scene", "target"], sort=False).head(1)
    dem = every[every["name"] == "dem"].set_index(["scene", "target"])
    keys = list(zip(first["scene"], first["target"], strict=True))
    own = [dem.loc[key] if key in dem.index else None for key in keys]
    return first.assign(
        dem=[np.nan if row is None else row["cpu_s"] for row in own] / first["cpu_s"],
        dem_cached=[np.nan if row is None else row["cached_cpu_s"] for row in own] / first["cpu_s"],
    )


def without_multipoles(df):
    """Rows of the methods that know any shape."""
    return df[df["name"] != "multipole"]


def lost(df, target):
    """Cost of the DEM over that of the cheapest method of any shape; infinite where only others get there."""
    best = winners(without_multipoles(df), targets=(target,))
    return {row["scene"]: np.inf if np.isnan(row["dem"]) else row["dem"] for _, row in best.iterrows()}


def in_words(df, target):
    """Where the DEM loses, as a sentence."""
    ratios = lost(df, target)
    wins = [scene for scene, ratio in ratios.items() if ratio == 1.0]
    never = [scene for scene, ratio in ratios.items() if np.isinf(ratio)]
    some = {scene: ratio for scene, ratio in ratios.items() if scene not in (*wins, *never)}
    parts = [f"cheapest on {_list(wins)}"] if wins else ["cheapest nowhere"]
    if some:
        dearest = max(some, key=some.get)
        middle = float(np.median(list(some.values())))
        parts.append(f"{middle:.2g} times as dear as the cheapest (median), {some[dearest]:.2g} times on {dearest}")
    if never:
        parts.append(f"not there with the resolutions tried on {_list(never)}")
    return f"For {target:g} % the DEM is " + "; ".join(parts) + "."


def counts_in_words(df, target):
    """On how many scenes each method for any shape is the cheapest, and where the DEM does not get there."""
    best = winners(without_multipoles(df), targets=(target,))
    scenes = [scene for scene in (*STEADY, *IN_TIME) if (df["scene"] == scene).any()]
    parts = [f"{label(name)} on {count}" for name, count in best["name"].value_counts().items()]
    none = [scene for scene in scenes if not (best["scene"] == scene).any()]
    never = [scene for scene, ratio in lost(df, target).items() if np.isinf(ratio)]
    said = f"of {len(scenes)} scenes {target:g} % costs least by {', by '.join(parts)}"
    said += f"; none of them gets there with the resolutions tried on {_list(none)}" if none else ""
    return said + (f"; the DEM alone does not on {_list(never)}" if never else "")


def losses_in_words(df):
    """On how many scenes the DEM is not the cheapest method for any shape, by target."""
    parts = []
    for target in TARGETS:
        ratios = lost(df, target).values()
        parts.append(f"on {sum(ratio > 1 for ratio in ratios)} of {len(ratios)} scenes to {target:g} %")
    return ", ".join(parts)


def packing_in_words(df):
    """CPU time of the DEM's largest packing of one sphere, made on the spot."""
    rows = df[(df["scene"] == "third") & (df["name"] == "dem")]
    row = rows.loc[rows["particles"].idxmax()]
    made, solve = row["cpu_s"] - row["cached_cpu_s"], row["cached_cpu_s"]
    return f"{made:.2g} CPU-seconds, {made / solve:.2g} times the solve"


def _list(names):
    return ", ".join(names)


def label(name):
    """Title of a method."""
    return methods.found()[name].title
