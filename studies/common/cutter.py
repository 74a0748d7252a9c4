"""Our cell cutter beside Voro++ on one packing, and what two threads gain: figures for a row of a study."""

import json
import os
import subprocess
import sys
import time

# What a process of its own does, since compiled code takes the number of its threads from the environment.
CALL = "import json; from studies.common import cutter; print(json.dumps(cutter.cells({particles}, {seed}, {peer})))"


def compared(particles=100_000, *, seed=0, threads=2):
    """Radical cells of one relaxed packing between walls by our cutter, with one thread and with more, and by Voro++.

    Each runs in a process of its own, one after the other. The Voro++ of multivoro is that of November 2023, before its
    bounds of radical cells were mended against rounding.
    """
    one, many = (_run(particles, seed, count) for count in (1, threads))
    cpu, peer = one["cpu_s"] / particles, one["peer_cpu_s"]
    return {
        "us_per_cell": 1e6 * cpu,
        "cells_per_s": 1.0 / cpu,
        "peer_us_per_cell": None if peer is None else 1e6 * peer / particles,
        "ratio": None if peer is None else one["cpu_s"] / peer,
        "efficiency": one["wall_s"] / (threads * many["wall_s"]),
        "again": one["again"],
    }


def cells(particles, seed, peer):
    """Costs of the cells of a packing in this process, the best of three runs: what `compared` puts together."""
    from demheat.network.laguerre import tessellated
    from demheat.packing.cache import relaxed

    for number in (1000, particles):  # the first loads the compiled kernels
        packing = relaxed(number, periodic=False, seed=seed)
        what = packing.centers, packing.radii**2, packing.size
        runs = [_timed(lambda what=what: tessellated(*what, periodic=False)[1]) for _ in range(3)]
    cpu, wall, again = (min(column) for column in zip(*runs, strict=True))
    return {"cpu_s": cpu, "wall_s": wall, "again": again, "peer_cpu_s": _voro(packing) if peer else None}


def _timed(do):
    cpu, wall = time.process_time(), time.perf_counter()
    found = do()
    return time.process_time() - cpu, time.perf_counter() - wall, found


def _voro(packing):
    """CPU time of Voro++, s, the best of two runs; None where it is not installed."""
    try:
        from multivoro import compute_voronoi
    except ImportError:
        return None
    how = {"limits": [[0.0] * 3, packing.size], "periodic_boundaries": (False,) * 3, "radii": packing.radii}
    return min(_timed(lambda: len(compute_voronoi(packing.centers, **how)))[0] for _ in range(2))


def _run(particles, seed, threads):
    code = CALL.format(particles=particles, seed=seed, peer=threads == 1)
    environment = os.environ | {"NUMBA_NUM_THREADS": str(threads)}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])
