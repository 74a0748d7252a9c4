"""What the rows of programs say together."""

import numpy as np

from studies.peers.tables import ours

# Error at which programs are compared by their costs, %.
AIM = 0.1
# Who is given these does a part of the work, and has the cost of that alone.
PARTS = ("network", "packing")
# Ours whose cost here is not that of the whole: its packing may be there.
KEPT = ("dem",)
# Ours of a degree; whose unknowns on a mesh are no nodes.
ELEMENTS = {1: "fem-p1", 2: "fem-straight"}
VOLUMES = ("openfoam",)
COMPARED = ("sphere 10", "sphere 0.01", "half 10", "dispersion 10")
# And those that are drawn.
COSTED = (*COMPARED, "pore")


def same_mesh(df):
    """Largest relative difference between elements of others and ours on the same mesh, by program."""
    found = {}
    for degree, name in ELEMENTS.items():
        mine = df[(df["name"] == name) & (df["given"] == "body")]
        known = {(row["scene"], row["size"]): row["conductivity"] for _, row in mine.iterrows()}
        for _, row in df[(df["given"] == "mesh") & ~df["name"].isin(VOLUMES)].iterrows():
            there = known.get((row["scene"], row["size"]))
            if there is not None and row.get("order", 1) == degree:
                apart = abs(row["conductivity"] / there - 1)
                found[row["name"]] = max(apart, found.get(row["name"], 0.0))
    return found


def ahead(df):
    """Least CPU time of other programs to an error over the least of ours, by body; infinite where no other gets there.

    The DEM, whose packing is kept, is left out.
    """
    there = df[df["error_percent"].abs() <= AIM]
    found = {}
    for scene in COMPARED:
        rows = there[there["scene"] == scene]
        mine, others = (
            rows[ours(rows) & ~rows["name"].isin(KEPT)]["cpu_s"],
            rows[~ours(rows) & ~rows["given"].isin(PARTS)]["cpu_s"],
        )
        if len(mine) and len(df[(df["scene"] == scene) & ~ours(df)]):
            found[scene] = float(others.min() / mine.min()) if len(others) else np.inf
    return found
