"""Only here: distances of centres from walls, flat and round, and what counts as bulk."""

import numpy as np
import pytest
from crystals import random_packing
from numpy.testing import assert_allclose, assert_array_equal

from demheat.packing.base import make_packing
from demheat.packing.walls import bulk, check_margin, outward, wall_distance, wall_distances, walls

AXES = {"box": [], "cylinder-y": [0, 2], "sphere": [0, 1, 2]}


@pytest.mark.parametrize("domain", AXES)
def test_wall_distances(domain):
    packing = random_packing(0, 200, periodic=(False, domain == "box", False), domain=domain)
    x, expected = packing.centers, np.full(200, np.inf)
    for axis in {0, 1, 2} - set(AXES[domain]) - ({1} if domain == "box" else set()):
        expected = np.minimum(expected, np.minimum(x[:, axis], 1 - x[:, axis]))
    if AXES[domain]:
        expected = np.minimum(expected, 0.5 - np.sqrt(((x[:, AXES[domain]] - 0.5) ** 2).sum(axis=1)))
    assert_allclose(wall_distances(packing), expected, rtol=1e-14, atol=1e-15)  # rounding
    by_name = np.stack([wall_distance(packing, wall) for wall in walls(packing)])
    assert_array_equal(by_name.min(axis=0), wall_distances(packing))
    for wall in walls(packing):
        feet = packing._replace(centers=x + wall_distance(packing, wall)[:, None] * outward(packing, wall))
        assert_allclose(wall_distance(feet, wall), 0.0, atol=1e-15)


def test_bulk():
    packing = random_packing(1, 300, periodic=False, domain="sphere")
    deep = bulk(packing, 2.0)
    assert_array_equal(deep, wall_distances(packing) >= 2.0 * packing.radii.mean())
    assert 0 < deep.sum() < 300
    # Rounding may put a centre that touches the wall beyond it; without a margin it counts all the same.
    farthest = 0.5 - wall_distances(packing).min()
    beyond = packing._replace(centers=0.5 + (packing.centers - 0.5) * (0.5 + 1e-10) / farthest)
    assert np.any(wall_distances(beyond) < 0) and bulk(beyond, 0.0).all() and not bulk(beyond, 1e-12).all()
    assert bulk(random_packing(1, 50), 1e9).all()  # a periodic packing is bulk throughout


def test_margins_are_checked():
    packing = make_packing([[0.5, 0.5, 0.5], [0.1, 0.5, 0.5]], [0.1, 0.1], (1, 1, 2), False, {})
    assert_allclose(check_margin(packing, 2.0), 0.2, rtol=1e-15)
    for margin in (-1, np.nan, "1", 5.0):
        with pytest.raises(ValueError, match=f"margin = {margin!r}: must be"):
            check_margin(packing, margin)
    with pytest.raises(ValueError, match="depth = 5.0: must be < 5 mean radii"):
        check_margin(packing, 5.0, "depth")
    lone = packing._replace(centers=packing.centers * [0.4, 1, 1])
    with pytest.raises(ValueError, match="margin = 4.5: no particle is that many mean radii away"):
        bulk(lone, 4.5)
