"""An image in OpenImpala: one conducting phase by its Python interface, or several as its input file says it.

Reads one JSON object: `image` (an .npz of `labels`), `conductivities` by label and `solver` ("mlmg" or "pcg"); prints
another.
"""

import ctypes
import json
import sys

import numpy as np
import openimpala
from openimpala import _core
from spent import Spent

TOLERANCE = 1e-12
PREFIX = b"tortuosity"


def _say(library, name, kind, c_type, values):
    """What `tortuosity.NAME = VALUES` is in an input file, by AMReX's interface for C."""
    block = ctypes.c_void_p()
    library.amrex_new_parmparse(ctypes.byref(block), PREFIX)
    add = getattr(library, f"amrex_parmparse_add_{kind}arr")
    add(block, name, (c_type * len(values))(*values), len(values))
    library.amrex_delete_parmparse(block)


def _several(labels, conductivities):
    """Conductivity of several phases, W/(m K), and iterations: HYPRE's, to its own 1e-9."""
    library = ctypes.CDLL(_core.__file__)
    phases = [label for label, k in enumerate(conductivities) if k > 0]
    _say(library, b"active_phases", "int", ctypes.c_int, phases)
    _say(library, b"phase_diffusivities", "real", ctypes.c_double, [conductivities[label] for label in phases])
    image = _core.VoxelImage.from_numpy(labels)
    kinds = _core.SolverType.PCG, "."
    solver = _core.TortuosityHypre(image, 1.0, phases[0], _core.Direction.X, *kinds)
    tortuosity = solver.value()
    return solver.active_volume_fraction / tortuosity, solver.iterations


def _one(labels, conductivities, solver):
    """Conductivity of one conducting phase, W/(m K), and iterations."""
    knobs = {"mlmg_eps": TOLERANCE} if solver == "mlmg" else {}
    phase = int(np.argmax(conductivities))
    found = openimpala.tortuosity(labels, phase=phase, direction="x", solver=solver, **knobs)
    return conductivities[phase] * found.active_volume_fraction / found.tortuosity, found.iterations


def main():
    """Read what is asked for, answer."""
    given = json.loads(sys.stdin.read())
    with np.load(given["image"]) as file:
        # Its arrays count z first.
        labels = np.ascontiguousarray(file["labels"].T, dtype=np.int32)
    conductivities = given["conductivities"]
    with openimpala.Session():
        clock = Spent()
        if sum(k > 0 for k in conductivities) == 1:
            found, iterations = _one(labels, conductivities, given["solver"])
        else:
            found, iterations = _several(labels, conductivities)
        cost = clock.so_far()
    # AMReX prints a profile as the session ends.
    answer = {"conductivity": found, "iterations": iterations, "unknowns": labels.size}
    print("\n" + json.dumps({**answer, "cost": cost}))


if __name__ == "__main__":
    main()
