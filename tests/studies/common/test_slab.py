"""The slab of Haddad et al.: its scene and its slices."""

import numpy as np
from numpy.testing import assert_allclose

from studies.common import slab


def test_means_over_slices():
    y = slab.LENGTH * np.array([0.0, 0.01, 0.26, 0.99, 1.0])
    middle, mean = slab.binned(y, np.array([1.0, 3.0, 5.0, 7.0, 9.0]), bins=4)
    assert_allclose(middle, [0.125, 0.375, 0.625, 0.875])
    assert mean.tolist() == [2.0, 5.0, 0.0, 8.0]


def test_the_slab_is_the_papers():
    scene = slab.slab()
    # Diffusivity 4.7e-3 m2/s: with 0.9 J/(kg K), as printed.
    assert_allclose(
        scene.matrix.conductivity / (scene.matrix.density * scene.matrix.heat_capacity), 4.7009e-3, rtol=1e-4
    )
    assert scene.wall_temperatures == {"y-": 25.0, "y+": 35.0} and scene.initial == 25.0
