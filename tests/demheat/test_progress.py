import io

import pytest

from demheat import on_progress, progress


@pytest.fixture
def impatient(monkeypatch):
    monkeypatch.setattr(progress, "SILENT", 0.0)
    monkeypatch.setattr(progress, "PAUSE", 0.0)


def test_a_hook_hears_of_stages(impatient):
    heard = []
    on_progress(heard.append)
    try:
        with progress.stage("cells") as done:
            done(0.0)
            done(0.5)
    finally:
        on_progress(None)
    assert [(report.stage, report.share) for report in heard] == [("cells", 0.0), ("cells", 0.5)]
    assert heard[0].left != heard[0].left and heard[1].left == heard[1].elapsed


def test_short_stages_and_streams_that_are_no_terminals_stay_silent(monkeypatch):
    said = io.StringIO()
    monkeypatch.setattr("sys.stderr", said)
    with progress.stage("cells") as done:
        done(0.5)
    monkeypatch.setattr(progress, "SILENT", 0.0)
    with progress.stage("cells") as done:
        done(0.5)
    assert said.getvalue() == ""


def test_a_terminal_shows_a_line_and_clears_it(impatient, monkeypatch):
    said = io.StringIO()
    said.isatty = lambda: True
    monkeypatch.setattr("sys.stderr", said)
    with progress.stage("cells") as done:
        done(0.25)
    assert "cells: 25%" in said.getvalue() and said.getvalue().endswith("\r\x1b[K")


def test_a_hook_must_be_callable():
    with pytest.raises(ValueError, match="hook = 3"):
        on_progress(3)
