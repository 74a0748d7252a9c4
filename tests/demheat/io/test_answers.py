"""Only here: files of answers that are broken, of another format, or lack what is asked for."""

import json

import numpy as np
import pytest

from demheat.io.answers import FORMAT, read_answers

GOOD = {"scene": "sc-third-s10", "conductivity": 1.4, "lower": 1.3, "upper": 1.5, "cpu_s": 2.0}
FILE = {"format": FORMAT, "program": "mine", "version": "1", "method": "by hand", "machine": "slow", "answers": [GOOD]}


def read(tmp_path, table):
    path = tmp_path / "mine.json"
    path.write_text(table if isinstance(table, str) else json.dumps(table), encoding="utf-8")
    return read_answers(path)


def test_what_a_file_holds(tmp_path):
    rows = [GOOD | {"tensor": np.diag([1.4, 1.5, 1.6]).tolist()}, {"scene": "slab-step", "temperatures": [0.5, 1]}]
    found = read(tmp_path, FILE | {"answers": [*rows, {"scene": "sc-third-pore", "refused": "pores"}]})
    assert (found.program, found.version, found.method, found.machine) == ("mine", "1", "by hand", "slow")
    one, two, three = found.answers
    again = [GOOD | {"resolution": "coarse"}, GOOD | {"resolution": "fine"}]
    assert len(read(tmp_path, FILE | {"answers": again}).answers) == 2
    assert (one.conductivity, one.lower, one.upper, one.cpu_s) == (1.4, 1.3, 1.5, 2.0) and one.tensor.shape == (3, 3)
    assert two.temperatures.tolist() == [0.5, 1.0] and np.isnan(two.conductivity) and three.refused == "pores"


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("{", "mine.json: is no JSON"),
        ("[]", "format = no object: must be 'conduction-answers/1'"),
        (FILE | {"format": "conduction-answers/2"}, "format = 'conduction-answers/2': must be 'conduction-answers/1'"),
        ({"format": FORMAT, "answers": [GOOD]}, "program: missing"),
        (FILE | {"program": 3}, "program = 3: must be text"),
        (FILE | {"progam": "x"}, "has 'progam', which is not known; did you mean 'program'"),
        (FILE | {"answers": []}, "answers = .*: must be a list of objects"),
        (FILE | {"answers": [3]}, r"answers\[0\] = 3: must be an object"),
        (FILE | {"answers": [GOOD, {"conductivity": 1.0}]}, r"answers\[1\].scene: missing"),
        (FILE | {"answers": [{"scene": "x"}]}, "must have a conductivity, temperatures, or refused"),
        (FILE | {"answers": [GOOD | {"conductivty": 1.0}]}, "did you mean 'conductivity'"),
        (
            FILE | {"answers": [GOOD | {"conductivity": "1.4"}]},
            r"= '1.4': must be a finite number, W/\(m K\), without quotes",
        ),
        (FILE | {"answers": [GOOD | {"cpu_s": "2"}]}, r"cpu_s = '2': must be a finite number, >= 0, without quotes"),
        (FILE | {"answers": [GOOD | {"conductivity": True}]}, r"conductivity = true: must be a finite number"),
        (FILE | {"answers": [GOOD | {"cpu_s": -1.0}]}, r"cpu_s = -1.0: must be a finite number, >= 0$"),
        (FILE | {"answers": [GOOD | {"lower": 1.6}]}, "lower = 1.6, upper = 1.5: lower must not be above upper"),
        (
            FILE | {"answers": [{"scene": "x", "conductivity": 1.0, "upper": 2.0}]},
            "has upper and no lower; must have both",
        ),
        (FILE | {"answers": [GOOD, GOOD]}, r"answers\[1\]: scene 'sc-third-s10' is answered in answers\[0\] already"),
        (
            {"program": "mine"},
            "format = missing: must be 'conduction-answers/1'; must be an object with format, program",
        ),
        (FILE | {"answers": [GOOD | {"tensor": [["1", 0, 0], [0, 1, 0], [0, 0, 1]]}]}, "three rows of three finite"),
        ({"format": "conduction-benchmark/1", "scene": {}, "known": {}}, "; this is a scene, and what is judged are"),
        (FILE | {"answers": [GOOD | {"tensor": [[1.0]]}]}, "tensor = .*: must be three rows of three finite numbers"),
        (FILE | {"answers": [GOOD | {"temperatures": [[1.0]]}]}, "temperatures = .*: must be a list of finite numbers"),
        (json.dumps(FILE).replace("1.4", "NaN"), "conductivity = nan: must be a finite number"),
    ],
)
def test_what_is_wrong_is_named(table, words, tmp_path):
    with pytest.raises(ValueError, match=words):
        read(tmp_path, table)
