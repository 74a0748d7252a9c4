"""FiPy: where it is installed, layers on its grid, with and without a gap, and a case of its own manual."""

import pytest

from demheat import Layer, Material, Scene
from studies.peers import given
from studies.peers.programs import fipy

pytestmark = pytest.mark.skipif(fipy.missing() is not None, reason=str(fipy.missing()))


def test_layers_that_end_between_voxels_are_exact():
    found = fipy.solve(given.scene("layers across"), n=8)
    # Conjugate gradients stop at 1e-10.
    assert found.conductivity == pytest.approx(given.known("layers across"), rel=1e-9)
    assert found.unknowns == 512


def test_what_does_not_conduct_passes_nothing():
    half = Scene(given.SIZE, given.MATRIX, [Layer(2, 0.0, 0.5, Material(0.0))], walls=given.WALLS)
    assert fipy.solve(half, n=4).conductivity == pytest.approx(0.5, rel=1e-9)


def test_a_case_of_its_own_manual():
    found, documented, source = fipy.own()
    # What the manual itself asks for.
    assert found == pytest.approx(documented, rel=1e-8) and "mesh1D" in source
