"""What every rank of a row runs: `mpiexec -n 2 python on_ranks.py`, with what is asked for on standard input, as JSON.

The first rank prints what the row says as its last line. Kernels are loaded before anything is timed.
"""

import json
import os
import shutil
import sys
import tempfile
import warnings
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from demheat.gallery import sphere_in_cube

CONTRAST = 5.0
# Two ranks must agree on a conductivity to 1e-8.
TOLERANCE = 1e-10
# Loads all kernels; more would cost, fewer make no slabs.
FIRST = 4000
STAGES = ("packing", "cells", "solve", "field")


def bar(number):
    """Spheres in a row, each in a cube of its own, heated across."""
    one = sphere_in_cube(CONTRAST)
    (sphere,), (edge, *sides) = one.inclusions, one.size
    spheres = [replace(sphere, center=(sphere.center[0] + k * edge, *sphere.center[1:])) for k in range(number)]
    return replace(one, size=(number * edge, *sides), inclusions=spheres)


def main():
    """Solve, and print the row on the first rank."""
    from demheat import mpi
    from demheat.mpi.engines import petsc, world

    comm, engine = world(), petsc()
    warnings.simplefilter("ignore")
    given = comm.bcast(json.load(sys.stdin) if comm.rank == 0 else None, root=0)
    scene, knobs = bar(given["number"]), {"seed": given["seed"], "tolerance": TOLERANCE}
    folder = comm.bcast(tempfile.mkdtemp() if comm.rank == 0 else None, root=0)
    os.environ["DEMHEAT_CACHE"] = folder
    mpi.solve(scene, particles=FIRST * comm.size, **knobs)
    _forget_peak()
    engine.Log.begin()
    field = mpi.solve(scene, particles=given["particles"], **knobs)
    row = _said(field) | _logged(engine, comm) | {"triad_rank_gbs": _triad(comm)}
    if comm.rank == 0:
        shutil.rmtree(folder)
        print(json.dumps(row))


def _forget_peak():
    """What was in memory before at its peak would hide as much of what the solve takes (Linux)."""
    from demheat.beyond.ranks import give_back

    give_back()
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")


def _triad(comm):
    """Bandwidth that a rank has while all others use theirs, GB/s."""
    from studies.harness.cost import triad_gbs

    comm.Barrier()
    return comm.allreduce(triad_gbs(threads=1)) / comm.size


def _logged(engine, comm):
    """Of the iterations: seconds of the slowest rank, and messages, bytes and sums of each rank on average.

    Messages and bytes are those that PETSc has counted, sent and received, which are as many.
    """
    found = engine.Log.Event("KSPSolve").getPerfInfo()
    mean = {name: comm.allreduce(found[name]) / comm.size for name in ("numMessages", "messageLength", "numReductions")}
    return {
        "iterate_wall_s": max(comm.allgather(found["time"])),
        "messages": mean["numMessages"] / 2,
        "message_bytes": mean["messageLength"] / 2,
        "reductions": mean["numReductions"],
    }


def _said(field):
    stats = field.stats
    row = {f"{stage}_wall_s": stats[f"{stage}_s"] for stage in STAGES}
    row |= {f"{stage}_cpu_s": stats[f"{stage}_cpu_s"] for stage in STAGES}
    row |= {key: sum(row[f"{stage}_{key}"] for stage in STAGES) for key in ("wall_s", "cpu_s")}
    row |= {name: stats[name] for name in ("unknowns", "iterations", "residual")}
    memory = {"peak_mib": (stats["bytes"] - stats["bytes_before"]) / 2**20, "base_mib": stats["bytes_before"] / 2**20}
    packing = {"twins": stats["packing"]["twins"], "k_body": field.conductivity}
    return row | memory | packing | {"peak_by": "ru_maxrss"}


if __name__ == "__main__":
    main()
