"""The manual builds without a warning and without a network; its pages say what the stored tables say."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from blocks import DOCS

from studies.harness.readme import MARKED, filled

ROOT = DOCS.parent
PAGES = {path.relative_to(DOCS).as_posix(): path.read_text(encoding="utf-8") for path in sorted(DOCS.rglob("*.md"))}
# The front page leads into it and has tables, too.
READ = PAGES | {"../README.md": (ROOT / "README.md").read_text(encoding="utf-8")}
MARKED_PAGES = [name for name, text in READ.items() if MARKED.search(text)]


def _built(source, target):
    """Build a folder of pages, warnings being errors, in a process of its own: Sphinx changes the one it runs in."""
    pytest.importorskip("sphinx")
    pytest.importorskip("myst_parser")
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html", str(source), str(target)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True)


@pytest.fixture(scope="module")
def manual(tmp_path_factory):
    target = tmp_path_factory.mktemp("manual")
    done = _built(DOCS, target)
    assert done.returncode == 0, done.stderr
    return target


def test_every_page_is_built(manual):
    for name in PAGES:
        assert (manual / name).with_suffix(".html").exists(), name


def test_no_page_asks_for_a_network(manual):
    """Neither scripts, styles, fonts nor pictures come from elsewhere; a reader may follow links."""
    for path in manual.rglob("*.html"):
        text = path.read_text(encoding="utf-8")
        assert not re.findall(r"<(?:script|img|iframe)[^>]*src=\"(?:https?:)?//", text), path
        assert not re.findall(r"<link[^>]*href=\"(?:https?:)?//", text), path
    for path in manual.rglob("*.css"):
        assert not re.findall(r"(?:@import|url\()\s*[\"']?(?:https?:)?//", path.read_text(encoding="utf-8")), path


def test_equations_are_numbered_and_drawn_by_the_browser(manual):
    labels = re.findall(r"^\$\$ \((\w+)\)$", PAGES["theory.md"], re.MULTILINE)
    text = (manual / "theory.html").read_text(encoding="utf-8")
    numbers = [int(each) for each in re.findall(r'<span class="eqno">\((\d+)\)', text)]
    assert len(labels) > 25 and numbers == list(range(1, len(labels) + 1))
    assert text.count('display="block"') == len(labels)
    # What the converter does not know it hands on as it was.
    assert not re.findall(r"<m\w+>[^<]*\\[a-zA-Z]+", text)


@pytest.mark.parametrize("name", MARKED_PAGES)
def test_tables_are_those_of_the_stored_rows(name):
    assert filled(READ[name], ROOT / "results") == READ[name]


@pytest.mark.parametrize("name", READ)
def test_links_lead_somewhere(name):
    targets = re.findall(r"\]\(([^)#:]+)(?:#[\w-]+)?\)", READ[name])
    gone = [each for each in targets if not ((DOCS / name).parent / each).exists()]
    assert not gone, f"docs/{name} has links that lead nowhere: {', '.join(gone)}"


def test_every_study_is_named():
    from studies.__main__ import study_names

    missing = [name for name in study_names() if f"`{name}`" not in PAGES["results.md"]]
    assert not missing, f"the list of studies in docs/results.md wants a line of {', '.join(missing)}"


def test_folders_of_the_package_that_a_page_names_exist():
    named = {
        each for text in READ.values() for each in re.findall(r"`((?:demheat|references|studies|tests)/[\w/.]+)`", text)
    }
    # Names of recipes, which a reader makes.
    gone = [each for each in sorted(named) if "mine" not in each and not Path(ROOT, each).exists()]
    assert not gone, f"pages name what is not there: {', '.join(gone)}"
