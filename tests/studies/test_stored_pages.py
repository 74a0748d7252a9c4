"""Only here: tables, notes and claims that the code of a study makes otherwise of the stored rows than its page says.

What studies make of their rows (means, orders, fits, verdicts, sentences) has no tests of its own on rows that are made
up: whatever changes there changes a page. After a change that is meant: `python -m studies report --out results`.
"""

import pytest

from studies.__main__ import study_names
from studies.harness import provenance, runner, table
from studies.harness.claims import judged

STORED = provenance.ROOT / "results"


@pytest.mark.parametrize("name", study_names())
def test_a_page_says_what_the_code_makes_of_its_rows(name):
    study, path = runner.load(name), STORED / f"{name}.csv"
    rows = table.read_frame(study, path)
    found = table.page(study, rows, judged(study, rows), path.with_suffix(".png"))
    said = path.with_suffix(".md").read_text(encoding="utf-8")
    assert found.partition(table.ORIGIN)[0].splitlines() == said.partition(table.ORIGIN)[0].splitlines()
