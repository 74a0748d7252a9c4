"""The front page: its table is the one that the rows give, its links lead somewhere, its example works, it is short."""

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
    targets = re.findall(r"\]\(([^)#]+)(?:#[\w-]+)?\)", PAGE)
    assert targets and all((ROOT / target).exists() for target in targets)


def test_headings_that_links_name_are_there():
    for page, heading in re.findall(r"\]\(([^)#]+)#([\w-]+)\)", PAGE):
        titles = re.findall(r"^#+ (.*)$", (ROOT / page).read_text(encoding="utf-8"), re.MULTILINE)
        assert heading in [re.sub(r"[^\w -]", "", title).lower().replace(" ", "-") for title in titles]


def test_it_is_one_page():
    # Two screens: what is longer belongs into docs/.
    assert len(PAGE.splitlines()) < 100


def test_the_verdict_is_that_of_the_rows():
    """Numbers in words: how often the DEM is the cheapest to 0.1 %, on whose bodies, and where none gets there."""
    from studies.harness import runner
    from studies.harness.table import read_frame
    from studies.speed_error import means
    from studies.speed_error.scenes import TUNED

    df = read_frame(runner.load("speed_error"), ROOT / "results" / "speed_error.csv")
    found = means.beside_dem(df, 0.1)
    every = {scene for factors in found.values() for scene in factors}
    wins, losses = ({scene: f"{factor:.2g}" for scene, factor in found[kind].items()} for kind in ("wins", "losses"))
    assert len(wins) == 8 and "at least cost on eight: one sphere of a sixth of the cube at four contrasts" in PAGE
    thirds = sorted(float(factor) for scene, factor in wins.items() if scene.startswith("third"))
    assert len(thirds) == 4 and f"the next costs {thirds[0]:g} to {thirds[-1]:g} times as much" in PAGE
    assert f"24 unequal spheres ({wins['polydisperse']} times), 83 equal ones ({wins['83 spheres']} times)" in PAGE
    assert wins["1000 spheres"] == "inf" and "1000, where no other gets there" in PAGE
    assert f"a slab in time ({wins['slab']} times)" in PAGE
    assert set(found["ties"]) == {"laminate", "beam"} and "It ties on layers and on a beam in time" in PAGE
    assert set(losses) == {"half", "half at 100", "thin shell"}
    assert (
        f"{losses['half']} times the FFT at contrast 10, {losses['half at 100']} times finite elements at 100" in PAGE
    )
    assert f"a thin coat ({losses['thin shell']} times linear elements)" in PAGE
    assert set(df["scene"].dropna()) - every == {"ball"} and "on a ball in time nothing gets there" in PAGE
    assert set(wins) - set(TUNED) == {"1000 spheres", "slab"} and "Six of the eight are bodies" in PAGE


def test_the_example_runs():
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    names = {}
    code = code.replace("100_000", "1_000").replace("fem.solve(scene)", "fem.solve(scene, size=0.02)")
    exec(code.replace("fft.solve(scene)", "fft.solve(scene, voxels=32)"), names)
    # The exact value at contrast 5; 1000 particles err by 0.2 %.
    assert_allclose(names["field"].conductivity, 42.6403350747, rtol=5e-3)
    for name in re.findall(r"# DEM; (.*), \.\.\.", code)[0].split(", "):
        assert hasattr(names["field"], name)
