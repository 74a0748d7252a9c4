"""OpenFOAM on voxels and on tetrahedra, where laminates tell what its schemes do."""

import pytest

from studies.peers import given
from studies.peers.programs import openfoam

HARMONIC = 2 / (1 / 10 + 1)


@pytest.fixture
def there():
    if openfoam.missing():
        pytest.skip(openfoam.missing())


@pytest.mark.usefixtures("there")
def test_harmonic_faces_are_exact_in_a_laminate():
    found = openfoam.solve(given.scene("layers across"), n=4)
    # Its equations are solved to 1e-12 of their residual.
    assert found.conductivity == pytest.approx(HARMONIC, rel=1e-9)
    assert found.unknowns == 64


@pytest.mark.usefixtures("there")
def test_linear_faces_are_not():
    """One of n + 1 resistances in series, between the middles of two voxels, is 1 / mean(k), not the mean of 1 / k."""
    n, k = 4, (10.0, 1.0)
    resistance = 1 / HARMONIC + (2 / (k[0] + k[1]) - (1 / k[0] + 1 / k[1]) / 2) / n
    found = openfoam.solve(given.scene("layers across"), n=n, scheme="linear")
    assert found.conductivity == pytest.approx(1 / resistance, rel=1e-9)


@pytest.mark.usefixtures("there")
def test_gradients_on_tetrahedra():
    """Where all conducts alike temperatures are linear."""
    scene = given.scene("homogeneous")
    # The rounds end at a residual of 1e-9.
    assert openfoam.solve(scene, size=0.2).conductivity == pytest.approx(1.0, rel=1e-7)
    assert openfoam.solve(scene, size=0.2, gradient="Gauss linear").conductivity > 1.03


def test_images_with_pores_are_refused():
    with pytest.raises(NotImplementedError, match="divides by zero"):
        openfoam.solve(given.scene("pore"), n=4)


@pytest.mark.parametrize(
    ("knobs", "message"),
    [
        ({}, "must be one of them"),
        ({"n": 4, "size": 0.2}, "must be one of them"),
        ({"n": 4, "scheme": "cubic"}, "scheme = 'cubic'"),
        ({"size": 0.2, "gradient": "none"}, "gradient = 'none'"),
    ],
)
def test_knobs_are_checked(knobs, message):
    with pytest.raises(ValueError, match=message):
        openfoam.solve(given.scene("sphere 10"), **knobs)
