"""Moving sources in finite elements: where their heat goes, what is clipped, what is refused."""

import math

import numpy as np
import pytest
from fem_scenes import KINDS, UNIT, cube, last
from numpy.testing import assert_allclose

from demheat.scene import MovingCylinder, Scene
from references import fem, mesh
from references.fem import bricks, sources, space


@pytest.mark.parametrize("axis", [0, 2])
@pytest.mark.parametrize("kind", KINDS)
def test_a_source_is_where_it_should_be_with_all_its_power(axis, kind):
    of = Scene((1.0, 0.8, 0.7), UNIT, initial=0.0)
    elements = kind.get("elements")
    if elements:
        on = bricks.hexahedra(of, 0.15)
    else:
        on = space.tetrahedra(of, mesh.make(of, size=0.3, order=kind["order"]))
    source = MovingCylinder(axis, 0.3, 5.0, (0.4, 0.3), (0.1, 0.05))
    made = sources.deposit(
        of,
        on,
        source,
        2.0,
    )
    power = 5 * math.pi * 0.15**2 * of.size[axis]
    assert_allclose([made.heat.sum(), made.power, made.lost], [power, power, 0], atol=1e-14)
    # Shape functions reproduce linear functions: the centre of the heat is that of the cylinder.
    center = np.insert([0.6, 0.4], axis, of.size[axis] / 2)
    assert_allclose(made.heat @ on.points / power, center, atol=1e-12)


def test_second_moments_of_the_points_of_a_disc():
    points = sources.disc_points(9)
    assert len(points) == 3 * 81
    assert_allclose(points.T @ points / len(points), np.eye(2) / 4, atol=1e-12)
    assert np.linalg.norm(points, axis=1).max() < 1


def test_overlap_of_disc_and_rectangle():
    rng = np.random.default_rng(3)
    fine = (np.arange(800) + 0.5) / 800
    x, y = np.meshgrid(1.3 * fine, 0.7 * fine)
    for center in [*(rng.random((12, 2)) * [2.1, 1.5] - 0.4), np.array([0.0, 0.35])]:
        for radius in (0.1, 0.3, 0.9):
            brute = np.mean((x - center[0]) ** 2 + (y - center[1]) ** 2 < radius**2) * 1.3 * 0.7
            # Cells that the rim cuts: two times its length over the number of cells per length, half of them wrong by
            # chance; found below 2e-4.
            assert_allclose(sources.overlap(center, radius, (1.3, 0.7)), brute, atol=1e-3)
    assert_allclose(sources.overlap((0.0, 0.35), 0.3, (1.3, 0.7)), math.pi * 0.045, rtol=1e-12)
    assert_allclose(sources.overlap((0.65, 0.35), 9.0, (1.3, 0.7)), 0.91, rtol=1e-12)


def test_clipped_power_is_reported():
    source = MovingCylinder(2, 0.4, 10.0, (0.7, 0.5), (1.0, 0.0), clip=True)
    field = last(cube(sources=(source,)), [0.1, 0.3], elements="hexahedra", size=0.2, step=0.002)
    total = 10 * math.pi * 0.04 * 0.3
    heat = field.stats["heat_in"]["sources"]
    assert_allclose(heat + field.stats["heat_lost"], total, rtol=1e-12)
    # The axis ends on the wall: the part outside grows from nothing at .1 s to half at .3 s.
    distance = np.linspace(0.2, 0.0, 2001)
    outside = 0.04 * np.arccos(np.minimum(distance / 0.2, 1)) - distance * np.sqrt(np.maximum(0.04 - distance**2, 0))
    # Steps of 2 ms against a square root in time at .1 s.
    assert_allclose(field.stats["heat_lost"], 10 * np.mean(outside) * 0.2, rtol=2e-3)
    assert_allclose(field.stats["heat_change"], heat, rtol=1e-8)


def test_a_source_that_leaves_is_refused_before_any_work(monkeypatch):
    monkeypatch.setattr("references.fem.transient.make", lambda *a, **k: pytest.fail("meshed"))
    source = MovingCylinder(2, 0.4, 1.0, (0.3, 0.5), (1.0, 0.0))
    with pytest.raises(ValueError, match=r"leaves the body at 0\.5\d* s.*0\.8.*clip"):
        fem.evolve(cube(sources=(source,)), [0.1, 0.6])
    with pytest.raises(ValueError, match=r"leaves the body at 0 s"):
        fem.evolve(cube(sources=(MovingCylinder(1, 0.4, 1.0, (0.1, 0.5)),)), [0.1])
    # Its rim may touch the edge.
    sources.check_sources(cube(sources=(source,)), 0.5)
