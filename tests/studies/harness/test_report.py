"""The report: one page that needs no other file, and a short one that leads to those of the studies."""

import re
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace

import pytest

from studies import contents
from studies.__main__ import main, study_names
from studies.harness import store

RESULTS = Path(__file__).parents[3] / "results"
VOID = {"meta", "img", "br", "hr", "link", "input"}


class Page(HTMLParser):
    """Tags of a page, with what they load, whose ends must be where they belong."""

    def __init__(self, text):
        super().__init__()
        self.stack, self.tags, self.text = [], [], ""
        self.feed(text)
        self.close()
        assert self.stack == []

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.stack.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)

    def handle_endtag(self, tag):
        assert self.stack.pop() == tag

    def handle_data(self, data):
        self.text += data

    def attributes(self, tag, name):
        return [attrs[name] for each, attrs in self.tags if each == tag and name in attrs]


@pytest.fixture
def reported(tiny, monkeypatch):
    """A folder with one study whose page has what pages have; `report` writes it and gives the status."""
    tiny.write(
        **{
            "A tiny study.": "A tiny study of <b>tags</b> & more.",
            "Text below the title.": "Text with `code`, a [link](../docs/studies.md) and <script>alert(1)</script>.",
            'yield "squares are small"': 'yield "ninth < tenth", 1.0, 2.0\n    yield "squares are small"',
        }
    )
    tiny.made()
    monkeypatch.setattr("studies.__main__.study_names", lambda: [tiny.name, "brackets"])
    first = ((tiny.name, "squares are"), (tiny.name, "no such"), ("brackets", "Median"))
    chosen = SimpleNamespace(
        HEADLINES=first,
        FIGURES=(("Paper & al.", "Fig. 1", tiny.name, ("squares",)), ("Paper", "2", "brackets", ("Median",))),
    )
    monkeypatch.setattr("studies.__main__.contents", chosen)
    tiny.report = lambda *words: main(["report", "--out", str(tiny.out), *words])
    return tiny


def test_one_page_with_everything_in_it(reported, capsys):
    assert reported.report() == 0
    text = (reported.out / "index.html").read_text(encoding="utf-8")
    page = Page(text)
    # Nothing is loaded from elsewhere: the picture is in it, nor is anything of the rows taken for a tag.
    assert [src[:22] for src in page.attributes("img", "src")] == ["data:image/png;base64,"]
    assert not {"link", "iframe", "object"} & {tag for tag, _ in page.tags} and not re.search(r"url\(|@import", text)
    assert page.attributes("script", "src") == [] and "alert(1)" not in re.findall(
        r"<script>(.*?)</script>", text, re.S
    )
    assert "<b>tags" not in text and "A tiny study of <b>tags</b> & more." in page.text
    assert page.attributes("meta", "content") == ["width=device-width, initial-scale=1"]
    # Each study folded, where its links lead; tables scroll by themselves.
    assert page.attributes("details", "id") == [reported.name]
    links = [href for href in page.attributes("a", "href") if href.startswith("#")]
    assert set(links) - {"#brackets"} == {"#first", "#figures", "#all", f"#{reported.name}"}
    assert text.count("<table>") == text.count('<div class="scroll"><table>') == 2
    assert "2 rows: 2 dirty" in page.text and "commit" in page.text
    said = capsys.readouterr().out
    assert "index.html; 2 rows: 2 dirty, " in said and "3 claims: no claim failed, 0 not judged" in said


def test_headlines_are_those_of_the_claims(reported):
    reported.report()
    short = (reported.out / "README.md").read_text(encoding="utf-8")
    assert f"| ok | squares are small | 4 | <= 100 | [{reported.name}]({reported.name}.md) |" in short
    assert "| not judged | no such | nan |" in short and "| not judged | Median | nan |" in short
    page = Page((reported.out / "index.html").read_text(encoding="utf-8"))
    assert "ok squares are small: 4limit <= 100; " in page.text and "no claims with these words" in page.text
    assert len(short.splitlines()) < 60 and f"[{reported.name}]({reported.name}.md) | A tiny" in short


