"""Only here: spheres that a box, a cylinder or a ball cuts, of a wrong volume."""

import numpy as np
import pytest
from crystals import face_centred, random_packing, simple_cubic
from numpy.testing import assert_allclose

from demheat.packing.statistics import packing_fraction
from demheat.packing.statistics.regions import _lens_areas, _spheres_in_cylinder, spheres_in_box
from demheat.packing.walls import walls
from demheat.scene.bodies import nearest_wall


def test_spheres_are_cut_exactly():
    """Against chords summed on a fine grid; the surface is the growth of the volume with the radius."""
    rng = np.random.default_rng(0)
    centers, radii = rng.uniform(-0.8, 0.8, (16, 3)), rng.uniform(0.2, 1.0, 16)
    low, high = np.array([-0.5, -0.3, -0.6]), np.array([0.4, 0.7, 0.3])
    volumes, surfaces = spheres_in_box(centers, radii, low, high)
    m, sides = 400, high - low
    x, y = (low[a] + (np.arange(m) + 0.5) / m * sides[a] for a in (0, 1))
    for c, r, volume in zip(centers, radii, volumes, strict=True):
        half = np.sqrt(np.maximum(r**2 - (x[:, None] - c[0]) ** 2 - (y - c[1]) ** 2, 0.0))
        chord = np.maximum(np.minimum(c[2] + half, high[2]) - np.maximum(c[2] - half, low[2]), 0.0) * (half > 0)
        # Midpoint rule with kinks: second order, h^2 = 6e-6 times lengths below 1.
        assert_allclose(volume, chord.mean() * sides[0] * sides[1], atol=6e-6)
    grown, shrunk = (spheres_in_box(centers, radii + h, low, high)[0] for h in (1e-5, -1e-5))
    # Central difference: h^2 and rounding 1e-16/h, both 1e-10 times the curvature.
    assert_allclose(surfaces, (grown - shrunk) / 2e-5, atol=1e-7)
    whole = spheres_in_box(centers, radii, np.full(3, -np.inf), np.full(3, np.inf))
    assert_allclose(whole, [4 / 3 * np.pi * radii**3, 4 * np.pi * radii**2], rtol=1e-14)  # rounding


def test_fraction_of_crystals():
    # Rounding of a sum over few hundred spheres, each cut by a difference of terms of order 1.
    assert_allclose(packing_fraction(face_centred()), np.pi * np.sqrt(2) / 6, rtol=1e-13)
    walled = simple_cubic(periodic=False)
    # Faces of the core between spheres, through their centres, and halfway: mirror planes first, then a cap of height
    # r/2 = 5 pi/24 r^3 less per sphere of the outer layers, which the box then shares.
    for margin in (0.0, 1.0, 2.0, 3.0):
        assert_allclose(packing_fraction(walled, margin=margin), np.pi / 6, rtol=1e-13)
    slab = simple_cubic(periodic=(True, True, False))
    cap = 5 * np.pi / 24 * 0.5**3
    assert_allclose(packing_fraction(slab, margin=0.5), (np.pi / 6 * 6 - 2 * cap) / 5.5, rtol=1e-13)


def test_spheres_in_a_cylinder_are_the_sum_of_their_discs():
    rng = np.random.default_rng(2)
    radii = rng.uniform(0.1, 0.4, 30)
    distance = 1 + rng.uniform(-1.1, 1.1, 30) * radii
    low, high = -rng.uniform(0, 1.5, 30) * radii, rng.uniform(0, 1.5, 30) * radii
    found = _spheres_in_cylinder(distance, radii, 1.0, low, high)
    low, high = np.maximum(low, -radii), np.minimum(high, radii)
    z = low + (high - low) * ((np.arange(20000) + 0.5) / 20000)[:, None]
    areas = _lens_areas(distance, np.sqrt(radii**2 - z**2), 1.0)
    # Midpoint rule, second order: 2.5e-9 times the curvature.
    assert_allclose(found, areas.mean(axis=0) * (high - low), atol=1e-8)


@pytest.mark.parametrize("domain", ["sphere", "cylinder-y"])
def test_fraction_of_round_cores(domain):
    packing = random_packing(1, 40, periodic=False, domain=domain, radius=0.1)
    # Two that fill the core or nearly so, one of them around it.
    packing = packing._replace(centers=np.vstack((packing.centers[1:], packing.size / 2)))
    packing.radii[[0, -1]] = 0.45
    margin = 0.1 / packing.radii.mean()
    m = 100
    at = (np.indices((m, m, m)).reshape(3, -1).T + 0.5) / m
    depth = nearest_wall(at, walls(packing), domain, packing.size)
    at, found = at[depth >= 0.1], 0.0
    for c, r in zip(packing.centers, packing.radii, strict=True):
        found += np.count_nonzero(((at - c) ** 2).sum(axis=1) < r * r)
    # Counts of points err by the random cut of cells of 1e-6: both volumes were found right to 5e-4.
    core = {"sphere": 4 / 3 * np.pi * 0.4**3}.get(domain, np.pi * 0.4**2 * 0.8)
    assert_allclose(len(at) / m**3, core, rtol=1e-3)
    assert_allclose(packing_fraction(packing, margin=margin) * core, found / m**3, rtol=1e-3)
