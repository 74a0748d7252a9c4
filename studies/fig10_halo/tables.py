"""The table of the study of halos."""

from __future__ import annotations

from studies.fig10_halo.statistics import COSTED, PAPER, long
from studies.harness.pick import pick


def lines(df):
    """Table as a data frame, a line for each network and number of particles."""
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
