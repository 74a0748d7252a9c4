"""A packing by spheropack, in the Python that has it: JSON in and out."""

import json
import resource
import sys
import time

import numpy as np
import spheropack


def spent():
    """CPU seconds of this process."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


given = json.load(sys.stdin)
cpu, wall = spent(), time.perf_counter()
found = spheropack.pack(
    radii=np.array(given["radii"]),
    container=spheropack.Box(given["size"], periodic=False),
    density=given["density"],
    growth_rate=given["growth"],
    seed=given["seed"],
    strict=given["density"] != "max",
)
cost = {"cpu_s": spent() - cpu, "wall_s": time.perf_counter() - wall}
cost["peak_mib"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
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
