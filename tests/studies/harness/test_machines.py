"""Seconds of different machines never stand on one curve; how many rows ran side by side is known."""

import os
import subprocess
import sys

import pandas as pd
import pytest

from demheat.runtime.machine import host
from studies.harness import beside, machines, runner, store
from studies.harness.table import read_frame, render


def frame(*rows):
    return pd.DataFrame(rows, columns=["machine", "host", "cpu_s", "solve_wall_s", "error_percent"])


def test_seconds_of_the_machine_that_made_most_are_kept():
    df = frame(("m", "a", 1.0, 2.0, 3.0), ("m", "b", 4.0, 5.0, 6.0), ("m", "b", 7.0, 8.0, 9.0))
    found = machines.of_one_machine(df)
    assert found["cpu_s"].isna().tolist() == found["solve_wall_s"].isna().tolist() == [True, False, False]
    assert found["error_percent"].tolist() == [3.0, 6.0, 9.0]
    assert machines.said(found) == ["rows are from 2 machines: seconds of all but the one that made most are left out"]


@pytest.mark.parametrize(("other", "same"), [(("m", None), True), (("n", None), False), (("n", "a"), False)])
def test_an_unknown_host_is_the_known_one_of_its_model(other, same):
    df = frame(("m", "a", 1.0, 2.0, 3.0), ("m", "a", 1.0, 2.0, 3.0), (*other, 1.0, 2.0, 3.0))
    assert machines.of_one_machine(df)["cpu_s"].notna().all() == same
    assert (machines.said(df) == []) == same


def test_an_unknown_host_is_neither_of_two():
    df = frame(*[("m", "a", 1.0, 2.0, 3.0)] * 2, ("m", "b", 1.0, 2.0, 3.0), ("m", None, 1.0, 2.0, 3.0))
    assert machines.of_one_machine(df)["cpu_s"].notna().tolist() == [True, True, False, False]


def test_rows_without_seconds_choose_no_machine():
    df = frame(*[("m", "a", None, None, 3.0)] * 3, ("m", "b", 1.0, 2.0, 3.0))
    assert machines.of_one_machine(df)["cpu_s"].notna().tolist() == [False] * 3 + [True]


def test_pages_and_the_list_say_it(tiny, capsys, monkeypatch):
    from studies.__main__ import main

    tiny.made()
    path = tiny.out / f"{tiny.name}.csv"
    study, rows = runner.load(tiny.name), list(tiny.rows().values())
    assert "machines" not in render(study, path)[1] and rows[0]["host"] == host()
    crowded = rows[1] | {"host": "another", "beside": "2", "noise": "0.02"}
    store.write_rows(path, [rows[0] | {"beside": "0"}, crowded])
    # Those two did nothing.
    assert "ran beside others" not in render(study, path)[1]
    store.write_rows(path, [rows[0] | {"beside": "0"}, crowded | {"noise": "0.5"}])
    df = read_frame(study, path)
    assert df["cpu_s"].notna().sum() == 1
    page = render(study, path)[1]
    assert "- rows are from 2 machines: seconds of" in page and "- 1 rows ran beside others" in page
    monkeypatch.setattr("studies.__main__.study_names", lambda: [tiny.name])
    main(["list", "--out", str(tiny.out)])
    assert "; 2 machines " in capsys.readouterr().out
    # Rows of before hosts were recorded are read as they were.
    store.write_rows(path, [{k: v for k, v in row.items() if k not in ("host", "beside")} for row in rows])
    assert read_frame(study, path)["cpu_s"].notna().all() and "machines" not in render(study, path)[1]


ROW = """
import sys
from pathlib import Path
from studies.harness import beside
beside.folder = lambda: Path(sys.argv[1])
with beside.counted():
    print("begun", flush=True)
    sys.stdin.read()
"""


def test_rows_beside_are_counted_and_the_dead_are_not(tmp_path, monkeypatch):
    folder = tmp_path / "rows"
    monkeypatch.setattr(beside, "folder", lambda: folder)
    with beside.counted() as alone:
        pass
    assert alone == {"beside": 0} and list(folder.iterdir()) == []
    # Of one that was killed, whose number another process has now.
    (folder / str(os.getppid())).touch()
    words = [sys.executable, "-c", ROW, str(folder)]
    with subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as other:
        assert other.stdout.readline() == "begun\n"
        with beside.counted() as found:
            pass
        left = [path.name for path in folder.iterdir()]
    assert found == {"beside": 1} and left == [str(other.pid)] and list(folder.iterdir()) == []


def test_where_no_file_can_be_written_nothing_is_counted(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(beside, "folder", lambda: tmp_path / "file")
    with beside.counted() as found:
        pass
    assert found == {}


def test_a_host_is_told_without_its_name():
    import platform

    assert len(host()) == 8 and int(host(), 16) >= 0 and platform.node() not in host()


def test_parts_are_not_compared_by_seconds():
    rows = [{"part": "a", "machine": "one"}, {"part": "b", "machine": "two"}, {"part": "b", "machine": "two"}]
    df = machines.of_one_machine(pd.DataFrame([row | {"cpu_s": 1.0} for row in rows]))
    assert df["cpu_s"].notna().all()
    mixed = machines.of_one_machine(pd.DataFrame([row | {"cpu_s": 1.0, "part": "b"} for row in rows]))
    assert mixed["cpu_s"].isna().tolist() == [True, False, False]
