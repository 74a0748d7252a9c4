"""Only here: the two ends of a link in series swapped, which no homogeneous body shows."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from demheat.network.base import Facets
from demheat.network.interface import connect, link_conductivity
from demheat.packing.base import make_packing


def test_harmonic_is_resistances_in_series():
    k = link_conductivity(np.array([2.0]), np.array([6.0]), np.array([0.25]))
    assert_allclose(k, 1.0 / (0.25 / 2.0 + 0.75 / 6.0), rtol=1e-15)


def test_equal_shares_give_the_papers_mean():
    here, there = np.array([195.0, 1.0]), np.array([1500.0, 7.0])
    assert_allclose(link_conductivity(here, there, np.full(2, 0.5)), 2 * here * there / (here + there), rtol=1e-15)


def test_arithmetic():
    assert_allclose(link_conductivity(np.array([1.0]), np.array([3.0]), np.array([0.75]), rule="arithmetic"), 1.5)


@pytest.mark.parametrize("rule", ["harmonic", "arithmetic"])
def test_a_pore_conducts_nothing(rule):
    here, there, share = np.array([0.0, 5.0, 0.0]), np.array([5.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.5])
    k = link_conductivity(here, there, share, rule=rule)
    assert np.array_equal(k, np.zeros(3))


def test_shares_beyond_the_link_are_cut():
    k = link_conductivity(np.array([2.0, 2.0]), np.array([6.0, 6.0]), np.array([-0.3, 1.7]))
    assert_allclose(k, [6.0, 2.0])


def test_unknown_rule():
    with pytest.raises(ValueError, match="interface = 'geometric'"):
        link_conductivity(np.ones(1), np.ones(1), np.ones(1), rule="geometric")


@pytest.mark.parametrize("resistance", [0.0, 0.7])
def test_parts_of_a_link_are_those_on_either_side_of_its_facet(resistance):
    """Two cells between walls, of .3 and .7 of the way: in series as the layers that they are, from either end."""
    packing = make_packing(np.array([[0.2, 0.5, 0.5], [0.6, 0.5, 0.5]]), np.full(2, 0.1), (1, 1, 1), False, {})
    facets = Facets(
        indptr=np.array([0, 1, 2]),
        indices=np.array([1, 0], np.uint32),
        image=np.array([13, 13], np.uint8),
        area=np.full(2, 0.25),
        distance=np.array([0.1, 0.3]),
        wall_particle=np.array([0, 1]),
        wall_side=np.array([0, 1]),
        wall_area=np.full(2, 0.25),
        wall_distance=np.array([0.2, 0.4]),
        volumes=np.array([0.3, 0.7]),
    )

    def met(here, there, points, normals):
        assert_array_equal([here, there], [[0, 1], [1, 0]])
        assert_allclose(points, [[0.3, 0.5, 0.5]] * 2, rtol=1e-14)  # rounding
        assert_allclose(normals, [[1, 0, 0], [-1, 0, 0]], atol=1e-14)
        return np.full(len(here), resistance)

    how = {"resistance": met} if resistance else {}
    network = connect(packing, facets, np.array([0, 1]), np.array([2.0, 10.0]), **how)
    assert_allclose(network.conductance, 0.25 / (0.1 / 2.0 + 0.3 / 10.0 + resistance), rtol=1e-14)
    assert_allclose(network.wall_conductance, [0.25 * 2.0 / 0.2, 0.25 * 10.0 / 0.4], rtol=1e-14)
