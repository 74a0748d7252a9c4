"""Only here: spheres added one by one that overlap, keep to places, or miss those in full cells."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from demheat.addition import add_spheres


def surface_distances(centers, radii, size, periodic):
    offsets = centers[:, None] - centers
    offsets -= np.where(periodic, size * np.rint(offsets / size), 0.0)
    gaps = np.linalg.norm(offsets, axis=2) - radii - radii[:, None]
    return gaps[np.triu_indices(len(radii), 1)]


class Counting:
    """A generator that counts the points drawn."""

    def __init__(self):
        self.drawn, self.rng = 0, np.random.default_rng(1)

    def random(self, shape):
        self.drawn += shape[0]
        return self.rng.random(shape)


@pytest.mark.parametrize("periodic", [True, False])
@pytest.mark.parametrize("reuse", [True, False])
def test_spheres_do_not_overlap(periodic, reuse):
    size, rng = np.array([1.0, 0.8, 1.2]), np.random.default_rng(0)
    radii = np.full(60, 0.07) if reuse else rng.uniform(0.03, 0.09, 60)
    centers = add_spheres(radii, size, rng, periodic=periodic, margin=0.0 if periodic else radii, reuse=reuse)
    gaps = surface_distances(centers, radii, size, periodic)
    assert -1e-15 <= gaps.min() < 0.02  # rounding; and they do come near each other
    depth = np.minimum(centers, size - centers).min(axis=1)
    assert np.any(depth < radii) == periodic  # spheres cross the faces of a periodic box only


def test_reuse_draws_less_and_places_uniformly():
    sources, radii = (Counting(), Counting()), np.full(400, 0.03)
    found = [
        add_spheres(radii, np.ones(3), source, periodic=True, reuse=reuse)
        for source, reuse in zip(sources, (True, False), strict=True)
    ]
    assert sources[0].drawn < sources[1].drawn / 10
    for centers in found:
        # 400 uniform numbers: their mean scatters by 0.29/20 = 0.014; four times that.
        assert np.abs(centers.mean(axis=0) - 0.5).max() < 0.058


def test_same_seed_same_spheres():
    first, again, other = (
        add_spheres(np.full(20, 0.1), np.ones(3), np.random.default_rng(seed), periodic=True) for seed in (3, 3, 4)
    )
    assert_array_equal(first, again)
    assert np.abs(first - other).max() > 0.1


@pytest.mark.parametrize("periodic", [True, False])
def test_many_small_spheres_beside_a_large_one(periodic):
    """Cells as wide as the large one take some of the small ones: their slots are made more as they fill."""
    radii = np.append(0.1, np.full(700, 0.02))
    centers = add_spheres(radii, np.ones(3), np.random.default_rng(0), periodic=periodic)
    assert surface_distances(centers, radii, np.ones(3), periodic).min() > -1e-15  # rounding
