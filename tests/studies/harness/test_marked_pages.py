"""Tables and sentences between marks in pages: whose they are, and that several pages are written by one command."""

import re
from pathlib import Path

import pytest

from studies.__main__ import _parser
from studies.harness.readme import fill, filled

RESULTS = Path(__file__).parents[3] / "results"
MARK = "Before.\n\n<!-- table fig14_single_inclusion{} -->\nold\n<!-- end of table -->\n\nAfter.\n"


def test_a_mark_names_a_function_of_a_study():
    short, whole = (filled(MARK.format(name), RESULTS) for name in (" headline", ""))
    assert "old" not in short + whole and short.startswith("Before.") and short.endswith("After.\n")
    # The front page asks for seven methods at their finest and for no memory; the study has all.
    assert short.count("\n|") == 2 + 7 < whole.count("\n|")
    assert "peak_mib" in whole and "peak_mib" not in short
    assert filled(short, RESULTS) == short


def test_a_sentence_stands_where_it_is_marked():
    page = "- cases: <!-- words hard_cases -->old<!-- end of words -->; <!-- words needs -->old<!-- end of words -->.\n"
    once = filled(page, RESULTS)
    assert "old" not in once and once.count("\n") == 1 and once.endswith("<!-- end of words -->.\n")
    assert re.match(r"- cases: <!-- words hard_cases -->\d+ cases of \d+ drawn scenes: ", once)
    assert filled(once, RESULTS) == once


def test_a_function_that_is_not_there_is_refused():
    with pytest.raises(ValueError, match="fig14_single_inclusion short -->: the study has no function short"):
        filled(MARK.format(" short"), RESULTS)


def test_one_command_writes_several_pages(tmp_path):
    pages = [tmp_path / name for name in ("one.md", "two.md")]
    for page in pages:
        page.write_text(MARK.format(" headline"), encoding="utf-8")
    told = _parser().parse_args(["report", "--page", *map(str, pages)])
    assert told.page == pages
    for page in told.page:
        fill(page, RESULTS)
    assert pages[0].read_text(encoding="utf-8") == pages[1].read_text(encoding="utf-8") != MARK.format(" headline")
