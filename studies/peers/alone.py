"""Programs that are measured as a whole, start and reading included, on two threads; versions of packages."""

import subprocess

from studies.peers.outside import ran

# Of linear algebra; programs that know neither run on one.
THREADS = {"OMP_NUM_THREADS": "2", "OPENBLAS_NUM_THREADS": "2", "MKL_NUM_THREADS": "2"}


def ran_alone(command, *, folder=None, stdin="", environment=None) -> tuple[str, dict]:
    """Run a program to its end, as `studies.peers.outside.ran` does, on two threads."""
    printed, cost = ran(command, folder=folder, stdin=stdin, environment=THREADS | (environment or {}))
    return printed, cost | {"whole": True}


def packaged(name) -> str:
    """Version of a Debian package; empty where there is none."""
    try:
        asked = subprocess.run(["dpkg-query", "-W", "-f=${Version}", name], capture_output=True, text=True)
    except FileNotFoundError:
        return ""
    return asked.stdout if asked.returncode == 0 else ""
