"""Pages of the manual beside the tutorial: their examples work, at sizes that cost next to nothing."""

import types

import pytest
from blocks import blocks
from numpy.testing import assert_allclose

# The conductivity of a sphere five times as conducting, of radius L/3, in a cube of 33 W/(m K): exact.
EXACT = 42.6403350747


def _block(page, word):
    """The example in which a word stands."""
    return next(block.text for block in blocks(page) if block.kind == "python" and word in block.text)


@pytest.fixture(scope="module")
def first():
    """Names that the first example on errors makes: those after it go on with them."""
    names = {}
    exec(_block("errors.md", "Scene(").replace("5_000", "1_000"), names)
    return names


def test_the_example_of_estimates_runs(first, capsys):
    names = dict(first)
    exec(_block("errors.md", "effective("), names)
    # By symmetry the exact value is that along all axes.
    assert names["field"].error.lower < EXACT < names["field"].error.upper
    assert_allclose(names["found"].tensor.diagonal(), EXACT, rtol=1e-9)
    assert "exact: about 0 CPU-s" in capsys.readouterr().out


def test_the_example_of_bounds_runs(first):
    names = dict(first)
    exec(_block("errors.md", "bracket.solve("), names)
    assert names["sure"].lower < EXACT < names["sure"].upper
    assert names["sure"].width <= 1e-3


def test_the_example_of_a_choice_runs(capsys):
    exec(_block("choose.md", "recommend("), {})
    assert "exact: about 0 CPU-s" in capsys.readouterr().out


def test_the_example_of_fluxes_runs():
    names = {}
    exec(_block("guide.md", "halo_flux").replace("100_000", "1_000"), names)
    smooth = names["halo_flux"](names["field"], ratio=2.0)
    # As many as particles, twins at the interface included; halos of two radii calm the flux.
    assert smooth.shape == names["field"].samples.flux.shape
    assert smooth.std(axis=0).max() < names["field"].samples.flux.std(axis=0).max()


def test_the_example_of_many_inclusions_runs():
    code = _block("guide.md", "dispersion_scene").replace("fraction=0.2", "fraction=0.05")
    code = code.replace("0.2, zeta2", "0.05, zeta2")
    names = {}
    # Solving by all methods is others' work; the witness alone says that the scene is right.
    exec("\n".join(line for line in code.splitlines() if "fem.solve" not in line), names)
    low, high = names["bounds"].third_order(0.195, 1.5, 0.05, names["zeta2"])
    # One axis of one cell of 21 spheres: it scatters more than these bounds are apart.
    assert low * 0.98 < names["multipole"].solve(names["scene"]).conductivity < high * 1.02
    assert len(names["boxed"].inclusions) == len(names["scene"].inclusions) == 21


def test_the_example_in_time_runs(capsys):
    names = {}
    exec(_block("guide.md", "evolve").replace("20_000", "2_000"), names)
    assert len(capsys.readouterr().out.splitlines()) == 3
    # Found 0.74 K off at the centre with 1000 particles and 0.27 K with 4000, at 10 s.
    assert_allclose(names["field"].temperature_at(names["center"]), names["right"][-1], atol=1.0)


def test_the_packing_example_runs(tmp_path, monkeypatch):
    code = _block("guide.md", "demheat.packing.lsa").replace("10_000", "1_000").replace("3_000", "500")
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(code, names)
    # Jammed between walls: fewer spheres fit than the 0.655 of a periodic cell.
    assert names["drum"].number == 500 and 0.55 < names["drum"].phi < 0.63
    assert_allclose(names["packing"].phi, 0.64, rtol=1e-12)  # rounding of a sum of 1000 cubes
    again = names["packings"].read("packing.dump")
    assert_allclose(again.centers, names["packing"].centers, rtol=0, atol=0)


def test_the_study_runs_and_its_claims_hold():
    pandas = pytest.importorskip("pandas")
    study = types.ModuleType("mine")
    exec(_block("studies.md", "CASES"), study.__dict__)
    quick = [case for case in study.CASES if study.QUICK(case)]
    assert 0 < len(quick) < len(study.CASES)
    df = pandas.DataFrame([case | study.run(**case) for case in quick])
    from studies.harness.claims import claim

    claims = [claim(*each) for each in study.claims(df)]
    assert len(claims) == 3 and all(each.ok for each in claims)
    assert len(study.table(df)) == len(quick)
    pyplot = pytest.importorskip("matplotlib.pyplot")
    pyplot.close(study.plot(df))


def test_the_scene_of_a_file_is_read(tmp_path):
    from demheat.io import scenes

    (text,) = (block.text for block in blocks("scenes.md") if block.kind == "toml")
    (tmp_path / "scene.toml").write_text(text, encoding="utf-8")
    (tmp_path / "beads.csv").write_text("x_mm,y_mm,z_mm,radius_mm\n0.5,0.5,0.5,0.2\n", encoding="utf-8")
    scene = scenes.read(tmp_path / "scene.toml")
    assert scene.size == (1e-3, 1e-3, 1e-3) and scene.conductivities.tolist() == [0.195, 1.05]
