"""A program in a process of its own: which Python has it, how it is run, and what it cost."""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from functools import cache
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
# Where programs in Python may have environments of their own, which `.peers/NAME` names.
HOMES = Path(os.environ.get("DEMHEAT_PEERS", ROOT / ".peers"))
LIMIT = 900.0
# A process counts what its parent had in memory when it began: a small one stands between, and says what was used.
BETWEEN = """
import json, os, resource, sys
status = os.spawnvp(os.P_WAIT, sys.argv[2], sys.argv[2:])
used = resource.getrusage(resource.RUSAGE_CHILDREN)
with open(sys.argv[1], "w") as out:
    json.dump([used.ru_utime + used.ru_stime, used.ru_maxrss / 1024], out)
sys.exit(status if status >= 0 else 128 - status)
"""


class Found(NamedTuple):
    """What a program found, and what it cost."""

    conductivity: float  # W/(m K), effective, along x
    cost: dict  # wall_s, cpu_s, peak_mib
    unknowns: int | None = None
    iterations: int | None = None
    note: str = ""


def ran(command, *, folder=None, stdin="", limit=LIMIT, environment=None) -> tuple[str, dict]:
    """Run a program to its end, in an empty folder if it is given none: some leave logs where they are started."""
    start = time.perf_counter()
    with (
        tempfile.TemporaryDirectory() as empty,
        tempfile.TemporaryFile("w+") as said,
        tempfile.TemporaryFile("w+") as complained,
        tempfile.NamedTemporaryFile("r") as used,
    ):
        child = subprocess.Popen(
            [sys.executable, "-S", "-E", "-c", BETWEEN, used.name, *map(str, command)],
            cwd=folder or empty,
            stdin=subprocess.PIPE,
            stdout=said,
            stderr=complained,
            text=True,
            env={**os.environ, **(environment or {})},
            start_new_session=True,
        )
        try:
            child.communicate(stdin, timeout=limit)
        except subprocess.TimeoutExpired:
            os.killpg(child.pid, signal.SIGKILL)
            child.communicate()
            raise RuntimeError(f"{Path(command[0]).name}: not done after {limit:.0f} s") from None
        wall = time.perf_counter() - start
        said.seek(0), complained.seek(0)
        printed, errors = said.read(), complained.read()
        if child.returncode:
            tail = " ".join((errors or printed).split())[-400:]
            raise RuntimeError(f"{Path(command[0]).name}: exit status {child.returncode}: {tail}")
        cpu, peak = json.load(used)
    return printed, {"wall_s": wall, "cpu_s": cpu, "peak_mib": peak}


def asked(python, script, given, **knobs) -> dict:
    """Run a script that reads one JSON object and prints another as its last line."""
    printed, cost = ran([python, script], stdin=json.dumps(given), **knobs)
    lines = printed.strip().splitlines()
    try:
        return {**json.loads(lines[-1]), "whole": cost}
    except (IndexError, ValueError):
        raise RuntimeError(f"{Path(script).name}: printed no JSON, but {printed[-200:]!r}") from None


@cache
def python_of(name: str, module: str | None = None) -> str | None:
    """The Python that has a package: `.peers/NAME`, this one, or the system's; None if there is none."""
    search = f"import importlib.util as u, sys; sys.exit(u.find_spec({(module or name)!r}) is None)"
    for python in (HOMES / name / "bin" / "python", Path(sys.executable), Path("/usr/bin/python3")):
        if python.exists() and subprocess.run([python, "-c", search], capture_output=True).returncode == 0:
            return str(python)
    return None
