"""A program's own cost: run by a process that is small.

What Linux calls the peak memory of a process begins with that of the process which started it: `true`, started by a
Python of 300 MiB, is said to have had 314 MiB.
"""

from __future__ import annotations

import json
import subprocess
import sys

from studies.peers.outside import ran

# A Python of some 10 MiB, which starts the program and says as its last line what it cost.
STARTS = """
import json, resource, subprocess, sys, time
start = time.perf_counter()
status = subprocess.call(sys.argv[1:])
wall, used = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
cost = {"wall_s": wall, "cpu_s": used.ru_utime + used.ru_stime, "peak_mib": used.ru_maxrss / 1024}
print()
print(json.dumps(cost))
sys.exit(status if status >= 0 else 128 - status)
"""
# Of linear algebra; programs that know neither run on one.
THREADS = {"OMP_NUM_THREADS": "2", "OPENBLAS_NUM_THREADS": "2", "MKL_NUM_THREADS": "2"}


def ran_alone(command, *, folder=None, stdin="", environment=None) -> tuple[str, dict]:
    """Run a program to its end, as `studies.peers.outside.ran` does, and measure its processes only.

    Parameters
    ----------
    command : sequence of str
    folder : path, optional
        Where it runs.
    stdin : str
    environment : mapping of str to str, optional
        What is added to the environment, besides two threads.

    Returns
    -------
    printed : str
        On its standard output.
    cost : dict
        `wall_s`, `cpu_s`, s, and `peak_mib`, MiB, of the largest of its processes; `whole`, for start and reading are
        included.

    Raises
    ------
    RuntimeError
        If it did not exit with 0.
    """
    launched = [sys.executable, "-I", "-S", "-c", STARTS, *command]
    printed, _ = ran(launched, folder=folder, stdin=stdin, environment=THREADS | (environment or {}))
    rest, _, last = printed.rstrip().rpartition("\n")
    return rest, json.loads(last) | {"whole": True}


def packaged(name) -> str:
    """Version of a Debian package; empty where there is none.

    Parameters
    ----------
    name : str
    """
    try:
        asked = subprocess.run(["dpkg-query", "-W", "-f=${Version}", name], capture_output=True, text=True)
    except FileNotFoundError:
        return ""
    return asked.stdout if asked.returncode == 0 else ""
