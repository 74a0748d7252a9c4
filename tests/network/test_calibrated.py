import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat.network.base import row_numbers
from demheat.network.calibrated import contact_facets
from demheat.packing.relax import relax


@pytest.fixture(scope="module")
def packing():
    return relax(1000, seed=3)


def test_links_are_symmetric_and_carry_the_papers_surface(packing):
    facets = contact_facets(packing)
    rows = row_numbers(facets.indptr)
    pairs = {(p, q): a for p, q, a in zip(rows.tolist(), facets.indices.tolist(), facets.area, strict=True)}
    for (p, q), area in pairs.items():
        assert pairs[q, p] == area
        assert_allclose(area, np.pi * (0.5 * (packing.radii[p] + packing.radii[q])) ** 2, rtol=1e-14)


def test_mean_coordination_and_policy(packing):
    kept = np.diff(contact_facets(packing, coordination=7.5, least_links=0).indptr)
    joined = np.diff(contact_facets(packing, coordination=7.5, least_links=2).indptr)
    # The gap is the midpoint between two pair distances: Z is met to one pair, 2/n.
    assert_allclose(kept.mean(), 7.5, atol=2 / 1000 + 1e-12)
    assert kept.min() < 2 <= joined.min()
    assert np.all(joined >= kept)


def test_volumes_fill_the_box(packing):
    assert_allclose(contact_facets(packing).volumes.sum(), 1.0, rtol=1e-12)


def test_wall_contacts():
    packing = relax(1000, periodic=False, seed=3)
    facets = contact_facets(packing)
    assert set(facets.wall_side) == set(range(6))
    x = packing.centers[facets.wall_particle, facets.wall_side // 2]
    height = np.where(facets.wall_side % 2, 1.0 - x, x)
    assert np.all(height <= packing.radii[facets.wall_particle] * 1.0011)
