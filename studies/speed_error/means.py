"""Figures read off rows in time: points of error against cost, the cheapest way to a target, where the DEM loses."""

from __future__ import annotations

import numpy as np

from studies.harness import methods
from studies.harness.methods import EDGE, resolution
from studies.harness.pick import with_size
from studies.speed_error.cases import LENGTHS
from studies.speed_error.scenes import IN_TIME, ROUND

TARGETS = (1.0, 0.1, 0.01)  # per cent
# Costs nearer to each other than this factor are a tie: of solves that were run twice nine in ten are (a claim).
TIE = 1.5
COSTS = ("unknowns", "cpu_s", "wall_s", "peak_mib", "cached_cpu_s")
COLUMNS = ("scene", "target", "name", "resolution", "error", *COSTS, "at_target_s")


def points(df):
    """One point per method, scene in time and resolution: largest error of its packings, %, mean costs."""
    import pandas as pd

    rows = []
    solves = df[df["scene"].isin(IN_TIME) & (df["status"] == "ok")]
    for (scene, name, _), group in with_size(solves).groupby(["scene", "name", "h"], dropna=False, sort=False):
        row = {"scene": scene, "name": name, "error": group["error_percent"].abs().max()}
        row |= {key: group[key].mean() if key in group else np.nan for key in COSTS}
        rows.append(row | {"resolution": words(group.iloc[0])})
    return pd.DataFrame(rows, columns=["scene", "name", "error", *COSTS, "resolution"])


def words(row):
    """Resolution of a row in words, sizes in lengths of its scene."""
    length = LENGTHS.get(row["scene"], EDGE)
    return resolution({**row, "size": row["size"] * EDGE / length} if "size" in row else row)


def cheapest(df, targets=TARGETS):
    """For each scene, target and method the cheapest resolution from which on all are within it.

    `at_target_s` is what the target itself would cost: between that resolution and the next coarser one, which misses
    it, by a power law; else ladders of few resolutions would decide who wins.
    """
    import pandas as pd

    found = []
    for _, group in points(df).groupby(["scene", "name"], sort=False):
        group = group.sort_values("unknowns")
        # An error may cross zero by luck: only a resolution after which all stay good counts.
        lasting = group["error"][::-1].cummax()[::-1]
        for target in targets:
            good = group[lasting <= target]
            if len(good):
                best = good.loc[good["cpu_s"].idxmin()]
                missed = group.assign(error=lasting)[lasting > target].tail(1)
                found.append({"target": target, **best, "at_target_s": _between(missed, best, target)})
    frame = pd.DataFrame(found, columns=list(COLUMNS))
    place = {name: number for number, name in enumerate(IN_TIME)}
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


def winners(df, targets=TARGETS):
    """The cheapest method of each scene and target, those that tie with it, the next, and what next and DEM cost."""
    import pandas as pd

    rows = []
    for _, group in cheapest(df, targets).groupby(["scene", "target"], sort=False):
        times = group.set_index("name")["at_target_s"] / group["at_target_s"].iloc[0]
        tied, others = tuple(times.index[times <= TIE]), times[times > TIE]
        following = (
            {"next": "", "margin": np.inf} if others.empty else {"next": others.index[0], "margin": others.iloc[0]}
        )
        rows.append({**group.iloc[0], "tied": tied, **following, "dem": times.get("dem", np.nan)})
    return pd.DataFrame(rows, columns=[*COLUMNS, "tied", "next", "margin", "dem"])


def in_words(df, target):
    """Where the DEM wins and loses, as a sentence; factors are of the next over it, or of it over the cheapest."""
    parts = []
    for row in winners(df, (target,)).itertuples():
        if np.isnan(row.dem):
            said = "not there with the resolutions tried"
        elif row.tied == ("dem",):
            said = f"the cheapest, {row.margin:.2g} times" if row.next else "the cheapest, no other gets there"
        else:
            said = "in a tie" if row.dem <= TIE else f"dearer than the cheapest, {row.dem:.2g} times"
        parts.append(f"{said}, on {row.scene}")
    return f"For {target:g} % the DEM is {'; '.join(parts) or 'nowhere'}."


def run_twice(df):
    """Factors between the costs of two solves by the DEM that do the same, one after the other: no packing is made."""
    rows = df[(df["name"] == "dem") & df["scene"].notna() & ~df["scene"].isin(ROUND) & (df["status"] == "ok")]
    return np.exp(abs(np.log(rows["cached_cpu_s"] / rows["cpu_s"])))


def packing_in_words(df):
    """CPU time of the largest packing that was made on the spot, beside its solve: of the paper's network."""
    rows = df[(df["name"] == "dem-calibrated") & df["cached_cpu_s"].notna()]
    row = rows.loc[rows["particles"].idxmax()]
    made, solve = row["cpu_s"] - row["cached_cpu_s"], row["cached_cpu_s"]
    return f"{made:.2g} CPU-seconds, {made / solve:.2g} times the solve"


def label(name):
    """Title of a method."""
    return methods.all_methods()[name].title
