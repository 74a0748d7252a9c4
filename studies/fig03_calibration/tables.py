"""The table of the calibration."""

from studies.fig03_calibration.variants import KNOBS, VARIED


def table(df):
    """C_t by number of particles, mean over three packings, of costly ones, isothermal ends and changes of one.

    Scatter is the coefficient of variation at 1e5, %.

    Bound and formula are at the largest number of particles: 1 over the conductivity under a linear field, below which
    C_t cannot lie in the periodic cell, and 4 <R^3>/(Z phi <R_m^3>), <R^3> over particles and <R_m^3> over links.
    """
    import pandas as pd

    rows = []
    changes = [name for name in KNOBS if name in df]
    numbers = sorted(df["particles"].unique())
    for (loading, domain, packing, *change), group in df.groupby(
        ["loading", "domain", "packing", *changes], dropna=False, sort=False
    ):
        row = {"load": loading, "domain": domain, "packing": packing}
        row["change"] = ", ".join(f"{n} {v}" for n, v in zip(changes, change, strict=True) if v == v)
        mean = group.groupby("particles")["ct"].mean()
        row |= {f"{n:.0e}".replace("e+0", "e"): f"{mean[n]:.4f}" if n in mean else "" for n in numbers}
        here = group[group["particles"] == VARIED]["ct"]
        row["scatter"] = float(100 * here.std() / here.mean()) if len(here) > 1 else float("nan")
        largest = group[group["particles"] == group["particles"].max()]
        names = {"bound": "bound", "formula": "formula", "gap": "gap", "under_2": "under 2 links"}
        rows.append(row | {new: float(largest[old].mean()) for old, new in names.items()})
    return pd.DataFrame(rows)
