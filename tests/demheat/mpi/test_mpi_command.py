"""The command on two ranks where MPI and PETSc are installed, and one line where they are not."""

import os
import re
import shlex
import subprocess
import sys
from importlib.util import find_spec

import pytest
from blocks import DOCS

from demheat import files, gallery, solve
from demheat.mpi.__main__ import main

# Debian's petsc4py is found where PYTHONPATH names it, see the page.
HERE = find_spec("mpi4py") is not None and find_spec("petsc4py") is not None
PAGE = (DOCS / "mpi.md").read_text(encoding="utf-8")
# Any user, on any number of cores; waiting ranks leave them to others.
FREE = {
    **dict.fromkeys(("OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"), "1"),
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_mpi_yield_when_idle": "1",
}
PARTICLES = 4000


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


@pytest.mark.skipif(not HERE, reason="needs mpi4py and petsc4py")
def test_the_commands_of_the_page_give_what_one_process_gives(folder):
    commands = [line for line in PAGE.splitlines() if line.startswith("mpiexec ")]
    assert len(commands) >= 2
    scene = files.read(folder / "scene.toml")
    for command in commands:
        command = re.sub(r"--particles \d+", f"--particles {PARTICLES}", command) + " --tolerance 1e-11"
        done = ran(command, folder)
        assert done.returncode == 0, done.stderr
        found = float(re.search(r"conductivity +(\S+)", done.stdout)[1])
        # Rounding, and what is left of either's residual.
        assert found == pytest.approx(solve(scene, particles=PARTICLES, tolerance=1e-11).conductivity, rel=1e-9)
        assert re.search(r"\d+ bytes an unknown", done.stdout)


@pytest.mark.skipif(not HERE, reason="needs mpi4py and petsc4py")
@pytest.mark.parametrize(
    ("words", "status", "told"),
    [("--particles 200", 2, "slabs of 200 particles"), ("--particles 1000000000000", 2, "GiB of memory or more")],
)
def test_what_cannot_be_done_is_refused_in_one_line(folder, words, status, told):
    done = ran(f"mpiexec -n 2 python -m demheat.mpi scene.toml {words}", folder)
    lines = [line for line in done.stderr.splitlines() if line.startswith("demheat: ")]
    assert done.returncode == status and len(lines) == 1 and told in lines[0]
