"""The command on two ranks where MPI and PETSc are installed, and one line where they are not."""

import re
import shlex
import subprocess
import sys

import pytest
from blocks import DOCS, blocks

from demheat import files, gallery, solve
from demheat.mpi.__main__ import main
from studies.scaling import ranks

PAGE = (DOCS / "mpi.md").read_text(encoding="utf-8")
PARTICLES = 4000


def ran(command, folder):
    """Run a command of the page by the Python that has MPI and PETSc, this one or another."""
    if ranks.missing():
        pytest.skip(ranks.missing())
    words = shlex.split(command.replace(" python ", f" {ranks.python()} ", 1))
    return subprocess.run(words, cwd=folder, capture_output=True, text=True, env=ranks.environment())


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


COMMANDS = [line for line in PAGE.splitlines() if line.startswith("mpiexec ")]


def test_the_page_has_commands():
    assert len(COMMANDS) >= 3 and any("--petsc=" in command for command in COMMANDS)


# Some seconds each, most of it for two Pythons to begin.
SLOW = [pytest.param(each, marks=pytest.mark.slow) for each in COMMANDS[1:]]


@pytest.mark.parametrize("command", [*COMMANDS[:1], *SLOW])
def test_the_commands_of_the_page_give_what_one_process_gives(command, folder):
    scene = files.read(folder / "scene.toml")
    done = ran(re.sub(r"--particles \d+", f"--particles {PARTICLES}", command) + " --tolerance 1e-11", folder)
    assert done.returncode == 0, done.stderr
    found = float(re.search(r"conductivity +(\S+)", done.stdout)[1])
    # Rounding, and what is left of either's residual.
    assert found == pytest.approx(solve(scene, particles=PARTICLES, tolerance=1e-11).conductivity, rel=1e-9)
    assert re.search(r"\d+ bytes an unknown", done.stdout)


@pytest.mark.slow
def test_the_block_of_python_on_the_page(folder):
    """Run as a script on two ranks, smaller."""
    (block,) = (each for each in blocks("mpi.md") if each.kind == "python")
    (folder / "script.py").write_text(block.text.replace("1_000_000", str(PARTICLES)))
    done = ran("mpiexec -n 2 python script.py", folder)
    assert done.returncode == 0, done.stderr
    # Lines of two ranks may be mixed up.
    unknowns = solve(files.read(folder / "scene.toml"), particles=PARTICLES).stats["unknowns"]
    assert done.stdout.count(f" {unknowns}") == done.stdout.count("'y-': -42.6") == 2


@pytest.mark.parametrize(
    ("words", "status", "told"),
    [("--particles 200", 2, "slabs of 200 particles"), ("--particles 1000000000000", 2, "GiB of memory or more")],
)
def test_what_cannot_be_done_is_refused_in_one_line(folder, words, status, told):
    done = ran(f"mpiexec -n 2 python -m demheat.mpi scene.toml {words}", folder)
    lines = [line for line in done.stderr.splitlines() if line.startswith("demheat: ")]
    assert done.returncode == status and len(lines) == 1 and told in lines[0]
