"""MFEM: where it is installed, layers on its mesh, with and without a gap."""

import pytest

from demheat import Layer, Material, Scene
from studies.peers import given
from studies.peers.programs import mfem

pytestmark = pytest.mark.skipif(mfem.missing() is not None, reason=str(mfem.missing()))


@pytest.mark.parametrize("order", (1, 2))
@pytest.mark.parametrize("name", ("layers across", "layers along"))
def test_layers_that_end_between_voxels_are_exact(name, order):
    found = mfem.solve(given.scene(name), n=4, order=order)
    # Conjugate gradients stop at 1e-10.
    assert found.conductivity == pytest.approx(given.known(name), rel=1e-9)
    assert found.unknowns == (4 * order - 1) * (4 * order + 1) ** 2


def test_what_does_not_conduct_is_left_out():
    half = Scene(given.SIZE, given.MATRIX, [Layer(2, 0.0, 0.5, Material(0.0))], walls=given.WALLS)
    found = mfem.solve(half, n=4)
    assert found.conductivity == pytest.approx(0.5, rel=1e-9) and found.unknowns == 3 * 5 * 3
