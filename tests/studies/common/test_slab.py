"""The slab of Haddad et al.: its scene."""

from numpy.testing import assert_allclose

from studies.common import slab


def test_the_slab_is_the_papers():
    scene = slab.slab()
    # Diffusivity 4.7e-3 m2/s: with 0.9 J/(kg K), as printed.
    assert_allclose(
        scene.matrix.conductivity / (scene.matrix.density * scene.matrix.heat_capacity), 4.7009e-3, rtol=1e-4
    )
    assert scene.wall_temperatures == {"y-": 25.0, "y+": 35.0} and scene.initial == 25.0
