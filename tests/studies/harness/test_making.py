"""What makes rows of our own studies: no function of a file runs for one that is left out, or not looked at."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from imported import MODULES, below, imports_of

from studies.__main__ import study_names
from studies.harness import making, runner
from studies.harness.making import APART
from studies.harness.provenance import ROOT, row_environment
from studies.harness.store import case_key

# A process that does what is left of its words and prints the files of all functions that ran.
TRACED = """
import json, sys, threading

files = set()

def look(frame, event, argument):
    code = frame.f_code
    # Of functions alone: not of modules and classes, nor of what these loop over.
    if event == "call" and code.co_flags & 1 and (code.co_name[0] != "<" or code.co_name == "<lambda>"):
        files.add(code.co_filename)

threading.setprofile(look)
sys.setprofile(look)
from studies.__main__ import main, study_names
from studies.harness import runner
ended = main(sys.argv[1:]) if sys.argv[1:] else [runner.load(name) for name in study_names()]
sys.setprofile(None)
print(json.dumps(sorted(files)))
sys.exit(ended if sys.argv[1:] else 0)
"""


def ran(*words):
    """Files of our studies, and of rooms that are left out, of which functions ran."""
    environment = row_environment(1) | {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
    done = subprocess.run(
        [sys.executable, "-c", TRACED, *words], cwd=ROOT, env=environment, capture_output=True, text=True, check=True
    )
    files, packages = map(Path, json.loads(done.stdout.splitlines()[-1])), [ROOT / each for each in ("studies", *APART)]
    return {file for file in files if any(file.is_relative_to(each) for each in packages)}


def split(file):
    """What is looked at of a study, and what is left out."""
    paths = making.paths_of(ROOT, file)
    out = {ROOT / path.removeprefix(making.EXCEPT) for path in paths if path.startswith(making.EXCEPT)}
    return [ROOT / path for path in paths if not path.startswith(making.EXCEPT)], out


@pytest.mark.parametrize(("name", "alone"), [("fig05_slab", []), ("gaps", ["--values"])])
def test_what_is_left_out_makes_no_row(name, alone):
    study = runner.load(name)
    case = next(case for case in study.CASES if study.QUICK(case))
    files, (made, out) = ran("row", name, case_key(case), *alone), split(study.__file__)
    assert {ROOT / "studies" / "harness" / "runner.py", Path(study.__file__)} <= files
    # It says what a row's stamp asks of git, and makes nothing of the row.
    files.discard(Path(making.__file__))
    assert not any(file.is_relative_to(each) for file in files for each in out)
    # The command line hands words on.
    others = {file for file in files if not any(file.is_relative_to(each) for each in made)}
    assert others == {ROOT / "studies" / "__main__.py"}


def test_nothing_of_it_runs_when_studies_are_loaded():
    """Constants that a reader makes when it is loaded may be in a study's."""
    files = ran()
    for name in study_names():
        _, out = split(runner.load(name).__file__)
        assert files & {path for path in out if path.parent.name == "harness"} <= {Path(making.__file__)}


def test_rooms_that_are_left_out_are_entered_by_name_alone():
    """By the front's names, by commands and by sweeps: a study that has none of these names has no row of theirs."""
    names = {name for name in MODULES if not name.startswith("studies.")}
    inside = {name for name in names if below(name, "demheat.cheapest")}
    assert set(APART) == {"demheat/cheapest"} and inside
    enter = {name for name in names - inside if any(below(each, "demheat.cheapest") for each in imports_of(name))}
    assert enter and all(
        name in ("demheat", "benchmark") or any(below(name, room) for room in ("demheat.sweeps", "demheat.terminal"))
        for name in enter
    ), enter
    named = {
        name for name in study_names() if ROOT / "demheat" / "cheapest" not in split(runner.load(name).__file__)[1]
    }
    assert named == {"estimates", "frontier"}


def test_searches_make_rows_of_those_who_ask_for_them_alone():
    room = ROOT / "studies" / "common" / "searches"
    enter = {name for name in study_names() if room not in split(runner.load(name).__file__)[1]}
    assert enter == {"fluxes", "frontier"}
    # Nothing else of what all have in common names it.
    common = {name for name in MODULES if below(name, "studies.common") and not below(name, "studies.common.searches")}
    assert common and not any(below(each, "studies.common.searches") for name in common for each in imports_of(name))


def test_readers_are_there():
    there = {path.stem for path in (ROOT / "studies" / "harness").glob("*.py")}
    assert set(making.READERS) <= there


def test_studies_that_ask_others_say_so():
    asked = {name: split(runner.load(name).__file__)[0] for name in ("frontier", "fig05_slab")}
    assert ROOT / "studies" / "peers" in asked["frontier"] and len(asked["fig05_slab"]) == len(making.EVERYBODYS) + 1
