"""A packing by spheropack, in the Python that has it: JSON in and out."""

import json
import sys

import numpy as np
import spheropack
from spent import Spent

given = json.load(sys.stdin)
clock = Spent()
found = spheropack.pack(
    radii=np.array(given["radii"]),
    container=spheropack.Box(given["size"], periodic=False),
    density=given["density"],
    growth_rate=given["growth"],
    seed=given["seed"],
    strict=given["density"] != "max",
)
cost = clock.so_far()
told = {name: float(getattr(found, name)) for name in ("density", "reduced_pressure", "n_collisions", "min_gap")}
print(
    json.dumps(
        {
            "cost": cost,
            "centers": found.positions.tolist(),
            "radii": found.radii.tolist(),
            "status": found.status,
            **told,
        }
    )
)
