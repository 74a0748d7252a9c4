"""OpenPNM: layers exactly by boundary pores, half a voxel off without, and PoreSpy's open space."""

import pytest

from demheat import Layer, Material, Scene
from studies.peers import given
from studies.peers.programs import openpnm

here = pytest.mark.skipif(openpnm.missing() is not None, reason=str(openpnm.missing()))
N = 8
QUARTER = Scene(given.SIZE, given.MATRIX, [Layer(0, 0.0, 0.25, Material(10.0))], walls=given.WALLS)


@here
@pytest.mark.parametrize(
    ("by", "conductivity"),
    [("boundary pores", N / (2 / 10 + 6)), ("pores", (N - 1) / (2 / 10 + 6 - 0.5 / 10 - 0.5))],
)
def test_layers(by, conductivity):
    """Exactly between walls on the faces; between the centres of the first and last voxels by hand."""
    # Multigrid stops at 1e-10 of the right-hand side.
    assert openpnm.solve(QUARTER, n=N, by=by).conductivity == pytest.approx(conductivity, rel=1e-8)


@here
def test_what_does_not_conduct_passes_nothing():
    half = Scene(given.SIZE, given.MATRIX, [Layer(2, 0.0, 0.5, Material(0.0))], walls=given.WALLS)
    # As above.
    assert openpnm.solve(half, n=4).conductivity == pytest.approx(0.5, rel=1e-8)


def test_porespy_is_asked_for_one_phase_only():
    with pytest.raises(NotImplementedError, match="one conducting phase"):
        openpnm.solve(QUARTER, n=N, by="tortuosity_fd")


@here
def test_open_space():
    found, documented, source = openpnm.own()
    # Six digits behind the point are stated.
    assert found == pytest.approx(documented, abs=1e-6) and "500" in source
