"""Make the quick rows of a study here, then on two workers, then on two of which one is killed now and then; compare.

    PYTHONPATH=.:tests python tests/tools/lost_workers.py surfaces --kills 3 --seed 0 --out out/lost

Each time it is the command that people give, in a folder of its own. The times of the kills, and which worker they hit,
are drawn by the seed, uniform over what the run without kills took. Prints one line for each run.
"""

import argparse
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

from studies.harness.store import read_rows

ROOT = Path(__file__).resolve().parents[2]
# What differs between two runs of one row besides seconds: memory, the hour, what else went on meanwhile or before.
MEASURED = {"peak_mib", "base_mib", "peak_by", "when", "load", "beside", "triad_gbs", "host", "packing_cached"}
# How Dask's nannies start their workers.
WORKER = b"multiprocessing.spawn"
# Between two looks at what runs, s.
PAUSE = 0.05


class Run(NamedTuple):
    """One run of a study's quick rows."""

    rows: dict  # By their cases
    seconds: float
    status: int
    said: str  # On its error stream
    killed: list  # list of (seconds, rows home by then)


def ran(name, out, *options, moments=(), drawn=None):
    """Make the quick rows of a study by the command; kill one of its workers at some moments."""
    out.mkdir(parents=True)
    words = [sys.executable, "-m", "studies", "run", name, "--quick", "--force", "--out", str(out), *options]
    begun, killed = time.monotonic(), []
    with (out / "said").open("wb") as said, (out / "printed").open("wb") as printed:
        process = subprocess.Popen(words, cwd=ROOT, stdout=printed, stderr=said, env=_environment())
        try:
            up = None
            for moment in sorted(moments):
                while process.poll() is None and (up is None or time.monotonic() < up + moment):
                    up = time.monotonic() if up is None and "dashboard" in (out / "printed").read_text() else up
                    time.sleep(PAUSE)
                if process.poll() is None:
                    _kill_one(process.pid, drawn)
                    killed.append((time.monotonic() - begun, len(read_rows(out / f"{name}.csv"))))
            process.wait()
        finally:
            process.kill()
    seconds = time.monotonic() - begun
    return Run(read_rows(out / f"{name}.csv"), seconds, process.returncode, (out / "said").read_text(), killed)


def differences(one, other):
    """Where rows differ in what is not measured: (case, column, value, other value) of each."""
    found = [(case, "case", case in one, case in other) for case in {*one} ^ {*other}]
    for case in {*one} & {*other}:
        for column in {*one[case]} | {*other[case]}:
            if column in MEASURED or column.endswith("_s"):
                continue
            values = one[case].get(column), other[case].get(column)
            found += [(case, column, *values)] if values[0] != values[1] else []
    return sorted(found, key=str)


def _kill_one(parent, drawn):
    """Kill one of the workers that a process has started; a nanny may be about to start one in place of the last."""
    while not (workers := _workers(parent)):
        time.sleep(PAUSE)
    os.kill(drawn.choice(workers), signal.SIGKILL)


def _workers(parent):
    children = [word for path in Path(f"/proc/{parent}/task").glob("*/children") for word in path.read_text().split()]
    return sorted(int(each) for each in children if WORKER in Path(f"/proc/{each}/cmdline").read_bytes())


def _environment():
    return os.environ | {"PYTHONPATH": str(ROOT)}


def main(words=None):
    """Three runs and what differs; 1 if anything does."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("name", metavar="STUDY")
    parser.add_argument("--kills", type=int, default=3)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, required=True, help="a folder that is not there yet")
    asked = parser.parse_args(words)
    local = ran(asked.name, asked.out / "local")
    print(f"here: {len(local.rows)} rows in {local.seconds:.0f} s", flush=True)
    shared = ran(asked.name, asked.out / "workers", "--workers", "2")
    drawn = random.Random(asked.seed)
    moments = [drawn.uniform(0.0, shared.seconds) for _ in range(asked.kills)]
    lost = ran(asked.name, asked.out / "killed", "--workers", "2", moments=moments, drawn=drawn)
    wrong = local.status
    for what, run in (("two workers", shared), ("two workers, killed", lost)):
        off = differences(local.rows, run.rows)
        when = "".join(f"; one killed at {at:.0f} s, {home} rows home" for at, home in run.killed)
        print(f"{what}: {len(run.rows)} rows in {run.seconds:.0f} s, {len(off)} differences{when}", flush=True)
        print("".join(f"  {each}\n" for each in off[:20]) + run.said, end="", flush=True)
        wrong |= run.status | bool(off)
    return int(wrong)


if __name__ == "__main__":
    sys.exit(main())
