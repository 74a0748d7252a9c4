"""The front page: its example works, headings that it names are there, it is short."""

import re
from pathlib import Path

import pytest
from numpy.testing import assert_allclose

from studies.harness.readme import MARKED, filled

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "README.md").read_text(encoding="utf-8")


def test_it_has_tables():
    assert MARKED.search(PAGE)


def test_a_table_without_rows_is_refused(tmp_path):
    with pytest.raises(ValueError, match="run the study first"):
        filled(PAGE, tmp_path)


def test_headings_that_links_name_are_there():
    for page, heading in re.findall(r"\]\(([^)#]+)#([\w-]+)\)", PAGE):
        titles = re.findall(r"^#+ (.*)$", (ROOT / page).read_text(encoding="utf-8"), re.MULTILINE)
        assert heading in [re.sub(r"[^\w -]", "", title).lower().replace(" ", "-") for title in titles]


def test_it_is_one_page():
    # Two screens: what is longer belongs into docs/.
    assert len(PAGE.splitlines()) < 100


def test_the_example_runs():
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    names = {}
    code = code.replace("100_000", "1_000").replace("fem.solve(scene)", "fem.solve(scene, size=0.02)")
    exec(code.replace("fft.solve(scene)", "fft.solve(scene, voxels=32)"), names)
    # The exact value at contrast 5; 1000 particles err by 0.2 %.
    assert_allclose(names["field"].conductivity, 42.6403350747, rtol=5e-3)
    for name in re.findall(r"# DEM; (.*), \.\.\.", code)[0].split(", "):
        assert hasattr(names["field"], name)
