"""Only here: contrasts that rounding drowns and the DEM goes on with, or refuses in vain."""

import pytest

from demheat import Layer, Material, Scene, dem, gallery, solve
from demheat.conduction import steady
from demheat.dem import options


def test_what_cannot_be_solved_is_refused_before_it_is_packed(monkeypatch):
    made, tiled = [], options.tiled
    monkeypatch.setattr(options, "tiled", lambda number, **how: made.append(number) or tiled(number, **how))
    words = r"a trial with 3000 particles fails already: .* contrast of 1.0e\+09: must be .* references.fem"
    for resistance in (0.0, 1e-3):
        scene = gallery.simple_cubic(1e9)
        (sphere,) = scene.inclusions
        resists = type(sphere)(sphere.center, sphere.radius, sphere.material, resistance=resistance)
        with pytest.raises(NotImplementedError, match=words):
            solve(Scene(scene.size, scene.matrix, [resists], gradient=scene.gradient))
    with pytest.raises(NotImplementedError, match=words):
        dem.solve_axes(gallery.simple_cubic(1e9))
    assert set(made) == {3000}


def test_what_can_be_solved_is_not_refused():
    """By symmetry the sphere's temperature is zero, or heat passes the good conductor from end to end."""
    # Exactly 51.236 at infinity.
    assert solve(gallery.sphere_in_cube(1e9), particles=4000).conductivity == pytest.approx(51.236, rel=1e-3)
    good = Layer(0, 0.25, 0.5, Material(1e9))
    along = Scene((1.0, 1.0, 1.0), Material(1.0), [good], gradient=(0.0, 1.0, 0.0))
    assert solve(along, particles=4000).conductivity == pytest.approx(0.25e9, rel=1e-6)


def test_multigrid_in_vain_is_followed_by_the_diagonal(monkeypatch):
    """Single precision, in which multigrid works, may never see what is left at high contrasts."""
    scene = gallery.simple_cubic(3e6)
    right = solve(scene, particles=2000, solver="cg")
    monkeypatch.setattr(steady, "AMG_UNKNOWNS", 0)
    monkeypatch.setattr(steady, "MOST_MULTIGRID", 3)
    field = solve(scene, particles=2000)
    assert field.stats["solver"] == "cg" and field.stats["iterations"] == right.stats["iterations"] + 3
    # The tolerance of both.
    assert field.conductivity == pytest.approx(right.conductivity, rel=1e-7)
    with pytest.raises(RuntimeError, match=r"solve_steady \(amg\): .* after 3 iterations"):
        solve(scene, particles=2000, solver="amg")
    # Below that contrast it goes on until it is done.
    assert solve(gallery.simple_cubic(100.0), particles=2000).stats["solver"] == "amg"
