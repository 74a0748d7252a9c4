"""The front page: its table is the one that the rows give, its commands and its example work."""

import re
from pathlib import Path

import pytest
from numpy.testing import assert_allclose

from studies.harness.readme import MARKED, filled

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "README.md").read_text(encoding="utf-8")


def test_table_is_that_of_the_committed_rows():
    assert MARKED.search(PAGE)
    assert filled(PAGE, ROOT / "results") == PAGE


def test_a_table_without_rows_is_refused(tmp_path):
    with pytest.raises(ValueError, match="run the study first"):
        filled(PAGE, tmp_path)


def test_links_lead_somewhere():
    targets = re.findall(r"\]\(([^)#]+)\)", PAGE)
    assert targets and all((ROOT / target).exists() for target in targets)


def _block(word):
    """The example in which a word stands."""
    return next(code for code in re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL) if word in code)


@pytest.fixture(scope="module")
def first():
    """Names that the first example makes: those after it go on with them."""
    names = {}
    exec(_block("import numpy").replace("100_000", "1_000"), names)
    return names


def test_the_example_runs(first):
    # The exact value at contrast 5; 1000 particles err by 0.2 %.
    assert_allclose(first["field"].conductivity, 42.6403350747, rtol=5e-3)
    assert first["field"].flux_at(first["points"]).shape == (2, 3)


def test_the_example_of_fluxes_runs(first):
    names = dict(first)
    exec(_block("halo_flux"), names)
    smooth = names["halo_flux"](names["field"], ratio=2.0)
    # As many as particles, twins at the interface included; halos of two radii calm the flux.
    assert smooth.shape == names["field"].samples.flux.shape
    assert smooth.std(axis=0).max() < names["field"].samples.flux.std(axis=0).max()


def test_the_example_of_estimates_runs(first, capsys):
    names = dict(first)
    exec(_block("effective("), names)
    # The exact value, as above; by symmetry that along all axes.
    assert names["field"].error.lower < 42.6403350747 < names["field"].error.upper
    assert_allclose(names["found"].tensor.diagonal(), 42.6403350747, rtol=1e-9)
    assert "exact: about 0 CPU-s" in capsys.readouterr().out


def test_the_example_of_bounds_runs(first):
    names = dict(first)
    exec(_block("bracket.solve("), names)
    # The exact value, as above.
    assert names["found"].lower < 42.6403350747 < names["found"].upper
    assert names["found"].width <= 1e-3


def test_the_example_of_many_inclusions_runs():
    names = {}
    exec(_block("import numpy").split("scene =")[0], names)
    code = _block("dispersion_scene").replace("fraction=0.2", "fraction=0.05").replace("0.2, zeta2", "0.05, zeta2")
    # Solving by all methods is others' work; the witness alone says that the scene is right.
    exec("\n".join(line for line in code.splitlines() if "fem.solve" not in line), names)
    low, high = names["bounds"].third_order(0.195, 1.5, 0.05, names["zeta2"])
    # One axis of one cell of 21 spheres: it scatters more than these bounds are apart.
    assert low * 0.98 < names["multipole"].solve(names["scene"]).conductivity < high * 1.02
    assert len(names["boxed"].inclusions) == len(names["scene"].inclusions) == 21


def test_the_example_in_time_runs(capsys):
    names = {}
    exec(_block("evolve").replace("20_000", "2_000"), names)
    assert len(capsys.readouterr().out.splitlines()) == 3
    # Found 0.74 K off at the centre with 1000 particles and 0.27 K with 4000, at 10 s.
    assert_allclose(names["field"].temperature_at(names["center"]), names["right"][-1], atol=1.0)


def test_the_packing_example_runs(tmp_path, monkeypatch):
    code = _block("demheat.packing.lsa").replace("10_000", "1_000").replace("3_000", "500")
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(code, names)
    # Jammed between walls: fewer spheres fit than the 0.655 of a periodic cell.
    assert names["drum"].number == 500 and 0.55 < names["drum"].phi < 0.63
    assert_allclose(names["packing"].phi, 0.64, rtol=1e-12)  # rounding of a sum of 1000 cubes
    again = names["io"].read("packing.dump")
    assert_allclose(again.centers, names["packing"].centers, rtol=0, atol=0)
