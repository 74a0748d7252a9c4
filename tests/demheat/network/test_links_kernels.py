"""Only here: links of images whose rise or area is taken of another image."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from random_links import branch, each_link, random_links, received

from demheat.network.links_kernels import lengths, match_links, rise_along


@pytest.mark.twin
def test_rise_along_links():
    links, places = random_links(15)
    gradient, x = np.array([1.0, -2.0, 0.5]), np.random.default_rng(1).standard_normal(15)
    assert len(np.unique(places.image)) > 15
    for i, e, _, g in each_link(links):
        rise, *way = rise_along(i, e, links, places, gradient, x)
        # Rounding of coordinates and temperatures of order one.
        assert_allclose(way, branch(i, e, links, places), atol=1e-15)
        assert_allclose(g * rise, received(i, e, links, places, gradient, x), atol=1e-14 * max(g, 1.0))


@pytest.mark.twin
def test_links_get_the_mean_of_both_areas():
    links, places = random_links(20)
    rng = np.random.default_rng(4)
    kept = rng.random(len(links.indices)) > 0.1  # some facets are seen from one side only
    rows = np.repeat(np.arange(20), np.diff(links.indptr))[kept]
    indptr = np.concatenate([[0], np.cumsum(np.bincount(rows, minlength=20))])
    indices, image, area = links.indices[kept], places.image[kept], rng.random(kept.sum())
    matched = np.full(kept.sum(), np.nan)
    match_links(0, 20, indptr, indices, image, area, matched)
    seen = {}
    for p, q, code, a in zip(rows.tolist(), indices.tolist(), image.tolist(), area, strict=True):
        seen.setdefault((p, q, code), a)
    back = [
        seen.get((q, p, 26 - code)) for p, q, code in zip(rows.tolist(), indices.tolist(), image.tolist(), strict=True)
    ]
    right = [0.0 if b is None else 0.5 * (a + b) for a, b in zip(area, back, strict=True)]
    assert np.array_equal(matched, right)
    assert 0 < right.count(0.0) < len(right) / 2


@pytest.mark.twin
def test_lengths_of_links():
    links, places = random_links(20)
    found = np.full(len(links.indices), np.nan)
    for first, last in ((0, 7), (7, 20)):
        lengths(first, last, links.indptr, links.indices, places, found)
    right = [np.linalg.norm(branch(i, e, links, places)) for i, e, _, _ in each_link(links)]
    assert_allclose(found, right, rtol=0, atol=1e-15)  # rounding of coordinates of order one
