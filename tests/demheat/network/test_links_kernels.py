import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat.network.links_kernels import rise_along
from tests.demheat.random_links import branch, each_link, random_links, received


@pytest.mark.twin
def test_rise_along_links():
    links, places = random_links(15)
    gradient, x = np.array([1.0, -2.0, 0.5]), np.random.default_rng(1).standard_normal(15)
    assert len(np.unique(places.image)) > 15
    for i, e, _, g in each_link(links):
        way = np.full(3, np.nan)
        rise, square = rise_along(i, e, links, places, gradient, x, way)
        # Rounding of coordinates and temperatures of order one.
        assert_allclose(way, branch(i, e, links, places), atol=1e-15)
        assert_allclose(square, np.sum(way**2), rtol=1e-15)
        assert_allclose(g * rise, received(i, e, links, places, gradient, x), atol=1e-14 * max(g, 1.0))
