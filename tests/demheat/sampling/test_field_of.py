"""Only here: points given to the nearest centre instead of the radical cell around them."""

from types import SimpleNamespace

import numpy as np
import pytest

from demheat.sampling.field_of import _Locator, _wall_mean


@pytest.mark.parametrize("periodic", [False, True])
def test_a_point_is_in_the_radical_cell_around_it(periodic):
    rng = np.random.default_rng(3)
    size, flags = np.array([1.0, 2.0, 1.5]), np.full(3, periodic)
    network = SimpleNamespace(
        centers=rng.random((50, 3)) * size, radii=rng.uniform(0.05, 0.4, 50), size=size, periodic=flags
    )
    points = rng.random((200, 3)) * size
    cell, offsets = _Locator(network)(points)
    apart = points[:, None] - network.centers
    apart -= flags * size * np.round(apart / size)
    power = np.einsum("ijk,ijk->ij", apart, apart) - network.radii**2
    assert np.array_equal(cell, power.argmin(axis=1))
    assert np.mean(cell != np.linalg.norm(apart, axis=2).argmin(axis=1)) > 0.2
    # Rounding of coordinates.
    assert np.abs(offsets - apart[np.arange(200), cell]).max() < 1e-14


def test_facets_of_a_wall_count_by_their_area_where_they_have_a_temperature():
    assert _wall_mean(np.array([1.0, 4.0, np.nan, 9.0]), np.array([2.0, 1.0, 5.0, 0.0])) == 2.0
    assert np.isnan(_wall_mean(np.full(2, np.nan), np.ones(2)))
