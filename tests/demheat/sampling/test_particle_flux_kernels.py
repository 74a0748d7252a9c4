"""Only here: parts of a link's heat that go to the other end."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from random_links import branch, each_link, random_links, received

from demheat.sampling import particle_flux_kernels as kernels


@pytest.mark.twin
@pytest.mark.parametrize("split", [kernels.HALF, kernels.RADII, kernels.CELL])
def test_moments_of_the_parts_of_links(split):
    n, gradient = 30, np.array([1.0, -2.0, 0.5])
    links, places = random_links(n)
    rng = np.random.default_rng(1)
    x, radii, distance = rng.standard_normal(n), rng.uniform(0.5, 2.0, n), rng.random(len(links.indices))
    right, flow = np.zeros((n, 3)), np.full((n, 3), np.nan)
    for i, e, j, _ in each_link(links):
        b = branch(i, e, links, places)
        share = {
            kernels.HALF: 0.5,
            kernels.RADII: radii[i] / (radii[i] + radii[j]),
            kernels.CELL: distance[e] / np.linalg.norm(b),
        }[split]
        right[i] += share * received(i, e, links, places, gradient, x) * b
    kernels.shared_moments(0, len(x), links, places, gradient, x, radii, distance, split, flow)
    # Rounding of sums of some six numbers of order ten.
    assert_allclose(flow, right, rtol=0, atol=1e-13)
