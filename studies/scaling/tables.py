"""The table of scaling."""

from demheat import referee
from studies.harness.figures import LOOK
from studies.harness.pick import pick
from studies.scaling.means import STAGES, errors, fitted

# Characters of a note on the page; the rows' file has them all.
NOTE = 100


def table(df):
    """CPU and wall seconds of every row, of the DEM by stages, then fits.

    Seconds of the DEM count its packing, cut from a tile. GiB are the peak over what was there before. Errors are those
    of k against the multipoles' of the same spheres, the nearest there are: those of many are known to .01 %, no more;
    coarse rows are there for their costs. "of triad" is the bandwidth of the product of the network's matrix with a
    vector over that of the triad, a = b + s c on arrays too large for caches, right after it with as many threads.
    Exponents are fitted to rows of 100 inclusions and more, each with its standard error.
    """
    import pandas as pd

    df = df.reindex(columns=[*dict.fromkeys([*df.columns, *COLUMNS])])
    solved = errors(df[df["part"].isin(("inclusions", "kinds", "goal", "elements"))])
    rows = [*_before(df), *_most(df), *_ranked(df), *_fits(df)]
    made = [_line(row) for _, row in solved.iterrows()] + rows
    return pd.DataFrame(made)


COLUMNS = (
    *("number", "spheres", "kind", "fraction", "particles", "voxels", "cores", "k_ratio", "unknowns", "peak_mib"),
    *("product_gbs", "triad_here_gbs", "ranks"),
)


def _line(row):
    scene = f"{row['spheres']:.0f} spheres" if row["spheres"] == row["spheres"] else f"{row['number']:.0f} spheres"
    if row["kind"] == "polydisperse":
        scene += ", sizes to 10"
    if row["fraction"] == row["fraction"]:
        scene += f", f = {row['fraction']:g}"
    line = {"what": row["part"], "method": LOOK[row["name"]][0], "of": scene}
    line |= {"unknowns": row["unknowns"], "threads": row["cores"], "CPU, s": row["cpu_s"], "wall, s": row["wall_s"]}
    line |= {"GiB": row["peak_mib"] / 1024, "bytes each": row["peak_mib"] * 2**20 / row["unknowns"]}
    costs = {name: row.get(f"{name}_cpu_s") for name in STAGES}
    line["stages, CPU s"] = ", ".join(f"{k} {v:.2g}" for k, v in costs.items() if v is not None and v == v)
    line["of triad"] = row["product_gbs"] / row["triad_here_gbs"]
    return line | {"error, %": row["error_percent"], "note": _cut(row["note"]) if row["status"] != "ok" else ""}


def _cut(note):
    return note if len(note) <= NOTE else note[: NOTE - 3].rstrip() + "..."


def _before(df):
    """Today's code and the earlier one."""
    for _, row in pick(df[df["status"] == "ok"], part="before").iterrows():
        change = 100 * referee.value_error(row["k"], row["then_k"])
        reason = f"k {change:+.4f} % from the code before, whose margin beside twins was narrower"
        for code, before, note in (("today", "", reason), (row["then"], "then_", "")):
            yield _whole(row, f"code of {code}", before) | {"note": note}


def _most(df):
    """As many particles as memory holds."""
    for _, row in pick(df[df["status"] == "ok"], part="most").iterrows():
        yield _whole(row, f"{row['particles']:.0f} particles")


def _whole(row, what, before=""):
    """A run that is timed as a whole."""
    cost = {key: row[before + key] for key in ("unknowns", "cpu_s", "wall_s", "peak_mib")}
    line = {"what": row["part"], "method": LOOK[row["name"]][0], "of": what, "unknowns": cost["unknowns"]}
    line |= {"CPU, s": cost["cpu_s"], "wall, s": cost["wall_s"], "GiB": cost["peak_mib"] / 1024}
    return line | {"bytes each": cost["peak_mib"] * 2**20 / cost["unknowns"]}


def _ranked(df):
    """Rows on the ranks of an MPI run."""
    for _, row in df[df["part"].isin(("strong", "weak"))].iterrows():
        line = {"what": row["part"], "method": LOOK[row["name"]][0], "of": f"{row['ranks']:.0f} ranks"}
        if row["status"] != "ok":
            yield line | {"note": _cut(row["note"])}
            continue
        line |= {"unknowns": row["unknowns"], "threads": row["ranks"], "CPU, s": row["cpu_s"], "wall, s": row["wall_s"]}
        line |= {"GiB": row["peak_mib"] / 1024, "bytes each": row["peak_mib"] * 2**20 / row["unknowns"]}
        stages = ("packing", "cells", "solve", "field")
        line["stages, CPU s"] = ", ".join(f"{name} {row[f'{name}_cpu_s']:.2g}" for name in stages)
        sent = f"{row['messages']:.0f} messages, {row['message_bytes'] / 1e6:.3g} MB and {row['reductions']:.0f} sums"
        iterations = f"{row['iterations']:.0f} iterations in {row['iterate_wall_s']:.2g} s"
        yield line | {"note": f"{iterations}; each rank {sent}; triad {row['triad_rank_gbs']:.2g} GB/s"}


def _fits(df):
    for part, by in (("inclusions", "number"), ("elements", "unknowns")):
        for _, fit in fitted(pick(df, part=part), by).iterrows():
            text = f"CPU time ~ {by}^({fit['exponent']:.2f} +- {fit['doubt']:.2f}), {fit['rows']:.0f} rows"
            yield {"what": f"fit, {part}", "method": LOOK[fit["name"]][0], "of": fit["stage"], "note": text}
