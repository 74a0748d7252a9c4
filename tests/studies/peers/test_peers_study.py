"""What the study of programs makes of its rows."""

import shutil

import pandas as pd
import pytest

from studies import peers
from studies.harness import replay
from studies.peers import cases, figure, means, packages, python_elements, tables

HERTZ = [case for case in peers.CASES if case["name"] == "grains" and case["scene"].endswith("Hertz radius")]


def rows(*found):
    columns = ("name", "given", "scene", "size", "order", "conductivity", "error_percent", "cpu_s")
    return pd.DataFrame([dict(zip(columns, row, strict=True)) for row in found])


@pytest.mark.parametrize("case", HERTZ, ids=lambda case: case["scene"])
def test_our_beds_warm_up(case):
    """A bed at random has no layers to choose; a row whose warm-up raises has failed."""
    peers.warm_up(**case)


@pytest.mark.parametrize("name", peers.PROGRAMS)
def test_a_program_that_is_not_here_says_nothing_of_stored_rows(name, monkeypatch):
    """Else `accept` would put its absence in the place of what it gave where it was."""
    program = peers.program(name)
    monkeypatch.setattr(shutil, "which", lambda command: None)
    for module in (program, packages, python_elements):
        monkeypatch.setattr(module, "python_of", lambda *names: None, raising=False)
    note = program.missing()
    assert note is None or replay.absent({"status": "unsupported", "note": note}), note


def test_a_row_that_another_beats_in_both_is_not_drawn():
    drawn = figure.front(
        rows(*(("a", "mesh", "b", 0.1, 1, 1.0, e, c) for e, c in ((3, 1), (-4, 2), (2, 3), (0.5, 2.5))))
    )
    assert drawn["cpu_s"].tolist() == [1, 2.5]


def test_elements_of_one_degree_on_one_mesh_are_compared():
    mine = [("fem-p1", "body", "s", 0.1, 1, 2.0, 0, 1), ("fem-straight", "body", "s", 0.1, 2, 1.0, 0, 1)]
    there = [("getdp", "mesh", "s", 0.1, 1, 2.02, 0, 1), ("getdp", "mesh", "s", 0.1, 2, 1.03, 0, 1)]
    # Of another size, body or kind: nothing to compare with.
    other = [("getdp", "mesh", "s", 0.2, 1, 9.0, 0, 1), ("getdp", "mesh", "t", 0.1, 1, 9.0, 0, 1)]
    volumes = [("openfoam", "mesh", "s", 0.1, None, 9.0, 0, 1)]
    assert means.same_mesh(rows(*mine, *there, *other, *volumes)) == {"getdp": pytest.approx(0.03)}


def test_who_is_ahead_at_an_error():
    mine = [("fem", "body", "half 10", 0.1, 2, 1.0, 0.05, 2.0), ("fem", "body", "half 10", 0.2, 2, 1.0, 0.5, 0.1)]
    other = [("ngsolve", "body", "half 10", 0.1, 3, 1.0, 0.09, 1.0)]
    parts = [("petsc", "network", "half 10", 0.1, 1, 1.0, 0.0, 0.001)]
    # The DEM's packing is there already.
    kept = [("dem", "body", "half 10", None, None, 1.0, 0.01, 0.01)]
    assert means.ahead(rows(*mine, *other, *parts, *kept)) == {"half 10": 0.5}
    assert means.ahead(rows(*mine, ("ngsolve", "body", "half 10", 0.1, 3, 1.0, 0.2, 1.0))) == {"half 10": float("inf")}


def test_one_body_is_seen_at_every_resolution():
    every = [
        {"name": "a", "given": "image", "scene": scene, "n": n, "order": order, "method": "a"}
        for scene in ("sphere 10", "half 10", "pore", "layers along")
        for n in (64, 16, 32)
        for order in (1, 2)
    ]
    kept = {(case["scene"], case["n"], case["order"]) for case in cases.thinned(every)}
    # Elements of second degree on images end at 32.
    fine = {("sphere 10", n, 1) for n in (16, 32, 64)} | {("sphere 10", n, 2) for n in (16, 32)}
    assert kept == fine | {("half 10", 16, 1), ("pore", 16, 1)}


def test_ways_of_one_program_are_told_apart():
    found = pd.DataFrame(
        [
            {"name": "puma", "given": "image", "scene": "pore", "n": 16, "by": by, "error_percent": error}
            | {"cpu_s": 1.0, "peak_mib": 1.0, "unknowns": 1.0}
            for by, error in (("fv", 1.0), ("fe", 2.0))
        ]
    )
    lines = tables.lines(found)
    assert lines["program"].tolist() == ["PuMA, fv", "PuMA, fe"] and lines["pore"].tolist() == [1.0, 2.0]


def test_abilities_are_the_best_of_each_body_and_the_worst_of_bodies():
    found = pd.DataFrame(
        [
            {"name": "fem", "given": "body", "scene": "chain, disc", "status": "ok", "error_percent": -3.0},
            {"name": "fem", "given": "body", "scene": "chain, disc", "status": "ok", "error_percent": 1.0},
            {"name": "fem", "given": "body", "scene": "random bed, disc", "status": "ok", "error_percent": -2.0},
            {"name": "fem", "given": "body", "scene": "pore", "status": "unsupported", "error_percent": None},
            {"name": "fem", "given": "body", "scene": "coated", "status": "failed", "error_percent": None},
        ]
    )
    (line,) = tables.abilities(found).to_dict("records")
    assert (line["grains, discs"], line["pore"], line["coat"], line["sphere"]) == ("2", "refused", "", "")
