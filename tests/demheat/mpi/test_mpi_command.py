"""Only here: the command on two ranks, where MPI and PETSc are installed; else one line that says so."""

import re
import shlex
import subprocess
import sys

import numpy as np
import pytest
from blocks import DOCS, blocks

from demheat import Material, Scene, Sphere, gallery, solve
from demheat.io import scenes
from demheat.mpi.__main__ import main
from references import fem, fft
from studies.scaling import ranks

PAGE = (DOCS / "mpi.md").read_text(encoding="utf-8")
# In place of what the page has, so that it does not take long; and what one process finds then.
SMALL = {"particles": 4000, "voxels": 21, "size": 0.025}
ALONE = {
    "dem": lambda scene, tolerance: solve(scene, particles=SMALL["particles"], tolerance=tolerance),
    "fft": lambda scene, tolerance: fft.solve(scene, voxels=SMALL["voxels"], rule="laminate", tolerance=tolerance),
    "fem": lambda scene, tolerance: fem.solve(scene, size=SMALL["size"], tolerance=tolerance),
}
# Modules that methods need besides those of the DEM.
NEEDED = {"dem": (), "fft": ("mpi4py_fft",), "fem": ("gmsh", "skfem")}
SPHERE = [Sphere((0.4, 0.1, 0.6), 0.35, Material(0.2))]
CELL = Scene((1.0, 1.3, 0.9), Material(2.0), SPHERE, gradient=(0.0, 0.0, 1.0))


def method_of(command):
    return (re.search(r"--method (\w+)", command) or ["", "dem"])[1]


def ran(command, folder, needed=()):
    """Run a command of the page by the Python that has MPI and PETSc, this one or another."""
    if ranks.missing():
        pytest.skip(ranks.missing())
    if not ranks.finds(ranks.python(), *needed):
        pytest.skip(f"the Python with MPI needs {' and '.join(needed)}")
    words = shlex.split(command.replace(" python ", f" {ranks.python()} ", 1))
    return subprocess.run(words, cwd=folder, capture_output=True, text=True, env=ranks.environment())


@pytest.fixture
def folder(tmp_path):
    scenes.write(gallery.sphere_in_cube(5.0), tmp_path / "scene.toml")
    return tmp_path


def test_without_mpi_one_line_says_what_is_missing(folder, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "mpi4py.MPI", None)
    assert main([str(folder / "scene.toml")]) == 1
    told = capsys.readouterr()
    assert told.out == "" and told.err.count("\n") == 1
    assert told.err.startswith("demheat: demheat.mpi needs mpi4py and petsc4py, which this Python does not find")


def small(text):
    for name, value in SMALL.items():
        text = re.sub(rf"\b{name}([ =])[\d._]+", rf"{name}\g<1>{value}", text)
    return text


def conductivity(done):
    assert done.returncode == 0, done.stderr
    assert re.search(r"\d+ bytes an unknown", done.stdout)
    return float(re.search(r"conductivity +(\S+)", done.stdout)[1])


COMMANDS = [line for line in PAGE.splitlines() if line.startswith("mpiexec ")]


def test_the_page_has_commands():
    assert any("--petsc=" in command for command in COMMANDS)
    assert {method_of(command) for command in COMMANDS} == set(ALONE)


# Some seconds each, most of it for two Pythons to begin.
SLOW = [pytest.param(each, marks=pytest.mark.slow) for each in COMMANDS[1:]]


@pytest.mark.parametrize("command", [*COMMANDS[:1], *SLOW])
def test_the_commands_of_the_page_give_what_one_process_gives(command, folder):
    method = method_of(command)
    done = ran(small(command) + " --tolerance 1e-11", folder, NEEDED[method])
    alone = ALONE[method](scenes.read(folder / "scene.toml"), 1e-11)
    # Rounding, and what is left of either's residual.
    assert conductivity(done) == pytest.approx(alone.conductivity, rel=1e-9)
    if method == "fft":
        # Only they show what preconditions; rounding may make one more.
        assert abs(int(re.search(r"(\d+) iterations", done.stdout)[1]) - alone.stats["iterations"]) <= 1


