"""Files of answers are what the stored rows say, of the scenes of the benchmark, in the form that their schema says."""

import json

import benchmark
from benchmark.schema import faults
from demheat.io.answers import read_answers
from studies.peers import answers
from studies.peers.given import scene


def test_bodies_are_scenes_of_the_benchmark():
    assert [ours for ours, theirs in answers.SAME.items() if scene(ours) != benchmark.load(theirs)[0]] == []


def test_files_are_those_of_the_rows():
    made = answers.files()
    assert len(made) >= 6
    stored = {path.name: path.read_text(encoding="utf-8") for path in answers.ANSWERS.glob("*.json")}
    wrong = ", ".join(sorted(name for name in {*made, *stored} if made.get(name) != stored.get(name)))
    assert not wrong, f"benchmark/answers has not what the rows say: {wrong}; python -m studies.peers.answers writes it"


def test_files_fit_their_schema():
    schema = json.loads((answers.ANSWERS.parent / "answers.schema.json").read_text(encoding="utf-8"))
    for path in answers.ANSWERS.glob("*.json"):
        assert faults(json.loads(path.read_text(encoding="utf-8")), schema) == []
        assert len(read_answers(path).answers) >= answers.FEWEST
    assert faults({"format": "conduction-answers/2", "program": "x", "answers": []}, schema) != []
