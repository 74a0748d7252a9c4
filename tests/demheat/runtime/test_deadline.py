"""Only here: loops that do not look at the clock, and budgets that outlive their solve."""

import threading
import time
from importlib import import_module

import numpy as np
import pytest

import demheat
from demheat import LevelSet, Material, Scene, Torus, Union, damage, effective, gallery, solve
from demheat.cheapest.answers import Answer
from demheat.dem import solve_axes
from demheat.runtime import deadline, progress
from demheat.scene import Sphere, beats
from demheat.scene.shapes import patterns
from references import bracket, fem, fft, multipole
from references.bracket import voxels

SPHERE = gallery.sphere_in_cube(5.0)
CELL = gallery.sphere_in_cube(5.0, periodic=True)
METHODS = {
    "dem": lambda: solve(SPHERE, particles=1000),
    "amg": lambda: solve(SPHERE, particles=1000, solver="amg"),
    "fem": lambda: fem.solve(SPHERE, size=0.02),
    "fft": lambda: fft.solve(SPHERE, voxels=8),
    "fft-em": lambda: fft.solve(SPHERE, voxels=8, scheme="eyre-milton"),
    "multipole": lambda: multipole.solve(SPHERE),
}
# Where each looks more than once on its way.
AGAIN = {
    "dem": {"equations"},
    "amg": {"equations"},
    "fem": {"mesh", "assembly", "equations"},
    "fft": {"iterations"},
    "fft-em": {"iterations"},
    "multipole": {"multipoles"},
}


@pytest.mark.filterwarnings("ignore:gaps beside inclusions")
@pytest.mark.parametrize("name", METHODS)
def test_methods_end_when_the_time_is_over(name, monkeypatch):
    with pytest.raises(TimeoutError, match=r"^seconds = 1e-09 are over, in \w+"), demheat.budget(1e-9):
        METHODS[name]()
    looked = []
    for home in ("demheat.runtime.progress", "demheat.runtime.blocks"):
        monkeypatch.setattr(f"{home}.look", looked.append)
    with demheat.budget(1000.0):
        METHODS[name]()
    assert {each for each in looked if looked.count(each) > 1} >= AGAIN[name]


# Functions with a budget of their own, at what they do in a second or so.
TIMED = {
    "dem": lambda seconds: solve(SPHERE, particles=1000, seconds=seconds),
    "dem axes": lambda seconds: solve_axes(SPHERE, particles=1000, seconds=seconds),
    "fem": lambda seconds: fem.solve(SPHERE, size=0.05, order=1, seconds=seconds),
    "fem axes": lambda seconds: fem.solve_axes(SPHERE, size=0.05, order=1, seconds=seconds),
    "fft": lambda seconds: fft.solve(SPHERE, voxels=16, seconds=seconds),
    "fft axes": lambda seconds: fft.solve_axes(SPHERE, voxels=16, seconds=seconds),
    "multipole": lambda seconds: multipole.solve(SPHERE, seconds=seconds),
    "multipole axes": lambda seconds: multipole.solve_axes(SPHERE, seconds=seconds),
    "bracket": lambda seconds: bracket.solve(SPHERE, size=0.05, seconds=seconds),
    "bracket tensor": lambda seconds: bracket.solve_tensor(CELL, size=0.05, seconds=seconds),
    "voxels": lambda seconds: voxels.solve(SPHERE, voxels=4, seconds=seconds),
    "voxels tensor": lambda seconds: voxels.solve_tensor(CELL, voxels=4, seconds=seconds),
    "damage": lambda seconds: damage.solve(SPHERE, particles=1000, removed=0.1, seconds=seconds),
}


@pytest.mark.parametrize("name", TIMED)
def test_seconds_of_every_solve(name):
    with pytest.raises(TimeoutError, match=r"^seconds = 1e-09 are over"):
        TIMED[name](1e-9)
    assert not deadline.has_budget()
    with pytest.raises(ValueError, match="seconds = -1.0: must be a finite number > 0, or None"):
        TIMED[name](-1.0)
    TIMED[name](1000.0)


# What is done of shapes without formulas, and how often at least: rounds of spreading points, cells, Newton's steps.
SLOW = {
    "ring": ("points on a surface", patterns.ROUNDS),
    "balls": ("points on a surface", 2 * patterns.ROUNDS),
    "ball": ("a level set", 100),
}


