"""The energy of a temperature or a flux is never underrated, or a bound would not be one: known ones, finer rules."""

import fem_scenes  # noqa: F401, skips without gmsh
import numpy as np
import pytest

from demheat import gallery
from references.bracket.energies import flux_energies, temperature_energies
from references.bracket.faces import CORNERS
from references.bracket.fluxes import answers, masses
from references.bracket.surfaces import pushed
from references.mesh import make


@pytest.mark.parametrize("size", [0.04, 0.015])
def test_a_linear_temperature(size):
    scene = gallery.sphere_in_cube(10.0)
    mesh, slope = pushed(scene, make(scene, size=size), upper=True), np.array([1.0, -2.0, 0.5])
    conductivity = np.where(mesh.phase == 1, 10.0, 1.0)
    known = 5.25 * conductivity @ mesh.volumes
    found = temperature_energies(mesh, conductivity, [mesh.points @ slope])[0, 0]
    # Never less but for rounding; the difference of two rules above it, some 1e-8.
    assert -1e-12 < found / known - 1 < 1e-6


def test_an_energy_is_never_underrated():
    """The energy of a flux on curved elements, beside a rule of far higher degree."""
    scene = gallery.sphere_in_cube(10.0)
    mesh = pushed(scene, make(scene, size=0.04), upper=False)
    conductivity = np.where(mesh.phase == 1, 10.0, 1.0)
    temperature = (mesh.points @ [0.0, 1.0, 0.0])[mesh.cells[:, CORNERS]].reshape(-1, 12)
    moments = np.zeros(temperature.shape)
    known = 0.0
    for curved in (False, True):
        ids = np.flatnonzero(mesh.curved == curved)
        matrices = masses(mesh, ids, degree=7) / conductivity[ids, None, None]
        moments[ids] = -np.einsum("bij,bj->bi", answers(matrices), temperature[ids])
        for each in np.array_split(ids, 20):
            fine = masses(mesh, each, degree=17) / conductivity[each, None, None]
            known += np.einsum("bi,bij,bj->", moments[each], fine, moments[each], optimize=True)
    found = flux_energies(mesh, conductivity, [moments])[0, 0]
    assert 0 < found / known - 1 < 1e-5


def test_pores_cost_nothing():
    scene = gallery.sphere_in_cube(0.0)
    mesh = make(scene, size=0.03)
    conductivity = scene.conductivities[mesh.phase]
    found = temperature_energies(mesh, conductivity, [mesh.points[:, 1]])[0, 0]
    assert found == pytest.approx(conductivity @ mesh.volumes, rel=1e-6)


def test_energies_of_several_loads():
    scene = gallery.sphere_in_cube(10.0)
    mesh = pushed(scene, make(scene, size=0.04), upper=True)
    conductivity = scene.conductivities[mesh.phase]
    found = temperature_energies(mesh, conductivity, mesh.points.T)
    # Three linear temperatures: no cross terms but for what the rules of quadrature differ by, on the diagonal.
    known = conductivity @ mesh.volumes * np.eye(3)
    assert found == pytest.approx(known, rel=1e-5, abs=1e-7 * known[0, 0])
    assert np.linalg.eigvalsh(found - known).min() > -1e-12 * known[0, 0]
