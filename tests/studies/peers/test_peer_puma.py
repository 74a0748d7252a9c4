"""PuMA: where its walls are, which bodies its bricks answer for, and a case of its own tests."""

import pytest

from demheat import Layer, Material, Scene
from studies.peers import given
from studies.peers.programs import puma

here = pytest.mark.skipif(puma.missing() is not None, reason=str(puma.missing()))
N = 8


@here
def test_walls_are_in_the_centres_of_voxels():
    """Its convention, worked out by hand: half a voxel less of the first and the last material, over N - 1 voxels."""
    quarter = Scene(given.SIZE, given.MATRIX, [Layer(0, 0.0, 0.25, Material(10.0))], walls=given.WALLS)
    convention = (N - 1) / (2 / 10 + 6 - 0.5 / 10 - 0.5)
    found = puma.solve(quarter, n=N)
    # SciPy's 1e-5 of the right-hand side in units of 1e-6.
    assert found.conductivity == pytest.approx(convention, rel=1e-6)
    assert found.conductivity < 0.99 * N / (2 / 10 + 6)
    assert found.unknowns == N**3


def test_bricks_are_for_bodies_that_mirror_themselves():
    assert puma.mirrored(given.scene("sphere 10")) and not puma.mirrored(given.scene("layers across"))
    with pytest.raises(NotImplementedError, match="periodic"):
        puma.solve(given.scene("dispersion 10"), n=N, by="fe")


@here
def test_halves_of_its_own_tests():
    found, documented, source = puma.own()
    # As many digits as it prints.
    assert found == pytest.approx(documented, abs=1e-9) and "matSeriesInx" in source
