"""Only here: correlations of packings counted wrong, cut by walls, or told with errors that are none."""

from itertools import product

import numpy as np
import pytest
from crystals import distances, random_packing, simple_cubic
from numpy.testing import assert_allclose

from demheat.packing.base import make_packing
from demheat.packing.statistics import radial_distribution, two_point
from demheat.packing.statistics.regions import inscribed_box
from demheat.packing.walls import wall_distances

# Radial distribution


@pytest.mark.parametrize("periodic", [True, False])
def test_shells_of_a_simple_cubic_crystal(periodic):
    found = radial_distribution(simple_cubic(8, periodic=periodic), r_max=1.95, bins=13)
    edges = np.linspace(0, 1.95, 14)
    numbers = found.g * found.density * 4 / 3 * np.pi * np.diff(edges**3)
    expected = np.zeros(13)
    expected[[6, 9, 11]] = 6, 12, 8  # distances 1, sqrt 2, sqrt 3
    assert_allclose(numbers, expected, rtol=1e-12)
    assert found.origins == (512 if periodic else 64)  # depth > 1.95: beyond two layers of spheres


@pytest.mark.parametrize(
    ("domain", "periodic", "number", "r_max", "scaled"),
    [
        ("box", True, 600, 2.0, True),
        ("box", True, 1200, 3.2, False),  # 460 neighbours within .48: more than the buffer first holds
        ("box", (True, False, True), 600, 2.0, False),
        ("sphere", False, 600, 2.0, True),
        ("cylinder-y", False, 600, 2.0, False),
    ],
)
def test_pair_counts_are_those_of_brute_force(domain, periodic, number, r_max, scaled):
    packing = random_packing(3, number, periodic=periodic, domain=domain)
    r_max = r_max if scaled else 1.5 * r_max
    found = radial_distribution(packing, r_max=r_max, bins=40, scaled=scaled)
    largest, mean = packing.radii.max(), packing.radii.mean()
    origins = wall_distances(packing) > 2 * r_max * (largest if scaled else mean)
    unit = packing.radii + packing.radii[:, None] if scaled else np.full((number, number), 2 * mean)
    ratio, bins = distances(packing) / unit, dict(bins=40, range=(0, r_max))
    counts, edges = np.histogram(ratio[origins], **bins)
    twice = np.histogram(ratio[origins][:, origins], **bins)[0]
    np.fill_diagonal(unit, 0.0)
    density = 0 if np.all(periodic) else found.density  # of the core: tested with random points
    density = density or (number - 1) / packing.volume
    expected = density / (number - 1) * (unit[origins] ** 3).sum() * 4 / 3 * np.pi * np.diff(edges**3)
    assert found.origins == origins.sum() > 5
    assert_allclose(found.density, density, rtol=1e-14)
    assert_allclose(found.g, counts / expected, rtol=1e-11)  # differences of cubes
    # A pair of origins is one count of weight 2.
    assert_allclose(found.error, np.sqrt(counts + twice) / expected, rtol=1e-11)
    assert_allclose(found.r, (edges[1:] + edges[:-1]) / 2, rtol=1e-13)


@pytest.mark.parametrize("scaled", [False, True])
def test_random_points_have_no_correlation(scaled):
    for periodic in (True, False):
        packing = random_packing(4, 6000, periodic=periodic, radius=0.02)
        found = radial_distribution(packing, r_max=3.0, bins=30, scaled=scaled)
        kept = (found.error > 0) & (found.error < 0.1)  # inner bins hold too few pairs to be normal
        shared = 0.0 if periodic else 1 / np.sqrt(found.origins)  # error of the density of the core
        deviation = (found.g - 1)[kept] / np.hypot(found.error[kept], shared)
        # Standard normal: beyond 4 once in 16000; the mean square of 25 of them scatters by .3.
        assert kept.sum() > 20 and np.abs(deviation).max() < 4 and np.mean(deviation**2) < 2


# Two-point probability


