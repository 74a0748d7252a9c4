"""A method in one new file is found by the suites, by the studies, and by their tables and figures."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

# Finite volumes on cubes: what a stranger might write first, with a knob that no study has heard of.
TOY = '''
"""Finite volumes on cells that take the material of their centre."""

import numpy as np
from scipy.sparse import coo_matrix, diags
from scipy.sparse.linalg import cg

from demheat.field import Field, Samples
from demheat.method import CUT, Errors, Method, Orders, Resolution

METHODS = (
    Method(
        name="toy",
        title="toy of cells",
        resolution=Resolution("cells", lambda cells: 1 / cells, "{:.0f} cells along an edge"),
        coarse=14,
        errors=Errors(3e-2, 8e-3, 0.45),
        # Theory 1, 1, 1/2 in the layer of cut cells.
        orders=Orders((6, 9, 12), 0.5, 0.5, 0.2, repeats=3),
        exceptions=CUT,
        refuses={"flux": "toy: walls", "pores": "toy: pores"},
    ),
)


def solve(scene, *, cells=30):
    scene.require(steady=True)
    walls = sorted(scene.walls or {})
    if walls and (scene.wall_fluxes or len(walls) != 2 or walls[0][0] != walls[1][0]):
        raise NotImplementedError("toy: walls other than one opposite pair with temperatures")
    if scene.conductivities.min() == 0:
        raise NotImplementedError("toy: pores")
    size = np.array(scene.size)
    shape = np.round(size / size.max() * cells).astype(int)
    h = size / shape
    axes = [(np.arange(n) + 0.5) * step for n, step in zip(shape, h)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    phase = scene.phase_at(points)
    k, number = scene.conductivities[phase], np.arange(len(points)).reshape(shape)
    links = [_links(scene, k, number, axis, h) for axis in range(3)]
    first, second, g, jump = (np.concatenate(part) for part in zip(*links))
    outer = second < 0  # a wall beyond the first cell: at the temperature that its jump holds
    matrix = coo_matrix((-g[~outer], (first[~outer], second[~outer])), shape=(len(k),) * 2).tocsr()
    matrix = matrix + matrix.T
    diagonal = np.bincount(first[outer], g[outer], len(k)) - np.asarray(matrix.sum(axis=1)).ravel()
    matrix = (matrix + diags(diagonal)).tocsr()
    load = np.bincount(first, g * jump, len(k)) - np.bincount(second[~outer], (g * jump)[~outer], len(k))
    steps = []
    warm, _ = cg(matrix, load, rtol=1e-13, callback=steps.append, maxiter=5000)
    residual = float(np.linalg.norm(matrix @ warm - load) / np.linalg.norm(load))
    flux, heat = _fluxes(scene, links, warm, h, shape)
    return _field(scene, (points, phase, warm, flux, h, shape, k), heat, (len(steps), residual))


def _links(scene, k, number, axis, h):
    """First and second cell, conductance, and jump of the temperature from the first to the second, of all links."""
    a = np.moveaxis(number, axis, 0)
    faces = np.prod(h) / h[axis] ** 2
    first, second, jump = a[:-1].ravel(), a[1:].ravel(), np.zeros(a[1:].size)
    g = 2 * k[first] * k[second] / (k[first] + k[second]) * faces
    if scene.periodic:
        one, two = a[-1].ravel(), a[0].ravel()
        more = 2 * k[one] * k[two] / (k[one] + k[two]) * faces
        ends = [(one, two, more, np.full(len(one), scene.gradient[axis] * scene.size[axis]))]
    else:
        cells = {"-": a[0].ravel(), "+": a[-1].ravel()}
        ends = [
            (cells[name[1]], np.full(a[0].size, -1), 2 * k[cells[name[1]]] * faces, np.full(a[0].size, t))
            for name, t in scene.wall_temperatures.items()
            if name[0] == "xyz"[axis]
        ]
    return tuple(np.concatenate(part) for part in zip((first, second, g, jump), *ends))


def _fluxes(scene, links, warm, h, shape):
    """Flux of each cell, mean of those through its two faces, and heat that enters through walls."""
    flux, heat = np.zeros((len(warm), 3)), {}
    for axis, (first, second, g, jump) in enumerate(links):
        area, outer = np.prod(h) / h[axis], second < 0
        there = np.where(outer, jump, warm[second] + np.where(outer, 0.0, jump))
        flow = g * (warm[first] - there) / area  # out of the first cell, towards the second
        high = np.unravel_index(first, shape)[axis] > 0
        sign = np.where(outer & ~high, -1.0, 1.0)
        flux[:, axis] += np.bincount(first, sign * flow, len(warm)) / 2
        flux[:, axis] += np.bincount(second[~outer], flow[~outer], len(warm)) / 2
        for name in scene.wall_temperatures:
            if name[0] == "xyz"[axis]:
                heat[name] = float(-(flow * area)[outer & (high == (name[1] == "+"))].sum())
    return flux, heat


def _field(scene, made, heat, solved):
    points, phase, warm, flux, h, shape, k = made
    slope = -flux / k[:, None]

    def cell(at):
        place = np.floor(at / h).astype(int)
        turns = place // shape if scene.periodic else 0 * place
        place = np.where(scene.periodic, place % shape, np.clip(place, 0, shape - 1))
        return np.ravel_multi_index(place.T, shape), turns * np.array(scene.size)

    def temperature_at(at):
        own, shift = cell(at)
        carried = shift @ np.array(scene.gradient) if scene.periodic else 0.0
        return warm[own] + carried + np.sum((at - shift - points[own]) * slope[own], axis=1)

    volumes = np.full(len(k), scene.volume / len(k))
    return Field(
        scene=scene,
        mean_flux=flux.mean(axis=0),
        fractions=np.bincount(phase, minlength=len(scene.materials)) / len(k),
        sampler=lambda: Samples(points, volumes, warm, phase.astype(np.int32), flux),
        temperature_at=temperature_at,
        flux_at=lambda at: flux[cell(at)[0]],
        wall_temperature=scene.wall_temperatures,
        wall_heat=heat,
        stats={"unknowns": len(k), "iterations": solved[0], "residual": solved[1]},
    )
'''

STUDY = """
import gc
import sys
import warnings

