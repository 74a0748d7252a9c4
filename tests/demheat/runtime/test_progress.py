"""Only here: progress that is silent, said twice, falls, or outlives its stage."""

import io
import re
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from demheat import Material, Scene, Sphere, evolve, on_progress, solve
from demheat.runtime import progress


@pytest.fixture
def impatient(monkeypatch):
    monkeypatch.setattr(progress, "SILENT", 0.0)
    monkeypatch.setattr(progress, "PAUSE", 0.0)
    monkeypatch.setattr(progress, "WAIT", 0.0)


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


def test_a_terminal_shows_a_line_and_clears_it(impatient, monkeypatch):
    said = io.StringIO()
    said.isatty = lambda: True
    monkeypatch.setattr("sys.stderr", said)
    with progress.stage("cells") as done:
        done(0.25)
    assert "cells: 25%" in said.getvalue() and said.getvalue().endswith("\r\x1b[K")


@pytest.fixture
def heard(impatient):
    reports = []
    on_progress(reports.append)
    yield reports
    on_progress(None)


def until(fulfilled):
    """Wait for another thread; the limit is for a machine that is busy with other things."""
    end = time.monotonic() + 20
    while not fulfilled() and time.monotonic() < end:
        time.sleep(0.005)
    return fulfilled()


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="Linux tells it")
def test_a_line_tells_the_memory_if_it_is_much(monkeypatch):
    report = progress.Report("cells", 0.5, 3.0, 3.0)
    monkeypatch.setattr(progress, "LARGE", 2**60)
    assert progress.line(report) == "cells: 50%, 3 s left"
    monkeypatch.setattr(progress, "LARGE", 0)
    # NumPy alone takes some tens of MiB.
    held = float(re.fullmatch(r"cells: 50%, 3 s left, holds ([\d.]+) GiB", progress.line(report))[1])
    assert 0.01 < held < 100


def test_a_stage_that_says_nothing_is_spoken_for(heard, monkeypatch):
    monkeypatch.setattr(progress, "PAUSE", 0.01)
    with progress.stage("outer"), progress.stage("inner"):
        # A speaker of before may have had its last word.
        assert until(lambda: heard and heard[-1].stage == "inner")
    report = heard[-1]
    assert (report.stage, report.within) == ("inner", ("outer",))
    assert report.share != report.share and progress.line(report).startswith("outer: inner: ")
    assert not progress._open and until(lambda: not progress._work.is_set())


def test_a_stage_within_its_like_is_said_once(heard):
    """As kernels that are compiled one by one while all are."""
    with progress.stage("compiling, once") as whole:
        with progress.stage("compiling, once") as part:
            part(0.5)
        with progress.stage("cells") as cells, progress.stage("compiling, once") as part:
            part(0.5)
            cells(0.5)
        whole(0.5)
    # What others say of silent ones besides has no share.
    told = [progress.line(report) for report in heard if report.share == 0.5]
    assert [line.partition(":")[0] for line in told] == ["compiling, once"] * 2 and len(told) == 2
    assert told[0].startswith("compiling, once: cells: 50%") and told[1].startswith("compiling, once: 50%")


def test_a_long_stage_speaks_while_short_ones_come_and_go_in_it(heard, monkeypatch):
    monkeypatch.setattr(progress, "PAUSE", 0.01)
    monkeypatch.setattr(progress, "SILENT", 0.05)

    def passing():
        with progress.stage("short"):
            time.sleep(0.001)
        return heard

    with progress.stage("long") as done:
        done(0.25)
        assert until(passing)
    assert {report.stage for report in heard} == {"long"} and heard[-1].share == 0.25


def test_parts_of_a_stage_are_counted_together(heard, monkeypatch):
    part = progress.in_parts("march")
    for share in (0.25, 0.5):
        with part() as done:
            time.sleep(0.02)
            done(share)
    assert [report.share for report in heard if report.share == report.share][-1] == 0.5
    assert heard[-1].elapsed >= 0.04


def test_of_two_threads_the_hook_hears_both_and_the_terminal_shows_one(impatient, monkeypatch):
    def compute(name, begun, ended):
        with progress.stage(name) as done:
            done(0.5)
            begun.set()
            ended.wait(20)

    def both():
        events = [(threading.Event(), threading.Event()) for _ in range(2)]
        threads = [
            threading.Thread(target=compute, args=(name, *pair)) for name, pair in zip("ab", events, strict=True)
        ]
        for thread, (begun, _) in zip(threads, events, strict=True):
            thread.start()
            begun.wait(20)
        for thread, (_, ended) in zip(threads, events, strict=True):
            ended.set()
            thread.join()

    monkeypatch.setattr(progress, "WAIT", 1e9)
    reports, said = [], io.StringIO()
    on_progress(reports.append)
    both()
    on_progress(None)
    assert {report.stage for report in reports} == {"a", "b"}
    said.isatty = lambda: True
    monkeypatch.setattr("sys.stderr", said)
    both()
    assert "a: 50%" in said.getvalue() and "b: 50%" not in said.getvalue()


def test_the_environment_silences_the_terminal(impatient, monkeypatch):
    said = io.StringIO()
    said.isatty = lambda: True
    monkeypatch.setattr("sys.stderr", said)
    monkeypatch.setenv("DEMHEAT_PROGRESS", "0")
    with progress.stage("cells") as done:
        done(0.25)
    assert said.getvalue() == ""


def test_without_listeners_a_stage_starts_no_thread(monkeypatch):
    monkeypatch.setattr(progress, "_speaker", [None])
    with progress.stage("cells") as done:
        done(0.5)
    assert progress._speaker == [None] and not progress._open


@pytest.mark.parametrize("left, words", [(99.0, "99 s"), (120.0, "2 min"), (7200.0, "2.0 h")], ids=["s", "min", "h"])
def test_time_left_in_words(monkeypatch, left, words):
    # This process may hold much.
    monkeypatch.setattr(progress, "LARGE", float("inf"))
    assert progress.line(progress.Report("cells", 0.5, 1.0, left)) == f"cells: 50%, {words} left"


def test_what_a_hook_raises_ends_the_computation(impatient):
    def stop(report):
        raise KeyboardInterrupt

    on_progress(stop)
    try:
        with pytest.raises(KeyboardInterrupt), progress.stage("cells") as done:
            done(0.5)
    finally:
        on_progress(None)
    assert not progress._open


STEEL = Material(conductivity=1.0, density=1.0, heat_capacity=1.0)


def test_the_stages_of_a_solve_and_a_march_are_heard(heard):
    ball = Sphere(center=(0.5, 0.5, 0.5), radius=0.3, material=Material(conductivity=5.0))
    scene = Scene(size=(1, 1, 1), matrix=Material(1.0), inclusions=[ball], walls={"y-": 0.0, "y+": 1.0})
    field = solve(scene, particles=300, seed=11)
    field.temperature_at(np.array([[0.5, 0.5, 0.5]]))
    stages = {report.stage for report in heard}
    assert {"twins", "points"} <= stages
    heard.clear()
    bar = Scene(size=(1, 1, 1), matrix=STEEL, walls={"y-": 0.0, "y+": 1.0}, initial=0.0)
    assert len(list(evolve(bar, [0.01, 0.02], particles=300, seed=11))) == 2
    shares = [report.share for report in heard if report.stage == "march" and report.share == report.share]
    assert shares == sorted(shares) and 0.4 < shares[-1] <= 1 + 1e-9  # rounding
