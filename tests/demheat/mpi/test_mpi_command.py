"""The command on two ranks where MPI and PETSc are installed, and one line where they are not."""

import os
import re
import shlex
import subprocess
import sys
from importlib.util import find_spec

import pytest
from blocks import DOCS

from demheat import Material, Scene, Sphere, files, gallery, solve
from demheat.mpi.__main__ import main
from references import fem, fft

# Debian's petsc4py is found where PYTHONPATH names it, see the page.
HERE = find_spec("mpi4py") is not None and find_spec("petsc4py") is not None
PAGE = (DOCS / "mpi.md").read_text(encoding="utf-8")
# Any user, on any number of cores; waiting ranks leave them to others.
FREE = {
    **dict.fromkeys(("OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"), "1"),
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_mpi_yield_when_idle": "1",
}
FFT = HERE and find_spec("mpi4py_fft") is not None
NEEDS_FFT = pytest.mark.skipif(not FFT, reason="needs mpi4py-fft")
# In place of what the page has, so that it does not take long; and what one process finds then.
SMALL = {"particles": 4000, "voxels": 21, "size": 0.025}
ALONE = {
    "dem": lambda scene, tolerance: solve(scene, particles=SMALL["particles"], tolerance=tolerance),
    "fft": lambda scene, tolerance: fft.solve(scene, voxels=SMALL["voxels"], rule="laminate", tolerance=tolerance),
    "fem": lambda scene, tolerance: fem.solve(scene, size=SMALL["size"], tolerance=tolerance),
}
SPHERE = [Sphere((0.4, 0.1, 0.6), 0.35, Material(0.2))]
CELL = Scene((1.0, 1.3, 0.9), Material(2.0), SPHERE, gradient=(0.0, 0.0, 1.0))


def ran(command, folder):
    words = shlex.split(command.replace(" python ", f" {sys.executable} ", 1))
    return subprocess.run(words, cwd=folder, capture_output=True, text=True, env={**os.environ, **FREE})


@pytest.fixture
def folder(tmp_path):
    files.write(gallery.sphere_in_cube(5.0), tmp_path / "scene.toml")
    return tmp_path


def test_without_mpi_one_line_says_what_is_missing(folder, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "mpi4py.MPI", None)
    assert main([str(folder / "scene.toml")]) == 1
    told = capsys.readouterr()
    assert told.out == "" and told.err.count("\n") == 1
    assert told.err.startswith("demheat: demheat.mpi needs mpi4py and petsc4py, which this Python does not find")


def test_an_unknown_option_is_one_line(capsys):
    assert main(["scene.toml", "--particle", "5"]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def small(command):
    for name, value in SMALL.items():
        command = re.sub(rf"--{name} \S+", f"--{name} {value}", command)
    return command


def conductivity(done):
    assert done.returncode == 0, done.stderr
    assert re.search(r"\d+ bytes an unknown", done.stdout)
    return float(re.search(r"conductivity +(\S+)", done.stdout)[1])


@pytest.mark.skipif(not HERE, reason="needs mpi4py and petsc4py")
@pytest.mark.parametrize("method", ["dem", "fem", pytest.param("fft", marks=NEEDS_FFT)])
def test_the_commands_of_the_page_give_what_one_process_gives(method, folder):
    lines = [line for line in PAGE.splitlines() if line.startswith("mpiexec ")]
    commands = [line for line in lines if (re.search(r"--method (\w+)", line) or ["", "dem"])[1] == method]
    assert commands
    alone = ALONE[method](files.read(folder / "scene.toml"), 1e-11)
    for command in commands:
        done = ran(small(command) + " --tolerance 1e-11", folder)
        # Rounding, and what is left of either's residual.
        assert conductivity(done) == pytest.approx(alone.conductivity, rel=1e-9)
        if method == "fft":
            # Only they show what preconditions; rounding may make one more.
            assert abs(int(re.search(r"(\d+) iterations", done.stdout)[1]) - alone.stats["iterations"]) <= 1


@pytest.mark.skipif(not HERE, reason="needs mpi4py and petsc4py")
@pytest.mark.parametrize("method", ["fem", pytest.param("fft", marks=NEEDS_FFT)])
def test_periodic_cells_give_what_one_process_gives(method, tmp_path):
    files.write(CELL, tmp_path / "cell.toml")
    words = {"fft": "--method fft --voxels 21", "fem": "--method fem --size 0.3"}[method]
    words += " --tolerance 1e-11 --at 0.31 0.77 0.2"
    done = ran(f"mpiexec -n 2 python -m demheat.mpi cell.toml {words}", tmp_path)
    knobs = {"fft": {"voxels": 21, "rule": "laminate"}, "fem": {"size": 0.3}}[method]
    alone = {"fft": fft, "fem": fem}[method].solve(files.read(tmp_path / "cell.toml"), tolerance=1e-11, **knobs)
    assert conductivity(done) == pytest.approx(alone.conductivity, rel=1e-9)
    if method == "fft":
        # Only they show what preconditions; rounding may make one more.
        assert abs(int(re.search(r"(\d+) iterations", done.stdout)[1]) - alone.stats["iterations"]) <= 1
    # Printed with nine digits.
    temperature = float(re.search(r"temperature +(\S+)", done.stdout)[1])
    assert temperature == pytest.approx(alone.temperature_at((0.31, 0.77, 0.2)), rel=1e-8)


@pytest.mark.skipif(not HERE, reason="needs mpi4py and petsc4py")
@pytest.mark.parametrize(
    ("words", "status", "told"),
    [
        ("--particles 200", 2, "slabs of 200 particles"),
        ("--particles 1000000000000", 2, "GiB of memory or more"),
        ("--voxels 8", 2, "--voxels: no option of method dem"),
        ("--method fftt", 2, "--method fftt: no such method; did you mean 'fft'"),
        ("--method multipole", 1, "--method multipole: not on ranks, as are dem, fem, fft"),
        pytest.param("--method fft-links", 1, "rule 'links': fft on ranks solves", marks=NEEDS_FFT),
        pytest.param("--method fft --voxels 1290", 2, "GiB of memory or more", marks=NEEDS_FFT),
    ],
)
def test_what_cannot_be_done_is_refused_in_one_line(folder, words, status, told):
    done = ran(f"mpiexec -n 2 python -m demheat.mpi scene.toml {words}", folder)
    lines = [line for line in done.stderr.splitlines() if line.startswith("demheat: ")]
    assert done.returncode == status and len(lines) == 1 and told in lines[0]
