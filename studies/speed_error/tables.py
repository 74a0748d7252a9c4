"""Lines of the table: what a solve or a kernel costs beside the same again, or beside its peer."""

import pandas as pd

from studies.harness import methods

# Of a row: its peer, and the column of what that costs.
PEERS = {
    "tessellation": (("Voro++", "peer_us_per_particle"),),
    "steady": (("pyamg, Ruge-Stuben", "ruge_stuben_cpu_s"), ("pyamg, aggregation", "aggregation_cpu_s")),
}


def table(df):
    """What a solve or a kernel costs, and over it what the same costs again, or a peer on the same data."""
    found = [line for row in df[df["status"] == "ok"].to_dict("records") for line in _lines(row)]
    return pd.DataFrame(found, columns=["what", "size", "CPU, s", "beside it", "its cost over ours"])


def _lines(row):
    if row["name"] in PEERS:
        what = {"tessellation": "Laguerre tessellation", "steady": "steady equations"}[row["name"]]
        ours = row["us_per_particle" if row["name"] == "tessellation" else "cpu_s"]
        size = f"{row['particles']:.0f} particles"
        for peer, column in PEERS[row["name"]]:
            yield _line(what, size, row["cpu_s"], peer, row[column] / ours)
    elif row.get("cached_cpu_s", 0) > 0:
        title = methods.all_methods()[row["name"]].title
        size = f"{row['particles']:.0f} particles, seed {row['seed']:.0f}"
        yield _line(f"{title}, {row['scene']}", size, row["cpu_s"], "again", row["cached_cpu_s"] / row["cpu_s"])


def _line(*cells):
    return dict(zip(("what", "size", "CPU, s", "beside it", "its cost over ours"), cells, strict=True))
