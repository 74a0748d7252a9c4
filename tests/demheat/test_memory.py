"""What the DEM says that it will take, before it begins."""

import pytest

from demheat import Laguerre, Layer, Material, Scene, gallery, on_progress, progress, solve
from demheat.dem.memory import BYTES, expected
from demheat.dem.options import Particles

SCENE = gallery.sphere_in_cube(5.0)


def test_it_goes_with_particles_and_twins():
    plain, twins = Laguerre(conforming=False), Laguerre()
    few, many = (Particles(particles=n, seed=0) for n in (10_000, 1_000_000))
    assert expected(SCENE, plain, many) == 100 * expected(SCENE, plain, few) == BYTES["laguerre"] * 1e6
    # A third of a square of the edge and more of surface: of 1e6 particles 34 521 twins more than gave way (docs/mpi).
    unknowns = expected(SCENE, twins, many) / BYTES["laguerre"]
    assert unknowns == pytest.approx(1_034_521, rel=5e-3)
    assert expected(SCENE, twins, few) / BYTES["laguerre"] == pytest.approx(
        solve(SCENE, particles=10_000).stats["unknowns"], rel=0.05
    )


def test_layers_as_wide_as_the_box_count_as_such():
    layer = Scene((1.0, 1.0, 1.0), Material(1.0), [Layer(0, 0.4, 0.6, Material(5.0))], gradient=(1.0, 0.0, 0.0))
    assert 1.0 < expected(layer, Laguerre(), Particles(particles=10**6, seed=0)) / BYTES["laguerre"] / 1e6 < 1.1


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
    assert 1000 * BYTES["laguerre"] < needed * 2**20 < 2000 * BYTES["laguerre"]
    assert f"DEM, about {needed / 1024:.2g} GiB" in heard
