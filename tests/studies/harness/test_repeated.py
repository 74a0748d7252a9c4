"""Short runs are repeated from where the first began; the least cost counts."""

import functools
import sys
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

from demheat.packing import cache
from demheat.packing.base import Packing
from studies.harness import repeated


def scripted(monkeypatch, *costs, takes=0.01):
    """Have calls cost what is written here, each so many seconds of the clock."""
    clock, left = [0.0], list(costs)

    def measured(run, **case):
        clock[0] += takes
        cpu, peak = left.pop(0)
        cost = {"wall_s": takes, "cpu_s": cpu, "peak_mib": peak, "base_mib": 50.0 + len(left), "peak_by": "VmHWM"}
        return run(**case), cost

    monkeypatch.setattr(repeated, "measured", measured)
    monkeypatch.setattr(repeated, "time", SimpleNamespace(perf_counter=lambda: clock[0]))


def test_the_least_of_five_counts(monkeypatch):
    scripted(monkeypatch, (0.3, 8.0), (0.2, 1.0), (0.25, 0.0), (0.21, 0.0), (0.26, 0.0), (0.1, 0.0))
    calls = iter(range(9))
    metrics, cost = repeated.measured_again(lambda x: {"call": next(calls), "x": x}, {"x": 4})
    assert metrics == {"call": 1, "x": 4} and cost["cpu_s"] == 0.2 and cost["repeats"] == 5
    assert cost["cpu_spread"] == pytest.approx(0.5)
    # Memory is the first call's: what it leaves is there for the others.
    assert cost["peak_mib"] == 8.0 and cost["base_mib"] == 55.0


@pytest.mark.parametrize(("takes", "calls"), [(0.05, 5), (0.15, 4), (0.3, 2), (0.5, 1), (7.0, 1)])
def test_a_long_run_is_not_repeated(monkeypatch, takes, calls):
    scripted(monkeypatch, *[(takes, 0.0)] * 9, takes=takes)
    _, cost = repeated.measured_again(lambda: {}, {})
    assert cost["repeats"] == calls and ("cpu_spread" in cost) == (calls > 1)


def test_a_study_may_ask_for_one_call(monkeypatch):
    scripted(monkeypatch, (0.1, 0.0))
    assert repeated.measured_again(lambda: {}, {}, most=1)[1]["repeats"] == 1


def test_costs_that_a_study_measures_itself_decide(monkeypatch):
    scripted(monkeypatch, (0.1, 0.0), (0.2, 0.0), (0.3, 0.0), (0.3, 0.0), (0.3, 0.0))
    own = iter([3.0, 2.0, 1.0, 2.0, 2.0])
    metrics, cost = repeated.measured_again(lambda: {"cpu_s": next(own), "peak_mib": 7.0}, {})
    assert metrics["cpu_s"] == 1.0 and cost["cpu_spread"] == 2.0


def test_a_refusal_is_heard_once(monkeypatch):
    scripted(monkeypatch, (0.1, 0.0))
    metrics, cost = repeated.measured_again(lambda: {"status": "unsupported", "note": "why"}, {})
    assert metrics["status"] == "unsupported" and cost["repeats"] == 1


def test_what_references_keep_is_forgotten(monkeypatch):
    def function(name):
        made = functools.lru_cache(lambda: object())
        made.__module__ = name
        return made

    for name in ("references.kept_by_a_test", "studies.kept_by_a_test", "studies.harness.kept_by_a_test"):
        monkeypatch.setitem(sys.modules, name, ModuleType(name))
        sys.modules[name].mine, sys.modules[name].imported = function(name), function("demheat.declared")
    modules = [sys.modules[name] for name in sys.modules if name.endswith("kept_by_a_test")]
    before = [(each.mine(), each.imported()) for each in modules]
    repeated.forget()
    assert [each.mine() is old for each, (old, _) in zip(modules, before, strict=True)] == [False, False, True]
    assert all(each.imported() is old for each, (_, old) in zip(modules, before, strict=True))


def test_each_call_works_all_of_it_out(monkeypatch):
    module = ModuleType("references.kept_by_a_test")
    module.tables = functools.lru_cache(lambda: object())
    module.tables.__module__ = module.__name__
    monkeypatch.setitem(sys.modules, module.__name__, module)
    seen = []
    repeated.measured_again(lambda: seen.append(module.tables()) or {}, {}, most=3, seconds=60.0)
    assert len({id(each) for each in seen}) == len(seen) == 3


@pytest.mark.parametrize("kept", [False, True])
def test_packings_of_a_first_run_are_not_free_in_the_next(kept, tmp_path, monkeypatch):
    monkeypatch.setenv("DEMHEAT_CACHE", str(tmp_path))

    def make():
        return Packing(np.zeros((1, 3)), np.ones(1), np.ones(3), np.ones(3, dtype=bool), {})

    def run(name):
        return {"cached": [cache.cached(make, {"name": each}).provenance["cached"] for each in ("old", name)]}

    cache.cached(make, {"name": "old"})
    if kept:
        run("new")
    seen = []
    repeated.measured_again(lambda **case: seen.append(run(**case)) or {}, {"name": "new"}, most=3, seconds=60.0)
    # The old one comes from the folder each time; the new one too only if it was there before the first run.
    assert [each["cached"] for each in seen] == [[True, kept]] * 3
    assert run("new")["cached"] == [True, True] and len(list(tmp_path.iterdir())) == 2
