"""Figures read off the rows: points of error against cost, the cheapest way to a target, and where the DEM loses."""

from __future__ import annotations

import numpy as np

from studies.harness import methods
from studies.harness.methods import EDGE, resolution
from studies.harness.pick import with_size
from studies.speed_error.cases import LENGTHS
from studies.speed_error.scenes import IN_TIME, ROUND, STEADY, TUNED

TARGETS = (1.0, 0.1, 0.01)  # per cent
# Costs nearer to each other than this factor are a tie: of solves that were run twice nine in ten are (a claim).
TIE = 1.5
# What is compared: its column, and the targets that are asked of it. Fluxes at points are first order at best.
QUANTITIES = {"conductivity": "error_percent", "temperature": "temperature_rms", "flux": "flux_rms"}
COSTS = ("unknowns", "cpu_s", "wall_s", "peak_mib", "cached_cpu_s")
COLUMNS = ("scene", "quantity", "target", "name", "resolution", "error", *COSTS, "at_target_s")


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
    """For each scene, target and method the cheapest resolution from which on all are within it.

    `at_target_s` is what the target itself would cost: between that resolution and the next coarser one, which misses
    it, by a power law; else ladders of few resolutions would decide who wins.
    """
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
                missed = group.assign(error=lasting)[lasting > target].tail(1)
                cost = {"at_target_s": _between(missed, best, target)}
                found.append({"quantity": _said(scene, quantity), "target": target, **best, **cost})
    frame = pd.DataFrame(found, columns=list(COLUMNS))
    place = {name: number for number, name in enumerate((*STEADY, *IN_TIME))}
    order = pd.DataFrame({"place": frame["scene"].map(place), "target": -frame["target"], "s": frame["at_target_s"]})
    return frame.loc[order.sort_values(["place", "target", "s"]).index]


def _between(missed, best, target):
    """CPU seconds at the target, between a resolution that misses it and one that does not; those of this, if none."""
    if missed.empty or missed["cpu_s"].iloc[0] >= best["cpu_s"]:
        return best["cpu_s"]
    error, cost = missed["error"].iloc[0], missed["cpu_s"].iloc[0]
    # Of errors that are rounding a thousandth of the target is as good.
    share = np.log(error / target) / np.log(error / max(best["error"], 1e-3 * target))
    return cost * (best["cpu_s"] / cost) ** share


def _said(scene, quantity):
    return "temperature" if scene in IN_TIME else quantity


def winners(df, quantity="conductivity", targets=TARGETS):
    """The cheapest method of each scene and target, those that tie with it, the next, and what next and DEM cost."""
    import pandas as pd

    rows = []
    for _, group in cheapest(df, quantity, targets).groupby(["scene", "target"], sort=False):
        times = group.set_index("name")["at_target_s"] / group["at_target_s"].iloc[0]
        tied, others = tuple(times.index[times <= TIE]), times[times > TIE]
        following = (
            {"next": "", "margin": np.inf} if others.empty else {"next": others.index[0], "margin": others.iloc[0]}
        )
        rows.append({**group.iloc[0], "tied": tied, **following, "dem": times.get("dem", np.nan)})
    return pd.DataFrame(rows, columns=[*COLUMNS, "tied", "next", "margin", "dem"])


def without_multipoles(df):
    """Rows of the methods that know any shape."""
    return df[df["name"] != "multipole"]


def beside_dem(df, target):
    """Scenes that the DEM wins, ties and loses against methods for any shape, by factors; never: only others get there.

    A factor is the cost of the next method over the DEM's where it wins, else of the DEM over the cheapest.
    """
    found = {"wins": {}, "ties": {}, "losses": {}, "never": {}}
    for row in winners(without_multipoles(df), targets=(target,)).itertuples():
        if np.isnan(row.dem):
            found["never"][row.scene] = np.inf
        elif row.tied == ("dem",):
            found["wins"][row.scene] = row.margin
        else:
            found["ties" if row.dem <= TIE else "losses"][row.scene] = row.dem
    return found


