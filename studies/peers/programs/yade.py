"""Yade: a DEM code whose ThermalEngine conducts between grains that touch; explicit steps to steadiness.

It works beside a FlowEngine alone ("ThermalEngine cannot be used without FlowEngine", its tutorial on heat), which here
draws its triangulation once and computes no flow. By its source (pkg/pfv/Thermal.cpp) a contact conducts
2 (k_1 + k_2) r_1 r_2/d over the distance d of the centres, whatever the overlap, or with `useKernMethod` a^2 for
r_1 r_2, a the radius of the circle in which two spheres cut each other. Debian's 2023.02a, one thread; the states of
held grains are set by hand.
"""

import json
import shutil
import subprocess
import tempfile
from functools import cache
from pathlib import Path

import numpy as np

from studies.peers import beds
from studies.peers.outside import Found, ran

TITLE = "Yade"
KIND = "packing"
GET = "apt: yade"
CANNOT = {
    "heat without a pore fluid's engine": '"ThermalEngine cannot be used without FlowEngine" (its tutorial)',
    "periodic cells": "FlowEngine wants six walls around the grains",
    "steady states at once": "it marches in time, explicitly",
    "solids": "grains exchange heat through contacts and pores; a body is no packing to it",
}
WHOLE, KERN = "whole grain", "cylinder"
CASES = (
    *beds.cases(WHOLE),
    *beds.cases(KERN, most=1),
    {"scene": "random bed, disc"},
)
EXPLAINED = "of a disc between half-spaces: contacts as wide as the grain, or cylinders from centre to centre"
SCRIPTS = Path(__file__).parent / "scripts"
DENSITY = 1000.0
COMMAND = ("yade", "-n", "-x", "-j1")


def missing() -> str | None:
    """None, or that it is not installed."""
    return None if shutil.which("yade") else "yade is not installed (apt: yade)"


@cache
def version() -> str:
    """As it says of itself."""
    told = subprocess.run(["yade", "--version"], capture_output=True, text=True).stdout
    return told.rpartition("version: ")[2].split(",")[0].split()[0]


def solve(scene, *, n=None) -> Found:
    """Conductivity of a bed by its contacts; of whole grains, unless the scene's law is the cylinder's."""
    if not isinstance(scene, beds.Scene):
        raise NotImplementedError("Yade conducts between grains that touch and through pores: no body, no matrix")
    bed = scene.drawn(n)
    bed = bed._replace(law=KERN if bed.law == KERN else WHOLE)
    step, count = beds.march(bed)
    found = stepped(_given(bed, step, count))
    heat = found["heat"]
    note = f"heat in and out {abs(heat[0] - heat[1]) / heat[0]:.0e} apart"
    value = bed.conductivity(float(np.mean(heat)))
    return Found(value, found["cost"], unknowns=len(bed.radii), iterations=count, note=note)


def _given(bed, step, count):
    """What the script reads."""
    return {
        "centers": bed.centers.tolist(),
        "radii": bed.radii.tolist(),
        "solid": bed.solid.tolist(),
        "held": [None if np.isnan(level) else level for level in bed.held.tolist()],
        "size": bed.size.tolist(),
        "kern": bed.law == KERN,
        "density": DENSITY,
        "capacity": beds.STORED / DENSITY,
        "step": step,
        "count": count,
    }


def stepped(given: dict, *, script: str = "yade_bed.py") -> dict:
    """What a script of Yade finds."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "bed.json").write_text(json.dumps({**given, "scripts": str(SCRIPTS)}))
        ran([*COMMAND, SCRIPTS / script], folder=folder)
        return json.loads(Path(folder, "found.json").read_text())


def own():
    """Temperature of a grain of the rod in Yade's example on heat, and what the Fourier series in it gives."""
    step, count = 1.0, 10_000
    found = stepped({"step": step, "count": count}, script="yade_rod.py")
    x, warmth = np.array(found["x"]), np.array(found["warmth"])
    grain, length = int(np.argmin(np.abs(x - 0.2))), np.ptp(x)
    wave = np.pi * np.arange(1, 1001, 2) / length
    # 6 k/(D pi c rho) with k = 2 x 2 W/(m K) x r and D = 2 r, as the example has it.
    diffusivity = 12.0 / (np.pi * 710.0 * 2600.0)
    series = 1600.0 / (wave * length) * np.sin(wave * (x[grain] - x.min()))
    documented = float(np.sum(series * np.exp(-diffusivity * wave**2 * step * count)))
    return float(warmth[grain]), documented, "examples/ThermalEngine/conductionVerification.py"
