"""Rows as commands of a batch system, and home again."""

import json
import shlex
import subprocess
import sys

from studies.__main__ import main


def printed(tiny, capsys, *options):
    assert main(["jobs", tiny.name, "--out", str(tiny.out), *options]) == 0
    return capsys.readouterr().out.splitlines()


def test_there_and_back(tiny, capsys):
    tiny.write('{"name": "dies", "x": 4.0}')
    lines = printed(tiny, capsys)
    assert len(lines) == 3 and len(printed(tiny, capsys, "--quick")) == 1
    # As a job would: each line by a shell. The one that dies leaves its row, too.
    assert [subprocess.run(line, shell=True).returncode for line in lines] == [0, 0, 1]
    files = [shlex.split(line)[-1] for line in lines]
    assert main(["gather", tiny.name, "--out", str(tiny.out), *files]) == 0
    assert "3 rows added" in capsys.readouterr().out
    rows = {row["name"]: row for row in tiny.rows().values()}
    assert [rows[name]["status"] for name in ("plain", "second", "dies")] == ["ok", "ok", "failed"]
    assert rows["plain"]["square"] == "2.25" and rows["plain"]["host"] and float(rows["plain"]["cpu_s"]) >= 0
    # What has failed is asked for again, what is done is not.
    assert [shlex.split(line)[-1] for line in printed(tiny, capsys)] == files[2:]
    assert tiny.ran() == ["dies"]


def test_a_failed_row_takes_no_good_ones_place(tiny, tmp_path, capsys):
    tiny.made()
    before = tiny.rows()
    file = tmp_path / "row.json"
    file.write_text(json.dumps(next(iter(before.values())) | {"status": "failed"}))
    assert main(["gather", tiny.name, "--out", str(tiny.out), str(file)]) == 0
    assert tiny.rows() == before and "0 rows added" in capsys.readouterr().out


def test_files_that_hold_no_row(tiny, tmp_path, capsys):
    tiny.made()
    before, file = tiny.rows(), tmp_path / "row.json"
    for text in ("", "[]", "{}", '{"case": "x=1", "status": "ok"}', '{"case": ["x"], "status": "ok"}'):
        file.write_text(text)
        assert main(["gather", tiny.name, "--out", str(tiny.out), str(file)]) == 2
        said = capsys.readouterr().err
        assert f"{file}: must hold a row" in said and said.count("\n") == 1
    assert main(["gather", tiny.name, "--out", str(tiny.out), str(tmp_path / "none")]) == 2
    assert tiny.rows() == before


def test_commands_are_of_this_python_and_name_their_files(tiny, capsys):
    words = shlex.split(printed(tiny, capsys)[1])
    assert words[:6] == [sys.executable, "-m", "studies", "row", tiny.name, "name=second,x=2.0"]
    assert words[6:] == ["--json", str(tiny.out / f"{tiny.name}-rows" / "00001.json")]