def in_words(df, target):
    """Where the DEM wins and loses, as a sentence."""
    found = beside_dem(df, target)
    wins = f"the cheapest, by so many times to the next, on {_named(found['wins'])}"
    parts = [wins if found["wins"] else "the cheapest nowhere"]
    if found["ties"]:
        parts.append(f"in a tie on {_list(found['ties'])}")
    if found["losses"]:
        parts.append(f"dearer than the cheapest, so many times, on {_named(found['losses'])}")
    if found["never"]:
        parts.append(f"not there with the resolutions tried on {_list(found['never'])}")
    return f"For {target:g} % the DEM is " + "; ".join(parts) + "."


def _named(factors):
    """Such as "half 2, 1000 spheres (no other)"."""
    said = {scene: f"{factor:.2g}" if np.isfinite(factor) else "(no other)" for scene, factor in factors.items()}
    return ", ".join(f"{scene} {factor}" for scene, factor in said.items())


def counts_in_words(df, target):
    """On which scenes each method for any shape is the cheapest, where some tie, and where none gets there."""
    best = winners(without_multipoles(df), targets=(target,))
    scenes = [scene for scene in (*STEADY, *IN_TIME) if (df["scene"] == scene).any()]
    alone = best[best["tied"].map(len) == 1]
    parts = [
        f"{label(name)} on {len(alone[alone['name'] == name])} ({_list(alone[alone['name'] == name]['scene'])})"
        for name in alone["name"].value_counts().index
    ]
    parts += [
        f"a tie of {' and '.join(map(label, row.tied))} on {row.scene}"
        for row in best.itertuples()
        if len(row.tied) > 1
    ]
    none = [scene for scene in scenes if scene not in set(best["scene"])]
    never = beside_dem(df, target)["never"]
    said = f"of {len(scenes)} scenes {target:g} % costs least by {', '.join(parts)}"
    said += f"; none of them gets there with the resolutions tried on {_list(none)}" if none else ""
    return said + (f"; the DEM alone does not on {_list(never)}" if never else "")


def losses_in_words(df):
    """On how many scenes the DEM costs more than the cheapest method for any shape, or does not get there."""
    parts = []
    for target in TARGETS:
        found = beside_dem(df, target)
        lost = len(found["losses"]) + len(found["never"])
        parts.append(f"on {lost} of {sum(map(len, found.values()))} scenes to {target:g} %")
    return ", ".join(parts)


def run_twice(df):
    """Factors between the costs of two solves by the DEM that do the same, one after the other: no packing is made."""
    rows = df[(df["name"] == "dem") & df["scene"].notna() & ~df["scene"].isin(ROUND) & (df["status"] == "ok")]
    return np.exp(abs(np.log(rows["cached_cpu_s"] / rows["cpu_s"])))


def ties_in_words(df):
    """What two solves that do the same differ by."""
    factors = run_twice(df)
    half, most = factors.quantile(0.5), factors.quantile(0.9)
    said = f"of {len(factors)} solves by the DEM that were run twice half agree within {half:.3g} times"
    return f"{said}, nine in ten within {most:.3g}"


def packing_in_words(df):
    """CPU time of the largest packing that was made on the spot, beside its solve: of the paper's network."""
    rows = df[(df["name"] == "dem-calibrated") & df["cached_cpu_s"].notna()]
    row = rows.loc[rows["particles"].idxmax()]
    made, solve = row["cpu_s"] - row["cached_cpu_s"], row["cached_cpu_s"]
    return f"{made:.2g} CPU-seconds, {made / solve:.2g} times the solve"


def _list(names):
    return ", ".join(names)


def starred(scene):
    """A scene's name, with a star if constants of the DEM were found on it or on its body at another contrast."""
    return f"{scene} *" if scene in TUNED else scene


def label(name):
    """Title of a method."""
    return methods.all_methods()[name].title
