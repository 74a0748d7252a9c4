"""Rows that are computed on the ranks of an MPI run, by a Python of their own that has PETSc."""

import json
import os
import shutil
import subprocess
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
# Where programs in Python may have environments of their own, as the study `peers` has it.
HOMES = Path(os.environ.get("DEMHEAT_PEERS", ROOT / ".peers"))
# Debian's PETSc, where nothing else is said.
DEBIAN = "/usr/lib/petscdir/petsc*/*-real"
# Any user; as many ranks as are asked for; one thread in each; ranks that wait leave the core to others.
FREE = {
    **dict.fromkeys(("OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"), "1"),
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_mpi_yield_when_idle": "1",
    **dict.fromkeys(("OMP_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"),
}
LIMIT = 1800.0
SEARCH = """
import sys
from importlib.util import find_spec
sys.exit(any(find_spec(name) is None for name in sys.argv[1:]))
"""


@cache
def python() -> str | None:
    """The Python that runs `demheat.mpi`: what DEMHEAT_MPI_PYTHON names, or `.peers/mpi`; None if there is none."""
    named = os.environ.get("DEMHEAT_MPI_PYTHON")
    found = Path(named) if named else HOMES / "mpi" / "bin" / "python"
    return str(found) if found.exists() and finds(str(found), "mpi4py", "petsc4py", "numba") else None


@cache
def finds(python: str, *names: str) -> bool:
    """Whether a Python finds modules where ranks run."""
    search = [python, "-c", SEARCH, *names]
    return not subprocess.run(search, env=environment(), capture_output=True).returncode


def missing() -> str | None:
    """Why no row can be computed here, in one line; None if it can."""
    if shutil.which("mpiexec") is None:
        return "no mpiexec here (apt: openmpi-bin)"
    if python() is None:
        return "no Python with mpi4py, petsc4py and numba: neither DEMHEAT_MPI_PYTHON nor .peers/mpi, see docs/mpi.md"
    return None


def row(number: int, particles: int, seed: int, ranks: int) -> dict:
    """One body solved on so many ranks."""
    why = missing()
    if why:
        raise NotImplementedError(why)
    given = {"number": number, "particles": particles, "seed": seed}
    command = [shutil.which("mpiexec"), "-n", str(ranks), python(), str(Path(__file__).with_name("on_ranks.py"))]
    how = {"input": json.dumps(given), "timeout": LIMIT, "env": environment()}
    done = subprocess.run(command, capture_output=True, text=True, **how)
    if done.returncode:
        tail = " ".join((done.stderr or done.stdout).split())[-400:]
        raise RuntimeError(f"on_ranks.py: exit status {done.returncode}: {tail}")
    try:
        return json.loads(done.stdout.strip().splitlines()[-1])
    except (IndexError, ValueError):
        raise RuntimeError(f"on_ranks.py: printed no JSON, but {done.stdout[-200:]!r}") from None


def environment() -> dict:
    """What ranks run in: this process's environment, with PETSc's folders where nobody has named them."""
    found = {**os.environ, **FREE}
    paths = [str(ROOT)]
    if "PETSC_DIR" not in os.environ:
        for folder in sorted(Path("/").glob(DEBIAN[1:]))[-1:]:
            found["PETSC_DIR"] = str(folder)
            paths.append(str(folder / "lib" / "python3" / "dist-packages"))
    found["PYTHONPATH"] = os.pathsep.join([*paths, *filter(None, [os.environ.get("PYTHONPATH")])])
    return found
