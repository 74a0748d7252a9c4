"""Only here: helpers that compile for other types, outlive their caller or keep it waiting."""

import os

import numpy as np
import pytest

from demheat import Laguerre, Platonic
from demheat.conduction.steady import solve_checked
from demheat.dem import warm
from demheat.network.base import FEW
from demheat.network.laguerre import laguerre


def test_the_lattice_is_as_the_tessellation_would_have_it():
    """Kernels are compiled for types: unlike ones would be compiled in vain."""
    packing, facets = warm.lattice()
    cut = laguerre(packing.centers, packing.radii**2, packing.size, periodic=False)
    for name in ("indptr", "indices", "image", "area", "distance", "wall_particle", "wall_side", "volumes"):
        ours, theirs = getattr(facets, name), getattr(cut, name)
        assert (ours.dtype, ours.ndim, ours.flags.c_contiguous) == (
            theirs.dtype,
            theirs.ndim,
            theirs.flags.c_contiguous,
        )
    np.testing.assert_array_equal(facets.indptr, cut.indptr)
    assert facets.wall_area.sum() == pytest.approx(6.0) and cut.wall_area.sum() == pytest.approx(6.0)
    np.testing.assert_allclose(facets.volumes, cut.volumes, rtol=1e-12)  # rounding


def test_parts_are_done_once_and_failures_are_left_to_others(tmp_path):
    done = []

    def good():
        done.append("good")

    def bad():
        raise RuntimeError

    warm.work_off(tmp_path, [bad, good])
    assert all(warm._done_file(tmp_path, part).exists() for part in (bad, good))
    warm.work_off(tmp_path, [good])
    assert done == ["good"]


def test_the_lattice_needs_no_iteration():
    network, scene = warm._network()
    assert solve_checked(network, scene, solver="cg", tolerance=1e-8).stats["iterations"] == 0


def test_the_lattice_is_no_small_one():
    assert warm.SIDE**3 > FEW


def test_all_parts_run():
    for part in warm.PARTS:
        part()


def test_parts_are_those_that_a_solve_needs():
    assert warm.parts_of(Laguerre(), 100_000) == warm.PARTS
    assert warm.parts_of(Laguerre(), 10_000) == (warm.cells, warm.steady)
    assert warm.parts_of(Laguerre(), 10_000, steady_state=False) == (warm.cells,)
    assert warm.parts_of(Laguerre(), 1000) == ()
    assert warm.parts_of(Laguerre(conforming=False), 1000) == (warm.cells, warm.steady)
    assert warm.parts_of(Platonic(), 100_000) == ()
    with warm.Helper(()) as helper:
        assert helper.process is None


def test_no_helper_in_tests_nor_without_need():
    assert os.environ["DEMHEAT_WARM"] == "0"
    with warm.Helper(warm.PARTS) as helper:
        assert helper.process is None
        helper.join()


def test_a_helper_ends_with_its_caller(monkeypatch):
    monkeypatch.setattr(warm, "_useful", lambda: True)
    with warm.Helper(warm.PARTS) as helper:
        process, folder = helper.process, helper.folder
        assert process.poll() is None and os.path.isdir(folder)
    assert process.poll() is not None and not os.path.exists(folder)


def test_the_caller_does_what_nobody_has_begun_and_waits_for_the_rest(monkeypatch):
    class Process:
        looks = 0

        def poll(self):
            self.looks += 1
            if self.looks == 3:
                warm._done_file(helper.folder, first).touch()

        def kill(self):
            pass

        wait = kill
        stdin = open(os.devnull)  # noqa: SIM115 - closed by the helper

    def first():
        raise AssertionError("begun by the other one")

    def second():
        done.append("second")

    done = []
    monkeypatch.setattr(warm, "_useful", lambda: True)
    monkeypatch.setattr(warm, "POLL", 0.0)
    monkeypatch.setattr(warm.subprocess, "Popen", lambda *_, **__: Process())
    with warm.Helper((first, second)) as helper:
        (warm.Path(helper.folder) / "first").touch()
        helper.join(second)
        assert done == ["second"] and helper.process.looks == 0
        helper.join()
        assert helper.process.looks == 3


def test_a_helper_that_cannot_start_does_no_harm(monkeypatch):
    monkeypatch.setattr(warm, "_useful", lambda: True)
    monkeypatch.setattr(warm.sys, "executable", "/nowhere/python")
    with warm.Helper(warm.PARTS) as helper:
        helper.join()
        assert helper.process is None
    assert not os.path.exists(helper.folder)