warnings.simplefilter("ignore")
from studies.harness import runner, store, table
from studies.harness.figures import look

# Every cost that is measured begins with a search for garbage, which is spared here.
name, folder = "stability", sys.argv[1]
study = runner.load(name)
# One easy scene, and beside the new method a row of an old one: what the study does without is not the matter here.
old = lambda c: c["name"] == "fft" and c.get("precision")
study.CASES = [c for c in study.CASES if c["fraction"] < 0.2 and (c["name"] == "toy" or old(c))]
study.CASES = [c for c in study.CASES if c["name"] == "toy" or c["contrast"] == 1e-6]
compute = lambda _, *row: gc.freeze() or runner.compute_row(*row, warm=row[1]["name"] == "toy")
path = runner.run_study(name, folder, quick=True, say=lambda line: None, compute=compute)
for key, row in store.read_rows(path).items():
    if row["name"] == "toy":
        print("row", row["status"], key, row["note"])
claims, page = table.render(study, path)
print(page)
print()
print("legend", look("toy"))
named = ("fig14_single_inclusion", "fig17_etc", "fig18_fields", "many_inclusions", "stability")
print("without", [each for each in named if not any(c.get("name") == "toy" for c in runner.load(each).CASES)])
"""


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    """Folder with the toy, and nothing else, in `references`."""
    home = tmp_path_factory.mktemp("home")
    (home / "references").mkdir()
    (home / "references" / "toy.py").write_text(TOY)
    return home


def ran(home, *words):
    """Output of Python in the repository, with the toy on its path."""
    environment = {**os.environ, "PYTHONPATH": str(home), "MPLBACKEND": "agg"}
    done = subprocess.run([sys.executable, *words], cwd=ROOT, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_the_suites_pick_it_up(home):
    words = [
        "-m",
        "pytest",
        "-k",
        "toy",
        "-rA",
        "-p",
        "no:cacheprovider",
        "tests/test_methods.py",
        "tests/test_order.py",
    ]
    passed = [line for line in ran(home, *words).splitlines() if line.startswith("PASSED")]
    assert len(passed) > 25 and "PASSED tests/test_order.py::test_declared_orders[toy]" in passed


def test_studies_tables_and_figures_pick_it_up(home, tmp_path):
    said = ran(home, "-c", STUDY, str(tmp_path))
    rows = [line for line in said.splitlines() if line.startswith("row")]
    assert any(line.startswith("row ok name=toy") and "cells=6" in line for line in rows)
    assert any(line.startswith("row unsupported") and line.endswith("refused: toy: pores") for line in rows)
    assert "| toy of cells, 6 cells along an edge" in said and "toy of cells: share of rows" in said
    legend, studies = said.splitlines()[-2:]
    assert legend.startswith("legend") and "'toy of cells'" in legend
    assert studies == "without []"
