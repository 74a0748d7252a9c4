"""The front page: its table is the one that the rows give, its commands and its example work."""

import re
from pathlib import Path

import pytest
from numpy.testing import assert_allclose

from studies.readme import MARKED, filled

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


def test_the_example_runs():
    code = re.search(r"```python\n(.*?)```", PAGE, re.DOTALL)[1].replace("100_000", "1_000")
    names = {}
    exec(code, names)
    # The exact value at contrast 5; 1000 particles err by 0.2 %.
    assert_allclose(names["field"].conductivity, 42.640335234, rtol=5e-3)
    assert names["field"].flux_at(names["points"]).shape == (2, 3)
