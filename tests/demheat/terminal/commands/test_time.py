"""Only here: --seconds without effect, and what cannot be written said after the solve."""

import csv
import re

import pytest
from test_commands import run

from demheat import gallery
from demheat.io import scenes
from demheat.terminal.commands import compare, solve


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "scene.toml"
    scenes.write(gallery.sphere_in_cube(5.0), path)
    return path


def test_solve_tells_what_is_done_by_then(capsys, scene):
    status, out, err = run(
        capsys, "solve", scene, "--methods", "fft,maxwell", "--knob", "voxels=8", "--seconds", "1e-9"
    )
    assert status == 1 and "conductivity" not in out
    *told, advice = err.splitlines()
    assert told == [f"demheat: {name}: seconds = 1e-09 are over, in other methods" for name in ("fft", "maxwell")]
    sizes = "--seconds 4e-09, or a coarser size, as --knob fft.voxels=4."
    assert advice == f"demheat: The time was over before fft, maxwell got done: must be more, as {sizes}"
    status, out, err = run(capsys, "solve", scene, "--method", "maxwell", "--seconds", "1000")
    assert (status, err) == (0, "") and "conductivity" in out
    status, out, err = run(capsys, "solve", scene, "--method", "maxwell", "--seconds", "-1")
    assert status == 2 and "--seconds -1: must be a number of seconds > 0" in err


def test_an_interval_that_takes_too_long_costs_the_interval(capsys, scene, monkeypatch):
    def late(field):
        raise TimeoutError("seconds = 5 are over, in iterations")

    monkeypatch.setattr("demheat.field.Field.error", property(late))
    status, out, err = run(capsys, "solve", scene, "--method", "fft", "--knob", "voxels=8", "--seconds", "5")
    assert status == 0 and "expected from" not in out
    assert "fft: no interval: seconds = 5 are over, in iterations" in err
    # Such a row is no answer for another time.
    run(capsys, "compare", scene, "--method", "fft", "--knob", "voxels=8", "--out", scene.parent / "out")
    assert not (scene.parent / "out" / "scene.csv").exists()


def test_compare_goes_on_where_the_time_was_over(capsys, scene, tmp_path, monkeypatch):
    answered = compare.answered

    def second_is_late(of, each, **how):
        if each.method.name == "rayleigh":
            monkeypatch.setattr("demheat.runtime.deadline.time.monotonic", lambda: 1e18)
        return answered(of, each, **how)

    words = "compare", scene, "--methods", "maxwell,rayleigh,bruggeman", "--out", tmp_path / "out"
    monkeypatch.setattr(compare, "answered", second_is_late)
    status, out, _ = run(capsys, *words, "--seconds", "1000")
    monkeypatch.undo()
    assert status == 1 and "bruggeman stopped: seconds = 1000 are over, in other methods" in out
    assert "before rayleigh, bruggeman got done: must be more, as --seconds 4000. Rows that are done stay" in out
    with open(tmp_path / "out" / "scene.csv", newline="") as file:
        assert [row["method"] for row in csv.DictReader(file)] == ["maxwell"]
    status, out, err = run(capsys, *words)
    assert status == 0 and "stopped" not in out and err == "rayleigh ...\nbruggeman ...\n"


def test_a_picture_without_answers_is_drawn_without_a_warning(capsys, scene, tmp_path):
    words = "--methods", "fem,bruggeman", "--seconds", "1e-9", "--out", tmp_path / "out"
    # Warnings are errors here.
    status, out, _ = run(capsys, "compare", scene, *words)
    # The coarse size of elements, as the file names none, in metres.
    assert status == 1 and re.search(r"as --knob fem.size=0.0\d+\. Rows", out)
    assert (tmp_path / "out" / "scene.png").exists()


def test_effective_without_an_answer(capsys, scene):
    status, out, err = run(capsys, "effective", scene, "--method", "fft", "--seconds", "1e-9")
    assert (status, out) == (1, "") and "seconds = 1e-09 are over, in fft; no answer is done" in err


def test_what_cannot_be_written_is_said_before_it_is_solved(capsys, scene, tmp_path, monkeypatch):
    monkeypatch.setattr(solve, "answered", lambda *_, **__: pytest.fail("solved"))
    for name, told in (("x.vtk", "the suffix must be one of"), ("none/x.vti", "there is no folder")):
        status, out, err = run(capsys, "solve", scene, "--method", "fft", "--write", tmp_path / name)
        assert (status, out) == (2, "") and told in err
    status, out, err = run(capsys, "solve", scene, "--method", "maxwell", "--write", tmp_path / "x.vti")
    assert (status, out) == (1, "") and "maxwell is a formula and has no field" in err


def test_finite_elements_write_their_mesh(capsys, scene, tmp_path):
    words = "--method", "fem-p1", "--knob", "size=0.03", "--no-interval", "--write", tmp_path / "x.vtu"
    status, _, err = run(capsys, "solve", scene, *words)
    assert (status, err) == (0, "") and (tmp_path / "x.vtu").stat().st_size > 1000