@pytest.mark.slow
@pytest.mark.parametrize("method", ["fem", "fft"])
def test_periodic_cells_give_what_one_process_gives(method, tmp_path):
    scenes.write(CELL, tmp_path / "cell.toml")
    words = {"fft": "--method fft --voxels 21", "fem": "--method fem --size 0.3"}[method]
    words += " --tolerance 1e-11 --at 0.31 0.77 0.2"
    done = ran(f"mpiexec -n 2 python -m demheat.mpi cell.toml {words}", tmp_path, NEEDED[method])
    knobs = {"fft": {"voxels": 21, "rule": "laminate"}, "fem": {"size": 0.3}}[method]
    alone = {"fft": fft, "fem": fem}[method].solve(scenes.read(tmp_path / "cell.toml"), tolerance=1e-11, **knobs)
    assert conductivity(done) == pytest.approx(alone.conductivity, rel=1e-9)
    if method == "fft":
        # Only they show what preconditions; rounding may make one more.
        assert abs(int(re.search(r"(\d+) iterations", done.stdout)[1]) - alone.stats["iterations"]) <= 1
    # Printed with nine digits.
    temperature = float(re.search(r"temperature +(\S+)", done.stdout)[1])
    assert temperature == pytest.approx(alone.temperature_at((0.31, 0.77, 0.2)), rel=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["fem", "fft"])
def test_the_interval_and_the_file_are_those_of_one_process(method, folder):
    words = {"fft": f"--voxels {SMALL['voxels']}", "fem": f"--size {SMALL['size']}"}[method]
    words = f"--method {method} {words} --tolerance 1e-11 --interval --write field.npz"
    done = ran(f"mpiexec -n 2 python -m demheat.mpi scene.toml {words}", folder, NEEDED[method])
    alone = ALONE[method](scenes.read(folder / "scene.toml"), 1e-11)
    assert conductivity(done) == pytest.approx(alone.conductivity, rel=1e-9)
    # Printed with nine digits, of differences of runs.
    told = [float(each) for each in re.search(r"expected +(\S+) to (\S+)", done.stdout).groups()]
    assert told == pytest.approx([alone.error.lower, alone.error.upper], rel=1e-7)
    with np.load(folder / "field.npz") as written:
        own = alone.samples
        order, theirs = (np.lexsort(np.round(each, 9).T) for each in (written["points"], own.points))
        assert set(written) == set(own._fields)
        for name, values in own._asdict().items():
            # Rounding, and what is left of either's residual, of values up to the largest.
            scale = np.abs(values).max()
            np.testing.assert_allclose(written[name][order], values[theirs], rtol=0, atol=1e-7 * scale, err_msg=name)


@pytest.mark.slow
def test_the_block_of_python_on_the_page(folder):
    """Run as a script on two ranks, smaller."""
    (block,) = (each for each in blocks("mpi.md") if each.kind == "python")
    (folder / "script.py").write_text(small(block.text))
    done = ran("mpiexec -n 2 python script.py", folder, NEEDED["fft"] + NEEDED["fem"])
    assert done.returncode == 0, done.stderr
    # Lines of two ranks may be mixed up.
    scene = scenes.read(folder / "scene.toml")
    unknowns = solve(scene, particles=SMALL["particles"]).stats["unknowns"]
    assert done.stdout.count(f" {unknowns}") == done.stdout.count("'y-': -42.6") == 2
    printed = [float(each) for each in re.findall(r"42\.\d{6}", done.stdout)]
    for method in ("fft", "fem"):
        # What is cut off; the methods' own tolerances leave less: 1e-10 of FFT's conductivity, 1e-9 of elements'.
        found = ALONE[method](scene, 1e-9).conductivity
        assert sum(abs(each - found) < 2e-6 for each in printed) == 2


REFUSED = [
    ("--particles 200", 2, "slabs of 200 particles"),
    ("--particles 1000000000000", 2, "GiB of memory or more"),
    ("--voxels 8", 2, "--voxels: no option of method dem"),
    ("--method fftt", 2, "--method fftt: no such method; did you mean 'fft'"),
    ("--method multipole", 1, "--method multipole: not on ranks, as are dem, fem, fft"),
    ("--method fft-links", 1, "rule 'links': fft on ranks solves"),
    ("--method fft --voxels 1290", 2, "GiB of memory or more"),
]


@pytest.mark.parametrize(
    ("words", "status", "told"), REFUSED[:2] + [pytest.param(*each, marks=pytest.mark.slow) for each in REFUSED[2:]]
)
def test_what_cannot_be_done_is_refused_in_one_line(folder, words, status, told):
    done = ran(f"mpiexec -n 2 python -m demheat.mpi scene.toml {words}", folder, NEEDED.get(method_of(words), ()))
    lines = [line for line in done.stderr.splitlines() if line.startswith("demheat: ")]
    assert done.returncode == status and len(lines) == 1 and told in lines[0]
