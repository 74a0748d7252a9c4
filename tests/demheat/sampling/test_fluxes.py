"""Only here: fluxes of cells with too few facets, and mean fluxes of links with unequal ends."""

from types import SimpleNamespace

import numpy as np
from numpy.testing import assert_allclose

import demheat.runtime.threads  # noqa: F401 (chooses the threading layer)
from demheat.conduction.steady import Solution
from demheat.network.base import Network
from demheat.sampling.fluxes import cell_fluxes, mean_flux


def test_flux_of_a_cell_with_too_few_facets_is_that_of_least_norm():
    """Two cells of which but the facet between them was left out: what crosses it is known, and nothing else."""
    none = np.empty(0)
    network = Network(
        centers=np.array([[0.25, 0.5, 0.5], [0.75, 0.5, 0.5]]),
        size=np.ones(3),
        indptr=np.array([0, 1, 2]),
        indices=np.array([1, 0], np.uint32),
        image=np.full(2, 13, np.uint8),
        conductance=np.full(2, 2.0),
        wall_particle=np.empty(0, np.int64),
        wall_side=np.empty(0, np.int64),
        wall_conductance=none,
        wall_area=none,
        wall_distance=none,
        volumes=np.full(2, 0.5),
        phase=np.zeros(2, np.int64),
        area=np.full(2, 0.5),
    )
    solution = Solution(np.array([0.0, 1.0]), np.zeros(3), none, none, {})
    # 2 W/K over 1 K through 0.5 m2; rounding of a pseudo-inverse.
    assert_allclose(cell_fluxes(network, solution), [[-4.0, 0.0, 0.0]] * 2, atol=1e-14)


def test_mean_flux_of_a_linear_temperature_between_walls():
    """T = x in two cells of unequal width that conduct 2: links and wall links all carry -2 W/m2."""
    x, none = np.array([0.2, 0.6]), np.empty(0)
    network = Network(
        centers=np.column_stack([x, [0.5, 0.5], [0.5, 0.5]]),
        size=np.ones(3),
        indptr=np.array([0, 1, 2]),
        indices=np.array([1, 0], np.uint32),
        image=np.full(2, 13, np.uint8),
        conductance=np.full(2, 2 / 0.4),
        wall_particle=np.array([0, 1]),
        wall_side=np.array([0, 1]),
        wall_conductance=none,
        wall_area=np.ones(2),
        wall_distance=np.array([0.2, 0.4]),
        volumes=np.array([0.4, 0.6]),
        phase=np.zeros(2, np.int64),
        area=np.ones(2),
    )
    solution = Solution(x, np.zeros(3), np.array([0.0, 1.0]), np.array([-2.0, 2.0]), {})
    assert_allclose(mean_flux(network, SimpleNamespace(volume=1.0), solution), [-2.0, 0.0, 0.0], atol=1e-15)
