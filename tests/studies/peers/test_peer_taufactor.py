"""TauFactor: where each of its solvers has the walls, what it refuses, and a case of its own tests."""

import pytest

from demheat import Layer, Material, Scene
from studies.peers import given
from studies.peers.programs import taufactor

pytestmark = pytest.mark.skipif(taufactor.missing() is not None, reason=str(taufactor.missing()))
N = 8


def test_several_phases_have_walls_half_a_voxel_outside():
    """Its convention, worked out by hand: half a voxel more of the first and the last material, over N + 1 voxels."""
    quarter = Scene(given.SIZE, given.MATRIX, [Layer(0, 0.0, 0.25, Material(10.0))], walls=given.WALLS)
    convention = (N + 1) / (2 / 10 + 6 + 0.5 / 10 + 0.5)
    found = taufactor.solve(quarter, n=N)
    # Single precision, and a flux that is uniform to 1e-4.
    assert found.conductivity == pytest.approx(convention, rel=1e-4)
    assert found.conductivity > 1.01 * N / (2 / 10 + 6)
    assert found.unknowns == N**3 and found.iterations > 0


def test_one_phase_has_walls_on_the_faces():
    half = Scene(given.SIZE, given.MATRIX, [Layer(2, 0.0, 0.5, Material(0.0))], walls=given.WALLS)
    # Single precision.
    assert taufactor.solve(half, n=N, solver="Solver").conductivity == pytest.approx(0.5, rel=1e-5)


def test_one_phase_is_asked_for_one_only():
    with pytest.raises(NotImplementedError, match="one conducting phase"):
        taufactor.solve(given.scene("layers across"), n=N, solver="Solver")


def test_a_strip_of_its_own_tests():
    found, documented, source = taufactor.own()
    # Printed to five digits behind the point, and so held by its own test.
    assert found == pytest.approx(documented, abs=1e-5) and "slanted" in source
