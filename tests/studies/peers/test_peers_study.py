"""Only here: beds that fail before they begin, and programs whose absence takes the place of their rows."""

import shutil

import pytest

from studies import peers
from studies.harness import replay
from studies.peers import packages, python_elements

HERTZ = [case for case in peers.CASES if case["name"] == "grains" and case["scene"].endswith("Hertz radius")]


@pytest.mark.parametrize("case", HERTZ, ids=lambda case: case["scene"])
def test_our_beds_warm_up(case):
    """A bed at random has no layers to choose; a row whose warm-up raises has failed."""
    peers.warm_up(**case)


@pytest.mark.parametrize("name", peers.PROGRAMS)
def test_a_program_that_is_not_here_says_nothing_of_stored_rows(name, monkeypatch):
    """Else `accept` would put its absence in the place of what it gave where it was."""
    program = peers.program(name)
    monkeypatch.setattr(shutil, "which", lambda command: None)
    for module in (program, packages, python_elements):
        monkeypatch.setattr(module, "python_of", lambda *names: None, raising=False)
    note = program.missing()
    assert note is None or replay.absent({"status": "unsupported", "note": note}), note
