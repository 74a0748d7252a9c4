"""Brackets hold what is known exactly, close in with the mesh, and refuse what they do not bound."""

import re
from types import SimpleNamespace

import fem_scenes  # noqa: F401, skips without gmsh
import numpy as np
import pytest

from demheat import gallery
from demheat.scene import Flux, Layer, Material, Scene, Sphere
from references import bracket, exact, multipole
from references.bracket import solver

# Scenes whose conductivity is known to 1e-8 and better; each with a width that its coarse mesh reaches with a factor of
# two to spare.
KNOWN = {
    "insulating": (gallery.sphere_in_cube(0.01, periodic=True), 3e-3),
    "pore": (gallery.simple_cubic(0.0, fraction=0.3), 3e-3),
    "contrast 1e6": (gallery.simple_cubic(1e6, fraction=0.3), 5e-2),
    "coated": (gallery.coated_sphere(), 2e-3),
    # Linear temperature and constant flux: what is left is the residual's margin.
    "slab": (gallery.slab(), 1e-6),
}


@pytest.mark.parametrize("name", KNOWN)
def test_the_exact_value_is_inside(name):
    scene, width = KNOWN[name]
    known, found = exact.solve(scene).conductivity, bracket.solve(scene, size=max(scene.size) / 8)
    assert found.lower <= known <= found.upper
    assert 0 < found.width < width
    # The true value is no end: 1 in 50 of the width off either.
    if width > 1e-4:
        assert 0.02 < (known - found.lower) / (found.upper - found.lower) < 0.98


@pytest.mark.slow
def test_many_spheres_nested_in_a_skewed_cell():
    core, coat = Material(20.0), Material(0.2)
    spheres = [
        Sphere((0.1, 0.4, 0.2), 0.25, coat),
        Sphere((0.12, 0.4, 0.18), 0.15, core),
        Sphere((0.6, 0.85, 0.7), 0.3, core),
    ]
    scene = Scene((1.0, 1.2, 0.9), Material(1.0), spheres[2:], gradient=(1.0, -2.0, 0.5))
    known = multipole.solve(scene, accuracy=1e-8).mean_flux @ np.array(scene.gradient) / -5.25
    found = bracket.solve(scene, size=0.15)
    assert found.lower < known < found.upper
    assert found.width < 4e-3  # 2.1e-3 was found
    # Nested ones, which multipoles do not know, beside finite elements ten times better than the bracket.
    scene = Scene(scene.size, scene.matrix, spheres, walls={"x-": 3.0, "x+": -1.0})
    found = bracket.solve(scene, size=0.1)
    from references import fem

    assert found.lower < fem.solve(scene, size=0.08).conductivity < found.upper
    assert found.width < 0.02


@pytest.mark.slow
def test_bounds_close_in():
    scene = gallery.sphere_in_cube(10.0)
    widths = [bracket.solve(scene, size=scene.size[0] / n).width for n in (8, 16)]
    # Theory 3 to 4 between regular meshes; second order, as from straight elements, would be a factor of 4.
    assert widths[0] > 6 * widths[1]


def test_a_width_beyond_any_mesh_is_refused_by_one_mesh(monkeypatch):
    """Without another mesh; what it says is the least is one that would be tried."""
    monkeypatch.setattr(solver, "free_memory", lambda: 2.0**33)
    found = SimpleNamespace(width=1e-2, stats={"elements": 1000})
    with pytest.raises(ValueError, match="width = 1e-09: takes some .* must be >= [0-9.e-]+ here") as said:
        solver._check_width(1e-9, found)
    least = float(re.search(">= ([0-9.e-]+)", str(said.value))[1])
    # One digit of it is printed.
    assert 1e-9 < least < 1e-2
    solver._check_width(1.5 * least, found)
    with pytest.raises(ValueError, match="width"):
        solver._check_width(least / 1.5, found)


@pytest.mark.slow
def test_a_width_is_reached():
    scene = gallery.sphere_in_cube(10.0)
    found = bracket.solve(scene, size=scene.size[0] / 6, width=1e-3)
    assert found.width <= 1e-3
    assert found.stats["size"] < scene.size[0] / 6
    assert found.lower < exact.solve(scene).conductivity < found.upper


def test_a_rough_flux_proves_less():
    """Far from solved, work squared over energy is above the true value: what is unbalanced has to count."""
    scene = gallery.laminate()
    known, found = exact.solve(scene).conductivity, bracket.solve(scene, size=scene.size[0] / 5, tolerance=1e-3)
    assert 0 < found.lower < known < found.upper
    without = found.lower / (1 - found.stats["unbalanced"] / 2) ** 2
    assert without > known


def test_units_and_load_change_nothing():
    scene = gallery.sphere_in_cube(10.0)
    here = bracket.solve(scene, size=scene.size[0] / 6)
    small = gallery.sphere_in_cube(10.0, edge=1e-9 * scene.size[0], temperatures=(1e6, 1e6 + 1e-3))
    there = bracket.solve(small, size=small.size[0] / 6)
    # The mesher works in unit lengths, but their rounding may change the mesh: a part of the width.
    assert there.lower == pytest.approx(here.lower, rel=here.width / 2)
    assert there.upper == pytest.approx(here.upper, rel=here.width / 2)


def test_nothing_conducts():
    void, size = Material(0.0), (1.0, 1.0, 1.0)
    found = bracket.solve(Scene(size, void, walls={"x-": 0.0, "x+": 1.0}), size=0.4)
    assert (found.lower, found.upper, found.width) == (0, 0, 0)
    # A layer of nothing across the load: the temperature jumps there, no heat flows.
    found = bracket.solve(
        Scene(size, Material(2.0), [Layer(0, 0.3, 0.6, void)], walls={"x-": 0.0, "x+": 1.0}),
        size=0.4,
        width=1e-3,  # is never reached, and not tried for long
    )
    assert found.lower == 0
    assert found.upper < 1e-9


@pytest.mark.parametrize(
    ("walls", "says"),
    [
        ({"y-": 0.0, "y+": Flux(1.0)}, "held"),
        ({"y-": 0.0}, "two opposite"),
        ({"y-": 1.0, "y+": 1.0}, "differ"),
    ],
)
def test_refusals(walls, says):
    scene = Scene((1.0, 1.0, 1.0), Material(1.0), [Sphere((0.5, 0.5, 0.5), 0.3, Material(2.0))], walls=walls)
    with pytest.raises(ValueError, match=says):
        bracket.solve(scene)