def test_a_claim_that_failed_fails_the_report(reported, capsys):
    reported.write(limit=3)
    assert reported.report() == 1
    assert "a claim FAILED" in capsys.readouterr().out
    text = (reported.out / "index.html").read_text(encoding="utf-8")
    assert '<td class="fail">FAIL</td>' in text and '<span class="fail">FAIL</span> squares are' in text


def test_rows_that_cannot_be_read_spoil_no_other_study(reported, capsys):
    for text in ("no rows", "case,status\n", "case,status\na,ok\n"):
        (reported.out / "brackets.csv").write_text(text)
        assert reported.report() == 1
        assert "brackets.csv" in capsys.readouterr().err
        page = Page((reported.out / "index.html").read_text(encoding="utf-8"))
        assert page.attributes("details", "id") == [reported.name, "brackets"] and "brackets.csv: " in page.text


def test_an_empty_folder_is_said_in_a_line(tmp_path, capsys):
    for folder in (tmp_path, tmp_path / "none"):
        assert main(["report", "--out", str(folder)]) == 2
        said = capsys.readouterr().err
        assert f"no results in {folder}; run a study first" in said and said.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_a_run_that_has_not_ended(reported, capsys):
    path = reported.out / f"{reported.name}.csv"
    reported.write('{"name": "more", "x": 3.0}', **{'df["square"].max()': 'df.iloc[2]["square"]'})
    assert reported.report() == 0
    assert "1 not judged" in capsys.readouterr().out
    text = (reported.out / "index.html").read_text(encoding="utf-8")
    assert '<td class="open">not judged</td>' in text and "rows: 2 of 3 cases" in text
    store.write_rows(path, [])
    path.write_text("case\n")
    assert reported.report() == 1


def test_the_contents_name_what_is_there():
    names = study_names()
    assert len(contents.HEADLINES) == 10
    mapped = {name for _, _, name, _ in contents.FIGURES}
    assert {name for name, _ in contents.HEADLINES} | mapped <= set(names)
    assert {name for name in names if re.match(r"fig\d|table\d", name)} <= mapped


@pytest.mark.parametrize(("name", "words"), [each[2:] for each in contents.FIGURES if isinstance(each[3], tuple)])
def test_what_papers_print_is_asked_of_claims_that_there_are(name, words):
    claims = (RESULTS / f"{name}.md").read_text(encoding="utf-8").partition("## Claims")[2]
    assert words and [each for each in words if each not in claims] == []


def test_what_a_paper_prints_came_out_or_is_different(reported):
    reported.report()
    short = (reported.out / "README.md").read_text(encoding="utf-8")
    line = f"| Paper & al. | Fig. 1 | [{reported.name}]({reported.name}.md) |"
    assert f"{line} reproduced | squares are small | 4 | <= 100 |  |" in short and "| Paper | 2 |" not in short
    page = Page((reported.out / "index.html").read_text(encoding="utf-8"))
    assert "reproduced squares are small: 4 (<= 100)" in page.text
    reported.write(limit=3)
    reported.report()
    assert f"{line} different | squares" in (reported.out / "README.md").read_text(encoding="utf-8")


@pytest.mark.parametrize(("name", "words"), contents.HEADLINES)
def test_headlines_are_claims_of_the_stored_pages(name, words):
    page = (RESULTS / f"{name}.md").read_text(encoding="utf-8").partition("## Claims")[2]
    assert len([line for line in page.splitlines() if line.startswith("| ") and words in line]) == 1


def test_the_stored_page_leads_to_all_studies():
    page = (RESULTS / "README.md").read_text(encoding="utf-8")
    stored = {path.stem for path in RESULTS.glob("*.csv")}
    assert set(re.findall(r"\]\((\w+)\.md\)", page)) == stored
    targets = [target for target in re.findall(r"\]\(([^)#]+)\)", page) if target != "index.html"]
    assert targets and all((RESULTS / target).exists() for target in targets)
    leading, fails = page.split("## Claims that fail")
    beside = [line for line in fails.splitlines() if not line.startswith("| [")]
    printed = [line for line in leading.splitlines() if line.startswith(("| Haddad", "| Terreros"))]
    # As many lines as there are studies, as papers print numbers and as claims fail, and few besides.
    assert len(leading.splitlines()) + len(beside) < 45 + len(stored) + len(printed)
