"""An image in PuMA's pumapy: finite volumes with insulated sides, or bricks on a periodic body.

Reads one JSON object: `image` (an .npz of `labels`), `conductivities` by label, `by` ("fv" or "fe") and `unit`
(W/(m K), in which conductivities are given to it); prints another.
"""

import json
import os
import sys
from pathlib import Path

import numpy as np
import pumapy
from spent import Spent

TOLERANCE, MOST = 1e-10, 20_000


def main():
    """Read what is asked for, answer."""
    given = json.loads(sys.stdin.read())
    with np.load(given["image"]) as file:
        labels = file["labels"]
    # It writes logs where it runs.
    os.chdir(Path(given["image"]).parent)
    clock = Spent()
    body = pumapy.Workspace.from_array(labels)
    fv = given["by"] == "fv"
    phases = pumapy.IsotropicConductivityMap() if fv else pumapy.AnisotropicConductivityMap()
    add = phases.add_material if fv else phases.add_isotropic_material
    for label, value in enumerate(given["conductivities"]):
        add((label, label), value / given["unit"])
    knobs = {"side_bc": "s"} if fv else {"solver_type": "minres", "method": "fe"}
    found, *_ = pumapy.compute_thermal_conductivity(
        body, phases, "x", tolerance=TOLERANCE, maxiter=MOST, display_iter=False, **knobs
    )
    answer = {"conductivity": given["unit"] * float(found[0]), "iterations": None, "unknowns": labels.size}
    print(json.dumps({**answer, "cost": clock.so_far()}))


if __name__ == "__main__":
    main()
