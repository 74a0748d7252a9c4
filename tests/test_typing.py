"""What editors and type checkers see: examples of the manual pass mypy's strict rules, and no name is of any type."""

import doctest
import inspect
import re
import subprocess
import sys

import pytest
from blocks import blocks
from imported import ROOT
from test_reference import EXAMPLES, _found

import demheat

README = re.compile(r"```python\n(.*?)```", re.DOTALL)
PAGES = ("tutorial.md", "errors.md", "choose.md", "guide.md", "cluster.md", "benchmark.md", "mpi.md")
# What is said of libraries without types is theirs, and an example of a mistake is one.
FLAGS = ("--strict", "--follow-imports=silent", "--no-error-summary", "--no-pretty")
SEEN = """
from demheat import effective, evolve, gallery, recommend, solve, sweep
from references import bracket, exact, fem, fft, multipole

reveal_type(solve)
reveal_type(evolve)
reveal_type(effective)
reveal_type(recommend)
reveal_type(sweep)
reveal_type(fem.solve)
reveal_type(fft.solve)
reveal_type(exact.solve)
reveal_type(multipole.solve)
reveal_type(bracket.solve)
"""
MISTAKES = {
    "demheat.sovle(scene)": "attr-defined",
    "demheat.solve(scene, particels=10)": "call-arg",
    "demheat.solve(scene).conductivty": "attr-defined",
    "fem.slove(scene)": "attr-defined",
}
HEAD = "import demheat\nfrom demheat import gallery\nfrom references import fem\n\nscene = gallery.slab()\n"


@pytest.fixture(scope="module")
def told(tmp_path_factory):
    """What mypy says of each example, by its name: all in one run, as most of it is spent on NumPy."""
    folder = tmp_path_factory.mktemp("typed")
    for name, text in examples():
        (folder / f"example_{name}.py").write_text(text, encoding="utf-8")
    where = {"cwd": folder, "env": {"MYPYPATH": str(ROOT), "PATH": ""}, "capture_output": True, "text": True}
    words = [sys.executable, "-m", "mypy", *FLAGS, "--cache-dir", str(ROOT / ".mypy_cache"), "."]
    done = subprocess.run(words, **where)
    assert not done.stderr, done.stderr
    lines = done.stdout.splitlines()
    return {name: [line for line in lines if line.startswith(f"example_{name}.py")] for name, _ in examples()}


def examples():
    yield "readme", README.search((ROOT / "README.md").read_text(encoding="utf-8"))[1]
    for page in PAGES:
        yield page.removesuffix(".md"), "\n".join(each.text for each in blocks(page) if each.kind == "python")
    for path in sorted((ROOT / "examples").glob("*.py")):
        yield f"script_{path.stem}", path.read_text(encoding="utf-8")
    for name in EXAMPLES:
        parts = doctest.DocTestParser().get_examples(inspect.getdoc(_found(name)) or "")
        yield name.replace(".", "_"), "".join(part.source for part in parts if part.exc_msg is None)
    yield "seen", SEEN
    yield "mistakes", HEAD + "\n".join(MISTAKES)


NAMES = [name for name, _ in examples()]


# mypy reads NumPy for a dozen CPU-seconds; that examples run, `test_reference`, `test_scripts` and others see.
@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in NAMES if name not in ("seen", "mistakes")])
def test_an_example_passes(name, told):
    assert told[name] == []


@pytest.mark.slow
def test_nothing_is_of_any_type(told):
    seen = told["seen"]
    assert len(seen) == SEEN.count("reveal_type") and not [line for line in seen if 'is "Any"' in line]
    solves = [line for line in seen if "-> demheat.field.Field" in line]
    assert len(solves) == 5 and all("scene: demheat.scene.scene.Scene" in line for line in solves)


@pytest.mark.slow
def test_mistakes_are_found(told):
    """Each on a line of its own, behind the head."""
    first = HEAD.count("\n") + 1
    found = [re.search(r":(\d+): error: .*\[([\w-]+)\]$", line) for line in told["mistakes"]]
    expected = [(str(number), kind) for number, kind in enumerate(MISTAKES.values(), start=first)]
    assert [each.groups() for each in found if each] == expected


def test_lazy_names_are_listed():
    assert {*demheat.__all__} <= {*dir(demheat)} and {"solve", "evolve", "solve_axes"} <= {*dir(demheat.dem)}