def test_one_sphere_in_a_periodic_box():
    """S2 = phi (1 - 3 r/4R + r^3/16 R^3), 0 beyond 2R until images meet; the start slope is -surface/4 each way."""
    packing = make_packing([[0.1, 0.5, 0.9]], [0.2], (1, 1, 1), True, {})
    found = two_point(packing, r_max=1.25, points=26, lines=8000)
    x = found.r * 2  # r over R
    expected = found.phi * np.maximum(1 - 3 * x / 4 + x**3 / 16, 0.0) * (x < 2)
    assert_allclose(found.phi, 4 / 3 * np.pi * 0.2**3, rtol=1e-14)
    # Surface 4 pi R^2 of a unit box, in mean diameters of 0.4.
    assert_allclose(found.exact_slope, -np.pi * 0.2**2 * 0.4, rtol=1e-14)
    assert np.all(found.s2[:, x > 2 + 1e-9] == 0)
    # 4 standard errors: some 100 independent values. The errors themselves stay below 5 % of phi.
    assert np.all(np.abs(found.s2 - expected) <= 4 * found.error + 1e-15)
    assert np.all(np.abs(found.slope - found.exact_slope) <= 4 * found.slope_error)
    assert found.error.max() < 0.05 * found.phi and found.slope_error.max() < 0.05 * -found.exact_slope


def test_standard_errors_are_the_scatter_of_repeats():
    packing, along = random_packing(7, 100), np.random.default_rng(0).standard_normal((5, 3))
    found = [two_point(packing, along=along, r_max=1.0, points=3, lines=100, seed=seed) for seed in range(50)]
    for name, error in (("s2", "error"), ("slope", "slope_error")):
        variance = np.var([getattr(one, name) for one in found], axis=0, ddof=1)
        squares = np.mean([getattr(one, error) ** 2 for one in found], axis=0)
        # The root mean square of 5 directions of 50 values: 4.5 %, 4 of them.
        assert_allclose(np.sqrt(np.mean(variance / squares, axis=0)), 1.0, atol=0.18)


@pytest.mark.parametrize("domain", ["box", "cylinder-x", "sphere"])
def test_lines_keep_away_from_walls(domain):
    """Spheres outside the sampled box only, and close to all its sides: no line may meet one."""
    packing = random_packing(8, 3000, periodic=False, domain=domain, radius=0.015)
    margin = 8.0
    low, high = inscribed_box(packing, margin * packing.radii.mean())
    corners = packing._replace(centers=np.array(list(product(*zip(low, high, strict=True)))), radii=packing.radii[:8])
    assert_allclose(wall_distances(corners), margin * packing.radii.mean(), rtol=1e-12)  # as large as fits
    beyond = np.linalg.norm(np.maximum(np.maximum(low - packing.centers, packing.centers - high), 0), axis=1)
    kept = beyond > packing.radii
    hollow = packing._replace(centers=packing.centers[kept], radii=packing.radii[kept])
    margin *= packing.radii.mean() / hollow.radii.mean()
    found = two_point(hollow, margin=margin, points=3, lines=2000)
    assert np.all(found.s2 == 0)
    assert_allclose([found.phi, found.exact_slope], 0.0, atol=1e-15)  # what cut spheres leave by rounding
    # Filled, the same lines see the spheres.
    assert np.all(two_point(packing, margin=8.0, points=3, lines=200).s2 > 0)


def test_order_of_particles_does_not_matter():
    """Hand-made packings need not be sorted: both correlations must not rely on it."""
    packing = random_packing(10, 500)
    rng = np.random.default_rng(0)
    order = rng.permutation(500)
    moved = packing._replace(centers=packing.centers[order], radii=packing.radii[order])
    # Short enough a reach not to search all cells anyway.
    first, second = (radial_distribution(p, r_max=1.0).g for p in (packing, moved))
    assert_allclose(first, second, rtol=1e-12)
    first, second = (two_point(p, lines=200).s2 for p in (packing, moved))
    assert_allclose(first, second, rtol=1e-10)  # rounding of the images
