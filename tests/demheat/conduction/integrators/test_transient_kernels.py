"""Only here: kernels of steps in time beside their formulas, on random links."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from random_links import each_link, random_links

from demheat.conduction.integrators import transient_kernels as kernels

pytestmark = pytest.mark.twin

N = 50


@pytest.fixture(scope="module")
def balance():
    """Links, inverse capacities (some nodes are held) and heat; the rate of change at x besides."""
    rng = np.random.default_rng(0)
    links, _ = random_links(N)
    inverse = rng.uniform(0.5, 2.0, N) * (np.arange(N) % 9 != 4)
    heat, x = rng.standard_normal((2, N))
    rate = heat.copy()
    for i, _, j, g in each_link(links):
        rate[i] += g * (x[j] - x[i])
    return links, inverse, heat, x, inverse * rate


# Rounding of sums of some six numbers of order ten, in whatever order the compiler takes.
ROUNDING = {"rtol": 0, "atol": 1e-13}


def test_rates(balance):
    links, inverse, heat, x, rate = balance
    out = np.full(N, np.nan)
    kernels.rates(links, inverse, heat, x, out)
    assert_allclose(out, rate, **ROUNDING)
    assert np.all(out[inverse == 0] == 0.0)


def test_a_step_of_explicit_euler(balance):
    links, inverse, heat, x, rate = balance
    out = np.full(N, np.nan)
    kernels.forward(links, inverse, heat, 0.3, x, out)
    assert_allclose(out, x + 0.3 * rate, **ROUNDING)


def test_a_stage(balance):
    links, inverse, heat, x, rate = balance
    start, first, other = np.random.default_rng(1).standard_normal((3, N))
    right = start + 1.2 * (x - start) - 0.4 * (other - start) + 0.7 * rate + 0.2 * first
    kernels.stage(links, inverse, heat, (1.2, -0.4, 0.7, 0.2), start, first, x, other)
    assert_allclose(other, right, **ROUNDING)


def test_heat_of_held_nodes():
    rng = np.random.default_rng(2)
    row, node, side = rng.integers(0, 40, 60), rng.integers(40, N, 60), rng.integers(0, 5, 60)
    ties, x = kernels.Ties(row, node, rng.random(60), side), rng.standard_normal(N)
    before = rng.standard_normal(8)
    out = before.copy()
    kernels.received(ties, x, out)
    flow = ties.conductance * (x[node] - x[row])
    right = [before[wall] + flow[side == wall].sum() for wall in range(8)]
    assert_allclose(out, right, **ROUNDING)
