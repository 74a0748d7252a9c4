"""Only here: memory of the DEM told before it begins, off what was measured."""

import pytest

from demheat import Laguerre, Layer, Material, Scene, gallery, on_progress, solve
from demheat.dem.options import Particles, expected_bytes, expected_unknowns
from demheat.runtime import limits, progress

SCENE = gallery.sphere_in_cube(5.0)


def wanted(number):
    return Particles(particles=number, seed=0)


def test_unknowns_are_particles_and_twins():
    assert expected_unknowns(SCENE, Laguerre(conforming=False), wanted(1000)) == 1000
    # As docs/decisions/mpi.md has it, and a small one.
    assert expected_unknowns(SCENE, Laguerre(), wanted(10**6)) == pytest.approx(1_034_521, rel=5e-3)
    field = solve(SCENE, particles=3000)
    assert expected_unknowns(SCENE, Laguerre(), wanted(3000)) == pytest.approx(field.stats["unknowns"], rel=0.1)
    # A layer's faces end with the box.
    layer = Scene((1.0, 1.0, 1.0), Material(1.0), [Layer(0, 0.4, 0.6, Material(5.0))], gradient=(1.0, 0.0, 0.0))
    assert 1.0 < expected_unknowns(layer, Laguerre(), wanted(10**6)) / 10**6 < 1.1


def test_bytes_are_those_that_were_found():
    # Of the whole solves of docs/decisions/memory.md: 212 thousand and 1.03 million unknowns.
    assert expected_bytes(211_820) / 211_820 == pytest.approx(929, rel=0.01)
    assert expected_bytes(1_034_501) / 1_034_501 == pytest.approx(678, rel=0.01)


def test_a_field_knows_it_and_a_large_solve_says_it(monkeypatch):
    heard = set()
    for name in ("SILENT", "PAUSE", "WAIT"):
        monkeypatch.setattr(progress, name, 0.0)
    on_progress(lambda report: heard.update((*report.within, report.stage)))
    try:
        field = solve(SCENE, particles=1000)
        assert heard and not any("GiB" in each for each in heard)
        monkeypatch.setattr(progress, "LARGE", 0)
        solve(SCENE, particles=1000)
    finally:
        on_progress(None)
    needed = field.stats["expected_mib"]
    assert needed * 2**20 == expected_bytes(expected_unknowns(SCENE, Laguerre(), wanted(1000)))
    assert f"DEM, about {needed / 1024:.2g} GiB" in heard


def test_a_refusal_names_what_would_do(monkeypatch):
    monkeypatch.setattr(limits, "free_memory", lambda: 2.0**33)
    told = r"particles = 100000000: takes 46.6 GiB .* 8 GiB are free; must be at most about 1.72e\+07 here"
    with pytest.raises(ValueError, match=told + r", or demheat\.mpi"):
        solve(SCENE, particles=10**8)
    with pytest.raises(ValueError, match=told + "$"):
        solve(SCENE, particles=10**8, law="platonic")
