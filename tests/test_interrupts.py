"""Ctrl-C ends what would take many minutes: each in a process of its own, by its kind of exit and not by the clock."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
# Each runs for over half a minute with one thread, most of it in the compiled loop that says `begun`, and would end
# with status 0; the calls before are for compiling.
HEAD = """
import numpy as np
from demheat.packing.base import make_packing
def announced(module, name):
    whole = getattr(module, name)
    def wrapper(*arguments):
        print("begun", flush=True)
        return whole(*arguments)
    setattr(module, name, wrapper)
def points(n):
    centers = np.random.default_rng(0).random((n, 3))
    return make_packing(centers, np.full(n, 0.5 * (0.6 / n) ** (1 / 3)), (1.0, 1.0, 1.0), True, {})
"""
STAGES = {
    "radial distribution": """
from demheat.packing.statistics import correlations, radial_distribution
radial_distribution(points(1000), r_max=1.0)
packing = points(500_000)
announced(correlations.kernels, "pair_counts")
radial_distribution(packing, r_max=0.45 / (2 * packing.radii[0]))
""",
    "two-point probability": """
from demheat.packing.statistics import correlations, two_point
two_point(points(1000), r_max=1.0, lines=10)
announced(correlations.kernels, "line_correlations")
two_point(points(1000), r_max=1.0, lines=3_000_000, along=[(1, 0, 0)] * 50)
""",
    "halo": """
from demheat.sampling.halo import halo_average, kernels
def average(n, radius):
    x, phase = points(n).centers, np.arange(n) % 2
    halo_average(x, x, np.ones(n), radius=radius, size=(1.0, 1.0, 1.0), periodic=True, phases=(phase, phase))
average(100, 0.2)
announced(kernels, "ball_means")
average(700_000, 0.13)
""",
    "neighbours": """
from demheat.packing.neighbours import kernels, near_rows
def search(n, skin):
    packing = points(n)
    near_rows(np.column_stack((packing.centers, packing.radii)), packing.size, packing.periodic, skin=skin, guess=0.01)
search(100, 0.1)
announced(kernels, "near_rows")
search(600_000, 0.25)
""",
    "time steps": """
from demheat import Material, Scene, evolve
scene = Scene(size=(1.0, 1.0, 1.0), matrix=Material(1.0, density=1.0, heat_capacity=1.0), initial=0.0,
              walls={"x-": 0.0, "x+": 1.0})
def march(last):
    return list(evolve(scene, [last], particles=300, integrator="euler", step=1e-6))
march(1e-5)
print("begun", flush=True)
march(1e3)
""",
}


# Two CPU-seconds each; these loops stop as that of halos does, and time steps between two of them: `make test-slow`.
SLOW = ("radial distribution", "two-point probability", "neighbours", "time steps")


@pytest.mark.parametrize(
    "stage", [pytest.param(stage, marks=pytest.mark.slow) if stage in SLOW else stage for stage in STAGES]
)
def test_ctrl_c(stage, tmp_path):
    run = subprocess.Popen(
        [sys.executable, "-c", HEAD + STAGES[stage]],
        env=os.environ | {"NUMBA_NUM_THREADS": "1", "PYTHONPATH": str(ROOT), "DEMHEAT_CACHE": str(tmp_path)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # Where SIGINT is ignored, as in the background of a script, children would ignore it too.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    try:
        assert run.stdout.readline() == "begun\n", run.communicate()[1]
        with pytest.raises(subprocess.TimeoutExpired):
            run.wait(0.3)
        run.send_signal(signal.SIGINT)
        _, said = run.communicate(timeout=60)
    finally:
        run.kill()
        run.communicate()
    assert run.returncode == -signal.SIGINT and said.endswith("KeyboardInterrupt\n")
