"""The tutorial: every block is run, in order, in a folder of its own, and prints what the page says."""

import shlex

import pytest
from blocks import blocks, check_alike

from demheat.terminal.commands import main

PAGE = "tutorial.md"


def _commands(text):
    """Lines of a shell block, as words behind `demheat`."""
    for line in filter(None, text.splitlines()):
        name, *words = shlex.split(line)
        assert name == "demheat"
        yield words


def _do(block, names, folder):
    if block.kind == "python":
        exec(block.text, names)
    elif block.kind == "toml":
        name = block.text.splitlines()[0].removeprefix("# ")
        (folder / name).write_text(block.text, encoding="utf-8")
    else:
        assert block.kind == "sh"
        for words in _commands(block.text):
            assert main(words) == 0


def test_every_block_runs_and_prints_what_is_said(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    found, names = blocks(PAGE), {}
    for block in found:
        _do(block, names, tmp_path)
        printed = capsys.readouterr().out
        if block.printed is not None:
            check_alike(printed, block.printed)
    assert {block.kind for block in found} == {"python", "toml", "sh"}
    written = {path.name for path in tmp_path.iterdir()}
    assert {"beads.csv", "field.vtu", "field.vti", "again.toml", "scan.npy", "bed.dump", "flows.csv"} <= written
    assert {path.suffix for path in (tmp_path / "out").iterdir()} >= {".csv", ".png"}


@pytest.mark.parametrize(
    ("printed", "said"),
    [("42.6 W", "43.2 W"), ("42.6 W", "42.6 K"), ("42.6 W\nmore", "42.6 W"), ("42.6", "42.6 W"), ("", "42.6\n...")],
)
def test_what_is_not_said_is_seen(printed, said):
    with pytest.raises(AssertionError):
        check_alike(printed, said)
