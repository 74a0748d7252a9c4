"""Only here: sweeps that lose rows, mix them up, or compute them again."""

import csv
import os
import subprocess
import sys

import numpy as np
import pytest

import demheat
from demheat import gallery, sweep
from demheat.sweeps.rows import TAIL
from references import exact


def square(x, y=0.0):
    if x == 3:
        raise RuntimeError("no convergence\nafter 7 iterations")
    return x * x + y


def read(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def measured_apart(rows):
    return [{name: value for name, value in row.items() if name not in ("wall_s", "cpu_s", "when")} for row in rows]


def test_a_grid_is_every_combination_the_last_name_fastest():
    rows = sweep(square, {"x": [1.0, 2.0], "y": np.array([0.5, 0.25])})
    assert [(row["x"], row["y"], row["value"]) for row in rows] == [
        (1.0, 0.5, 1.5),
        (1.0, 0.25, 1.25),
        (2.0, 0.5, 4.5),
        (2.0, 0.25, 4.25),
    ]
    assert all(set(row) == {"x", "y", "value", *TAIL} and row["error"] == "" for row in rows)
    assert all(type(row["y"]) is float and row["wall_s"] >= 0 and row["cpu_s"] >= 0 for row in rows)


def test_a_case_that_fails_is_a_row():
    rows = sweep(square, [{"x": 3.0}, {"x": 2.0}])
    assert rows[0]["error"] == "RuntimeError: no convergence after 7 iterations" and "value" not in rows[0]
    assert rows[1]["value"] == 4.0


def test_what_a_function_may_return():
    scene = gallery.laminate()
    found = {
        "field": exact.solve(scene),
        "effective": demheat.effective(gallery.sphere_in_cube(5.0), method="exact"),
        "numpy": np.float64(0.5),
        "text": "a",
        "dict": {"a": np.int64(3), "b": "text", "c": None, "d": True},
    }
    rows = {row["kind"]: row for row in sweep(lambda kind: found[kind], {"kind": list(found)})}
    assert list(rows) == list(found) and all(row["error"] == "" for row in rows.values())
    assert rows["field"]["conductivity"] == found["field"].conductivity
    # Of a layered body: the harmonic mean along, nothing across.
    assert rows["field"]["conductivity"] == pytest.approx(55.0, rel=1e-12)
    assert rows["effective"]["k_xx"] == found["effective"].tensor[0, 0] and rows["effective"]["method"] == "exact"
    assert rows["numpy"]["value"] == 0.5 and type(rows["numpy"]["value"]) is float
    assert rows["text"]["value"] == "a"
    assert [rows["dict"][name] for name in "abcd"] == [3, "text", None, True]


@pytest.mark.parametrize(
    ("result", "words"),
    [
        (np.ones(3), "must be a number, text"),
        (None, "must be a number, text"),
        ({"a": [1]}, "a = [1]: must be a number or text"),
        ({"x": 5.0}, "['x']: must not be names"),
        ({"when": 5.0}, "['when']: must not be names"),
        ({"case": 5.0}, "['case']: must not be names"),
    ],
)
def test_what_it_may_not_return_is_the_error_of_its_row(result, words):
    (row,) = sweep(lambda x: result, [{"x": 1.0}])
    assert row["error"].startswith("ValueError: the function returned") and words in row["error"]


def test_a_file_is_written_row_by_row_and_resumed(tmp_path):
    path, calls = tmp_path / "rows.csv", []

    def stopping(x):
        calls.append(x)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return {"square": x * x, "word": "3.0x"}

    cases = {"x": [1.0, 0.1, 7.0, 9.0]}
    with pytest.raises(KeyboardInterrupt):
        sweep(stopping, cases, out=path)
    assert [row["x"] for row in read(path)] == ["1.0", "0.1"]
    rows = sweep(stopping, cases, out=path)
    assert calls == [1.0, 0.1, 7.0, 7.0, 9.0]
    assert [row["square"] for row in rows] == [1.0, 0.1 * 0.1, 49.0, 81.0] and rows[0]["word"] == "3.0x"
    assert sweep(stopping, cases, out=path) == rows and len(calls) == 5
    # More cases go into the same file, in any order of names.
    assert len(sweep(stopping, {"x": [9.0, 11.0]}, out=path)) == 2 and calls[5:] == [11.0]
    assert len(read(path)) == 5 and os.listdir(tmp_path) == ["rows.csv"]


# Writes rows as soon as a line comes in, and takes a while from reading to writing, so that two of them meet.
WRITER = """
import sys
import time
from demheat.runtime.rows import RowFile
from demheat.sweeps import file
from demheat.sweeps.rows import TAIL
read, RowFile.read = RowFile.read, lambda file: (read(file), time.sleep(0.005))[0]
print(flush=True)
sys.stdin.readline()
mine, file = sys.argv[1], file.opened(sys.argv[2])
for number in range(20):
    file.add({"x": mine, "n": number}, {"x": mine, "n": number, **dict.fromkeys(TAIL, "")})
"""


def test_two_processes_on_one_file_lose_no_row(tmp_path):
    path, pipe = tmp_path / "rows.csv", subprocess.PIPE
    command = (sys.executable, "-c", WRITER)
    both = [subprocess.Popen([*command, mine, path], stdin=pipe, stdout=pipe, text=True) for mine in "ab"]
    assert [each.stdout.readline() for each in both] == ["\n", "\n"]
    for each in both:
        each.stdin.write("\n")
        each.stdin.flush()
    assert [(each.communicate()[0], each.returncode) for each in both] == [("", 0)] * 2
    assert {(row["x"], row["n"]) for row in read(path)} == {(mine, str(n)) for mine in "ab" for n in range(20)}


def test_failed_cases_are_tried_again(tmp_path):
    path = tmp_path / "rows.csv"
    assert sweep(square, [{"x": 3.0}], out=path)[0]["error"]
    (row,) = sweep(lambda x: 9.0, [{"x": 3.0}], out=path)
    assert row["error"] == "" and row["value"] == 9.0 and len(read(path)) == 1


def test_cases_of_other_names_are_not_mixed_up(tmp_path):
    path = tmp_path / "rows.csv"
    first = sweep(square, [{"x": 1.0, "y": 5.0}], out=path)
    rows = sweep(square, [{"x": 1.0}, {"y": 5.0, "x": 1.0}], out=path)
    assert [row["value"] for row in rows] == [1.0, 6.0] and measured_apart(rows[1:]) == measured_apart(first)


@pytest.mark.parametrize("text", ["no rows\n", "case,x\na\n", "case,x,value\nx=1,1,1\n", "\0"])
def test_a_file_of_something_else_is_left_alone(tmp_path, text):
    path = tmp_path / "rows.csv"
    path.write_text(text)
    with pytest.raises(ValueError, match="out = .*must hold rows of a sweep as CSV"):
        sweep(square, [{"x": 1.0}], out=path)
    assert path.read_text() == text


@pytest.mark.parametrize(
    ("cases", "words"),
    [
        ({"scene": [gallery.laminate()]}, "must be a number or text to be kept"),
        ([{"x": 1}, {"x": 1}], "two are alike"),
        ([{"x": "1"}, {"x": 1}], "two are alike"),
    ],
)
def test_what_cannot_be_found_again_is_not_kept(tmp_path, cases, words):
    with pytest.raises(ValueError, match=words):
        sweep(square, cases, out=tmp_path / "rows.csv")
