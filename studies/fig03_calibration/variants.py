"""What a case of the calibration may change, one thing at a time, and the rows with and without a change."""

from studies.harness.pick import pick
from studies.harness.printed import printed

# What else the level depends on, one change at a time; on the paper's load and in the periodic cell.
VARIANTS = {
    "as in the paper": {},
    "harmonic mean radius": {"mean": "harmonic"},
    "geometric mean radius": {"mean": "geometric"},
    "one gap for all pairs": {"additive": True},
    "one gap, harmonic": {"additive": True, "mean": "harmonic"},
    "7 links": {"wanted": 7.0},
    "6.5 links": {"wanted": 6.5},
    "spread 0.15": {"spread": 0.15},
}
VARIED = 100_000
PAPER = printed("fig03_calibration")
PRINTED = {100_000: PAPER["ct_1e5"], 1_000_000: PAPER["ct_1e6"]}
# What a case may change.
KNOBS = ("mean", "additive", "wanted", "spread", "margin", "wall", "sparse", "count", "replicas")


def unchanged(df):
    """Rows without a change, default in everything."""
    return df.reindex(columns=list(KNOBS)).isna().all(axis=1)


def variant(df, loading, change, column="ct"):
    """Value of the one row with exactly this change; None without it."""
    rows = pick(df, loading=loading, domain="cube", packing="lsa", particles=VARIED, seed=0)
    rows = pick(rows, **{name: change.get(name) for name in KNOBS})
    return float(rows[column].iloc[0]) if len(rows) == 1 else None
