"""The page on clusters: its commands run where Dask is installed, its function everywhere."""

import os
import subprocess
import sys

import pytest
from blocks import DOCS, blocks, check_alike

from studies.harness.store import read_rows

ROOT = DOCS.parent
PAGE = blocks("cluster.md")
COMMANDS = [line for block in PAGE if block.kind == "sh" for line in block.text.splitlines()]


@pytest.fixture
def shell(tmp_path):
    """Run a line of the page in a folder of its own, with this Python."""
    (tmp_path / "bin").mkdir()
    # A link would be a Python without its packages.
    (tmp_path / "bin" / "python").write_text(f'#!/bin/sh\nexec {sys.executable} "$@"\n')
    (tmp_path / "bin" / "python").chmod(0o755)
    paths = {"PATH": f"{tmp_path / 'bin'}:{os.environ['PATH']}", "PYTHONPATH": str(ROOT)}

    def run(line, status=0):
        done = subprocess.run(line, shell=True, cwd=tmp_path, env=os.environ | paths, capture_output=True, text=True)
        assert done.returncode == status and "WARNING" not in done.stderr, done.stderr
        return done.stdout

    return run


def test_a_study_on_two_workers(shell, tmp_path):
    pytest.importorskip("distributed")
    (line,) = (each for each in COMMANDS if "--workers" in each)
    assert "dashboard http" in shell(line)
    rows = read_rows(tmp_path / "out" / "fig05_slab.csv")
    assert len(rows) == 5 and {row["status"] for row in rows.values()} == {"ok"}


@pytest.mark.slow
def test_jobs_of_a_batch_system(shell, tmp_path):
    jobs, first, gather, render = (each for each in COMMANDS if "pip" not in each and "--workers" not in each)
    shell(jobs)
    assert len((tmp_path / "jobs.txt").read_text().splitlines()) == 5
    shell(first)
    assert "1 rows added" in shell(gather)
    # One row is too few for the claims, and the status says so.
    assert "rows: 1 of 25 cases; 1 ok" in shell(render, status=1)
    # What a node of the array runs.
    shell("SLURM_ARRAY_TASK_ID=2; " + _wrapped())
    assert "2 rows added" in shell(gather)
    assert len(shell(jobs.split(" > ")[0]).splitlines()) == 3


def _wrapped():
    """The command that the page gives to sbatch."""
    (line,) = (each for each in (DOCS / "cluster.md").read_text().splitlines() if each.startswith("sbatch"))
    return line.partition("--wrap '")[2].rstrip("'")


def test_the_function_of_a_page(tmp_path, monkeypatch, capsys):
    (block,) = (each for each in PAGE if each.kind == "python")
    monkeypatch.chdir(tmp_path)
    for _ in range(2):
        exec(block.text, {})
        check_alike(capsys.readouterr().out, block.printed)
    assert len((tmp_path / "rows.csv").read_text().splitlines()) == 3


def test_the_extra_is_called_as_the_page_says():
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert "\ndistributed = [" in text and any("demheat[distributed]" in each for each in COMMANDS)
