"""Scripts and notebooks of `examples/`: each runs without a warning, is short, and prints what a reader can check."""

import json
import re
import runpy
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[1] / "examples"
SCRIPTS = sorted(FOLDER.glob("*.py"))
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
PAGE = (FOLDER.parent / "docs" / "examples.md").read_text(encoding="utf-8")


def _numbers(line):
    return [float(each) for each in re.findall(r"-?\d+\.?\d*(?:e[+-]?\d+)?", line)]


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    """Run a script in a folder of its own, and say what it printed."""

    def of(name):
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(sys, "argv", [name])
        runpy.run_path(str(FOLDER / name), run_name="__main__")
        return capsys.readouterr().out.splitlines()

    return of


@pytest.mark.slow
def test_own_composite(run):
    lines = run("own_composite.py")
    assert sum(_numbers(lines[0])) == pytest.approx(1.0, abs=2e-3)  # three digits each
    low, high = _numbers(lines[1])
    found = [_numbers(line)[-1] for line in lines[2:5]]
    assert all(low < k < high for k in found)
    # The DEM errs by a per cent here, at contrasts up to two thousand.
    assert max(found) / min(found) < 1.02


@pytest.mark.slow
def test_speed_against_error(run):
    lines = run("speed_against_error.py")[2:-1]
    errors = {name: [abs(float(line.split()[4])) for line in lines if line.startswith(name)] for name in ("DEM", "FFT")}
    # Coarse to fine: these two fall each time on this scene.
    assert all(each == sorted(each, reverse=True) and len(each) == 3 for each in errors.values())
    assert len(lines) == 9


def test_certain_bracket(run):
    lines = run("certain_bracket.py")
    bounds = [_numbers(line)[:2] for line in lines[:2]]
    assert all(low < high for low, high in bounds)
    # Certain: none lies beside another.
    assert max(low for low, _ in bounds) < min(high for _, high in bounds)
    low, high = bounds[-1]
    for line in lines[2:4]:
        # What a method expects of itself meets what is certain.
        _, expected_low, expected_high = _numbers(line)
        assert expected_low < high and expected_high > low


def test_transient_cooling(run):
    for line in run("transient_cooling.py")[1:-1]:
        _, dem, exact, out, held = _numbers(line)
        # Of a drop of 180 K: one per cent is what 5000 particles leave.
        assert abs(dem - exact) < 1.8 and 0 < out < held


def test_interface_resistance(run):
    lines = run("interface_resistance.py")[1:-1]
    ratios = [_numbers(line)[1:] for line in lines]
    assert [each[0] for each in ratios] == sorted((each[0] for each in ratios), reverse=True)
    assert all(abs(k - each[0]) < 3e-3 * each[0] for each in ratios for k in each[1:])
    # Neutral: exactly the matrix.
    assert _numbers(lines[3])[:2] == [0.9, 1.0]


def test_packing_to_network(run, tmp_path):
    lines = run("packing_to_network.py")
    assert (tmp_path / "network.vtp").stat().st_size > 1000
    assert _numbers(lines[2])[1] == 1.0  # what C_t is for


def test_settled_bed(run, tmp_path):
    k, bottom, top = (_numbers(part)[0] for part in re.split(r"'z[-+]':", run("settled_bed.py")[0]))
    # Steel in air: above the air, far below the steel. The solver's tolerance is 1e-10 of the heat that passes.
    assert 0.026 < k < 16.0 and abs(bottom + top) < 1e-8 * bottom
    rows = (tmp_path / "settled_bed_flows.csv").read_text(encoding="utf-8").splitlines()
    assert len(rows) > 120


def test_every_script_is_run_here_short_and_on_the_page():
    text = Path(__file__).read_text(encoding="utf-8")
    assert len(SCRIPTS) == 7 and len(NOTEBOOKS) == 2
    for path in SCRIPTS:
        assert f'run("{path.name}")' in text and path.name in PAGE
        lines = path.read_text(encoding="utf-8").splitlines()
        assert len(lines) <= 40 and f"python examples/{path.name}" in lines[2]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path, monkeypatch, tmp_path, capsys):
    """Its code cells, one after the other in one namespace: they are plain Python, and need no kernel for that."""
    import matplotlib

    monkeypatch.chdir(tmp_path)
    matplotlib.use("Agg")
    from matplotlib import pyplot

    names = {}
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), names)
    pyplot.close("all")
    printed = capsys.readouterr().out
    if path.stem == "first_look":
        assert _numbers(printed.splitlines()[-1])[0] < 1.0
    else:
        off = [_numbers(line)[-1] for line in printed.splitlines()[:3]]
        # Beside the interface cells do better than a halo, which is what the notebook says.
        assert off[0] == 0 and 0 < off[1] < off[2] / 2


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_committed_without_outputs(path):
    book = json.loads(path.read_text(encoding="utf-8"))
    assert (book["nbformat"], book["nbformat_minor"]) == (4, 5)
    ids = [cell["id"] for cell in book["cells"]]
    assert len(set(ids)) == len(ids) and path.name in PAGE
    for cell in book["cells"]:
        if cell["cell_type"] == "code":
            assert cell["outputs"] == [] and cell["execution_count"] is None
            assert not re.search(r"^[%!]", "".join(cell["source"]), re.MULTILINE)
