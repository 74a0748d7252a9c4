"""The reference: everything public is in it, every entry has an example, and every example runs."""

import doctest
import importlib
import inspect
import re

import pytest
from blocks import DOCS

import demheat

ENTRY = re.compile(r"^\.\. (auto\w+):: ([\w.]+)$(.*?)(?=^\.\. auto|^```|\Z)", re.MULTILINE | re.DOTALL)
# Kind of each entry, and what its page says beneath: modules that are long have their examples there.
ENTRIES = {
    name: (kind, beneath)
    for path in sorted((DOCS / "reference").glob("*.md"))
    for kind, name, beneath in ENTRY.findall(path.read_text(encoding="utf-8"))
}
EXAMPLES = [name for name, (kind, _) in ENTRIES.items() if kind != "automodule"]
FLAGS = doctest.ELLIPSIS | doctest.IGNORE_EXCEPTION_DETAIL


def _found(name):
    """What a dotted name means."""
    home, _, last = name.rpartition(".")
    return getattr(importlib.import_module(home), last)


def _example(name):
    text = f"{inspect.getdoc(_found(name))}\n\n{ENTRIES[name][1]}"
    return doctest.DocTestParser().get_doctest(text, {}, name, None, 0)


def test_what_is_public_is_in_it():
    missing = ", ".join(sorted({f"demheat.{name}" for name in demheat.__all__} - set(ENTRIES)))
    assert not missing, f"a page of docs/reference wants an entry of {missing}"
    assert len(EXAMPLES) > 70


@pytest.mark.parametrize("home", ["demheat.gallery", "references.bounds"])
def test_all_of_a_module_is_in_it(home):
    module = importlib.import_module(home)
    public = [name for name in module.__all__ if callable(getattr(module, name))]
    assert {f"{home}.{name}" for name in public} <= set(ENTRIES)


@pytest.mark.parametrize("name", EXAMPLES)
def test_an_example_runs(name):
    example = _example(name)
    assert example.examples, f"{name} has no example"
    said = []
    doctest.DocTestRunner(optionflags=FLAGS, verbose=False).run(example, out=said.append)
    assert said == [], "".join(said)