@pytest.mark.filterwarnings("ignore:.*most of them in narrow gaps")
@pytest.mark.parametrize("name", SLOW)
def test_shapes_are_left_when_the_time_is_over(name, monkeypatch):
    # Points on surfaces beside gaps once took minutes whatever the budget was.
    good, unit = Material(20.0), (1.0, 1.0, 1.0)
    ring = [Torus((0.5, 0.5, 0.5), 0.35, 0.1, (0, 1, 0), good), Sphere((0.5, 0.5, 0.5), 0.2, Material(0.1))]
    balls = Union([Sphere((0.25, 0.5, 0.5), 0.2, good), Sphere((0.75, 0.5, 0.5), 0.2, good)], good)
    ball = LevelSet(lambda points: np.linalg.norm(points - 0.5, axis=1) - 0.3, ((0.1,) * 3, (0.9,) * 3), good)
    inclusions = {"ring": ring, "balls": [balls], "ball": [ball]}[name]
    scene, (doing, times) = Scene(unit, Material(1.0), inclusions, gradient=(0, 1, 0)), SLOW[name]
    with demheat.budget(1000.0):
        heard = []
        monkeypatch.setattr(beats, "_listeners", [*beats._listeners, heard.append])
        solve(scene, particles=100, allow_few=True)
    assert heard.count(doing) >= times
    with pytest.raises(TimeoutError, match="in this$"), demheat.budget(1e-9):
        beats.beat("this")


def test_nearest_points_are_sought_in_pieces(monkeypatch):
    rng, heard = np.random.default_rng(0), []
    points, samples = rng.random((20, 3)), rng.random((101, 3))
    found = patterns.nearest_of(points, samples)
    monkeypatch.setattr(patterns, "beat", heard.append)
    monkeypatch.setattr(patterns, "SOUGHT", 10)
    assert np.array_equal(patterns.nearest_of(points, samples), found) and len(heard) == 11


def test_a_warning_of_a_timed_function_is_of_the_line_that_called_it():
    with pytest.warns(UserWarning, match="gaps beside inclusions") as seen:
        fft.solve(SPHERE, voxels=8)
    assert seen[0].filename == __file__


def test_the_first_to_end_counts_and_none_is_left():
    with demheat.budget(1e-9), demheat.budget(1000.0), demheat.budget(None):
        with pytest.raises(TimeoutError, match=r"seconds = 1e-09 are over, in this"):
            deadline.look("this")
        with pytest.raises(TimeoutError, match="in that"), progress.stage("that"):
            pass
    with demheat.budget(1000.0), pytest.raises(TimeoutError, match="seconds = 1e-09"), demheat.budget(1e-9):
        deadline.look("this")
    with demheat.budget(5.0, begun=time.monotonic() - 6.0), pytest.raises(TimeoutError, match="seconds = 5 are"):
        deadline.look("this")
    deadline.look("this")
    assert not deadline.has_budget()


def test_other_threads_have_their_own():
    found = []
    with demheat.budget(1e-9):
        thread = threading.Thread(target=lambda: found.append(deadline.has_budget()))
        thread.start()
        thread.join()
    assert found == [False]


def test_effective_returns_the_narrowest_answer_that_is_done(monkeypatch):
    halves = iter([1.2, 0.5, 0.6])

    def answer(way, loads):
        half = next(halves, None)
        if half is None:
            raise TimeoutError("seconds = 5 are over, in cells")
        return Answer(40 * np.eye(3), half * np.eye(3), "stub")

    # The module has the name of its function.
    monkeypatch.setattr(import_module("demheat.cheapest.effective"), "answer", answer)
    words = r"effective: \w+: seconds = 5 are over, in cells"
    with pytest.warns(UserWarning, match=f"{words}; accuracy is 0.013 only"):
        found = effective(gallery.random_dispersion(10), accuracy=1e-2, method=["fft", "dem"], seconds=5.0)
    assert found.accuracy == 0.5 / 40 and found.upper[0, 0] == 40.5 and found.cut.endswith("in cells")
    with pytest.raises(TimeoutError, match=f"{words}; no answer is done"):
        effective(gallery.random_dispersion(10), accuracy=1e-2, method="fft", seconds=5.0)


def test_effective_keeps_within_its_seconds():
    with pytest.raises(TimeoutError, match="effective: fft: seconds = 1e-09 are over, in fft; no answer"):
        effective(SPHERE, method="fft", seconds=1e-9)
    assert effective(SPHERE, seconds=1000.0).cut == ""
