"""Lines of the table: the cheapest method for each scene in time and target."""

from __future__ import annotations

import pandas as pd

from studies.speed_error import means


def lines(df):
    """One line for each scene and target."""
    found = means.winners(df)
    return pd.DataFrame(
        {
            "scene": found["scene"],
            "target, %": found["target"],
            "cheapest": found["name"].map(means.label),
            "resolution": found["resolution"],
            "error, %": found["error"],
            "CPU, s": found["cpu_s"],
            "at the target": found["at_target_s"],
            "wall, s": found["wall_s"],
            "MiB": found["peak_mib"],
            "unknowns": found["unknowns"],
            "DEM's cost over it": found["dem"].map(_times),
            "next": [_next(row) for row in found.itertuples()],
        }
    )


def by_accuracy(df):
    """One line for each scene, a column for each target: the cheapest method, and others beside it."""
    best = means.winners(df)
    best = best.assign(cell=[_cell(row) for row in best.itertuples()])
    wide = best.pivot(index="scene", columns="target", values="cell").reindex(best["scene"].unique())
    return wide[sorted(wide.columns, reverse=True)].rename(columns=lambda target: f"{target:g} %").reset_index()


def _cell(row):
    """Such as "FEM: 0.23 s (DEM 2.1 times)"; "tie of FEM and DEM: 0.23 s"; "DEM: 0.2 s (next FEM, 2.1 times)"."""
    names = " and ".join(map(means.label, row.tied))
    cheapest = f"{'tie of ' if len(row.tied) > 1 else ''}{names}: {row.at_target_s:.2g} s"
    if "dem" in row.tied:
        return cheapest + (f" ({_next(row)})" if row.next else "")
    return cheapest + (" (DEM: no)" if row.dem != row.dem else f" (DEM {row.dem:.2g} times)")


def _next(row):
    """The cheapest method that does not tie, and how many times as much it costs."""
    return f"next {means.label(row.next)}, {row.margin:.2g} times" if row.next else ""


def _times(ratio):
    return "does not reach it" if ratio != ratio else f"{ratio:.2g}"
