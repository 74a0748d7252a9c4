"""OpenImpala: where its walls are by either solver, several phases, and a case of its own manual."""

import pytest

from demheat import Layer, Material, Scene
from studies.peers import given
from studies.peers.programs import openimpala

here = pytest.mark.skipif(openimpala.missing() is not None, reason=str(openimpala.missing()))
N = 8
QUARTER = Scene(given.SIZE, given.MATRIX, [Layer(0, 0.0, 0.25, Material(10.0))], walls=given.WALLS)


@here
@pytest.mark.parametrize(("solver", "conductivity"), [("mlmg", 1.0), ("pcg", N / (N - 1))])
def test_a_homogeneous_body(solver, conductivity):
    found = openimpala.solve(given.scene("homogeneous"), n=N, solver=solver)
    # Residuals of 1e-12 and 1e-9.
    assert found.conductivity == pytest.approx(conductivity, rel=1e-8)
    assert found.unknowns == N**3


@here
def test_several_phases_have_walls_in_the_centres_of_voxels():
    """Its convention, worked out by hand: half a voxel less of the first and the last material, over N voxels."""
    convention = N / (2 / 10 + 6 - 0.5 / 10 - 0.5)
    # A residual of 1e-9.
    assert openimpala.solve(QUARTER, n=N, solver="pcg").conductivity == pytest.approx(convention, rel=1e-7)


def test_multigrid_is_asked_for_one_phase_only():
    with pytest.raises(NotImplementedError, match="one conducting phase"):
        openimpala.solve(QUARTER, n=N)


@here
def test_a_cube_of_its_own_manual():
    found, documented, source = openimpala.own()
    # A residual of 1e-9.
    assert found == pytest.approx(documented, rel=1e-8) and "concepts" in source
