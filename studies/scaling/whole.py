"""Rows of scaling that time a run as a whole: with an earlier code, from an empty cache of compiled code."""

import json
import os
import subprocess
import sys
import tarfile
import tempfile
from io import BytesIO
from pathlib import Path

from studies.harness.cost import measured

ROOT = Path(__file__).parents[2]
FRACTION = 0.2
# The same words for either code: the cell of 83 spheres, the packing made on the spot, kernels loaded before.
SOLVE = """
import json, sys, warnings
warnings.simplefilter("ignore")
from demheat import solve
from studies.common import silica_epoxy
from studies.harness.cost import measured
scene = silica_epoxy.scene("periodic", {fraction}, seed=0)
solve(scene, particles=60_000)
field, cost = measured(solve, scene, particles={particles}, seed={seed})
names = ("packing_s", "unknowns", "iterations")
print(json.dumps(cost | {{name: field.stats[name] for name in names}} | {{"k": field.conductivity}}))
"""
# The README's first example, as a user who has just installed it would run it.
FIRST = """
import time
begun = time.perf_counter()
from demheat import Scene, Material, Sphere, solve
scene = Scene(size=(0.1, 0.1, 0.1), matrix=Material(conductivity=33.0),
              inclusions=[Sphere(center=(0.05, 0.05, 0.05), radius=0.1 / 3, material=Material(conductivity=165.0))],
              walls={{"y-": 25.0, "y+": 35.0}})
solve(scene, particles={particles}, seed={seed})
print(time.perf_counter() - begun)
"""


def before_row(particles, seed, then):
    """The DEM with today's code and with that of a commit, one after the other."""
    words = SOLVE.format(fraction=FRACTION, particles=particles, seed=seed)
    with tempfile.TemporaryDirectory() as folder:
        now = _ran(ROOT, words, folder)
        made = subprocess.run(["git", "-C", str(ROOT), "archive", "--format=tar", then], capture_output=True)
        if made.returncode:
            raise NotImplementedError(f"the history has no commit {then} here")
        with tarfile.open(fileobj=BytesIO(made.stdout)) as archive:
            archive.extractall(Path(folder) / "then", filter="data")
        old = _ran(Path(folder) / "then", words, Path(folder) / "packings")
    return now | {f"then_{key}": value for key, value in old.items() if key not in ("peak_by", "base_mib")}


def most_row(particles, seed):
    """The DEM with today's code, alone in a process: what it takes at its peak."""
    with tempfile.TemporaryDirectory() as folder:
        return _ran(ROOT, SOLVE.format(fraction=FRACTION, particles=particles, seed=seed), folder)


def _ran(root, words, folder):
    """What a script prints, run in a tree with packings of its own."""
    there = {"PYTHONPATH": str(root), "DEMHEAT_CACHE": str(Path(folder) / root.name)}
    done = subprocess.run(
        [sys.executable, "-c", words], cwd=root, env=os.environ | there, stdout=subprocess.PIPE, check=True, text=True
    )
    return json.loads(done.stdout.splitlines()[-1])


def start_row(particles, seed):
    """Wall seconds of the first `solve` of a fresh machine, in a copy of the package that was never compiled, twice."""
    words = FIRST.format(particles=particles, seed=seed)
    with tempfile.TemporaryDirectory() as folder:
        # Rows compile on one core; who solves for the first time does on two.
        there = {"NUMBA_CACHE_DIR": folder, "DEMHEAT_CACHE": folder, "DEMHEAT_WARM": "1"}
        seconds, costs = zip(*(measured(_said, words, there) for _ in range(2)), strict=True)
    return {"first_s": seconds[0], "second_s": seconds[1], **costs[0]}


def _said(words, there):
    done = subprocess.run(
        [sys.executable, "-c", words], cwd=ROOT, env=os.environ | there, stdout=subprocess.PIPE, check=True, text=True
    )
    return float(done.stdout)
