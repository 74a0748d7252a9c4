"""A study small enough to break on purpose."""

import sys
from types import SimpleNamespace

import pytest

from studies.__main__ import main
from studies.harness import quiet, runner, store

TINY = '''
"""A tiny study.

Text below the title.
"""
import os, time
CASES = [{"name": "plain", "x": 1.5}, {"name": "second", "x": 2.0}, *EXTRA]
TIMEOUT = 60.0
REPEATS = 1

def QUICK(case):
    return case["x"] < 2

def warm_up(name, x):
    _log("warm " + name)

def run(name, x):
    _log("run " + name)
    if name == "refuses":
        raise NotImplementedError("not for x = 3")
    if name == "raises":
        raise RuntimeError("no convergence\\nafter 7 iterations")
    if name == "dies":
        os.abort()
    if name == "sleeps":
        time.sleep(60)
    if name == "slow":
        time.sleep(0.3)
    return {"square": x * x, "layer": os.environ["NUMBA_THREADING_LAYER"], "spin": os.environ["OMP_WAIT_POLICY"]}

def _log(word):
    with open(os.environ["TINY_LOG"], "a") as file:
        file.write(word + "\\n")

def claims(df):
    yield "squares are small", df["square"].max(), LIMIT

def plot(df):
    from matplotlib import pyplot
    figure, axes = pyplot.subplots()
    axes.plot(df["x"], df["square"])
    return figure
'''


@pytest.fixture
def tiny(tmp_path, monkeypatch):
    """Make a tiny study of its own name; returns the things a test asks about it."""
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.setenv("TINY_LOG", str(tmp_path / "log"))
    monkeypatch.syspath_prepend(tmp_path)
    # Nobody else is there: what tests run beside each other does not count.
    monkeypatch.setattr(quiet, "look", lambda: (12.5, 0.0))
    name = f"tiny_{tmp_path.name}"
    file, out = tmp_path / f"{name}.py", tmp_path / "out"

    def write(extra="", limit=100, **changes):
        text = TINY.replace("*EXTRA", extra).replace("LIMIT", repr(limit))
        for old, new in changes.items():
            assert old in text
            text = text.replace(old, new)
        file.write_text(text)
        sys.modules.pop(name, None)

    def run(*options):
        (tmp_path / "log").write_text("")
        return main(["run", name, "--out", str(out), "--wait", "0", *options])

    def ran(**options):
        """Bring the rows up to date, without a page or figure, and say which were run."""
        (tmp_path / "log").write_text("")
        runner.run_study(name, out, say=lambda line: None, **options)
        return [line[4:] for line in (tmp_path / "log").read_text().split("\n") if line.startswith("run")]

    def made(**options):
        """The same with rows of this process, without their costs: fast."""
        for variable in ("NUMBA_THREADING_LAYER", "OMP_WAIT_POLICY"):
            monkeypatch.setenv(variable, "")
        return ran(compute=lambda name, study, case: runner.compute_row(study, case, warm=False), **options)

    def rows():
        return store.read_rows(out / f"{name}.csv")

    write()
    return SimpleNamespace(name=name, file=file, out=out, write=write, run=run, ran=ran, made=made, rows=rows)
