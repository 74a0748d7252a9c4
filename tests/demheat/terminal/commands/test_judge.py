"""`demheat judge`: a table, a page that needs no other file, a leaderboard; what is wrong in one line."""

import json
import re

import pytest
from imported import ROOT

from demheat.io.answers import FORMAT
from demheat.terminal.commands import main

EXAMPLES = sorted((ROOT / "benchmark" / "answers").glob("*.json"))
MINE = {"format": FORMAT, "program": "<mine>", "answers": [{"scene": "sc-third-s10", "conductivity": 1.41, "cpu_s": 2}]}


@pytest.fixture
def mine(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.json").write_text(json.dumps(MINE), encoding="utf-8")
    return tmp_path


def test_one_file_is_judged(mine, capsys):
    assert main(["judge", "mine.json"]) == 0
    printed = capsys.readouterr().out
    # 1.41 over 1.39573.
    assert "1 answer to 1 scene; median error 1 %" in printed and re.search(r"sc-third-s10 +1 +1.4e-10 +2", printed)
    page = (mine / "demheat-out" / "mine.html").read_text(encoding="utf-8")
    assert "&lt;mine&gt;" in page and "<mine>" not in page and "Leaderboard" not in page
    assert not re.search(r"<(script|link|img)|https?:", page)


def test_examples_make_a_leaderboard(mine, capsys):
    assert len(EXAMPLES) >= 6
    assert main(["judge", *map(str, EXAMPLES), "mine.json", "--accuracy", "2%", "--out", "there"]) == 0
    printed = capsys.readouterr().out
    page = (mine / "there" / "leaderboard.html").read_text(encoding="utf-8")
    programs = [json.loads(path.read_text(encoding="utf-8"))["program"] for path in EXAMPLES]
    assert all(f"<h2>{name}: every answer</h2>" in page for name in programs)
    board = printed[printed.index("program ") :].splitlines()
    assert board[0].split()[1:3] == ["to", "2"] and {line.split()[0] for line in board[1:10]} == {*programs, "<mine>"}
    reached = [int(line.split()[1]) for line in board[1:10]]
    assert reached == sorted(reached, reverse=True) and reached[0] == 6


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["gone.json"], "gone.json: No such file or directory"),
        (["mine.json", "mine.json"], "program '<mine>': each file must be of a program of its own"),
        (["mine.json", "--accuracy", "2"], "--accuracy 2: must be a number from 1e-9 to below 1, as 0.01, or per cent"),
        (["mine.json", "--scenes", "."], "holds no scenes|there is no scene"),
        (["mine.json", "--scenes", "nowhere"], "nowhere: holds no scenes; they belong to a clone"),
        (["wrong.json"], r"wrong.json: answers\[0\]: there is no scene 'sc-thrid-s10' .*did you mean 'sc-third-s10'"),
    ],
)
def test_what_is_wrong_is_one_line(words, said, mine, capsys):
    wrong = MINE | {"answers": [{"scene": "sc-thrid-s10", "conductivity": 1.0}]}
    (mine / "wrong.json").write_text(json.dumps(wrong), encoding="utf-8")
    assert main(["judge", *words]) == 2
    told = capsys.readouterr().err
    assert re.search(said, told) and told.count("\n") == 1 and not (mine / "demheat-out").exists()
