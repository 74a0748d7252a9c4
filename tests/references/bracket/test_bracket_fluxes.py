"""The balanced flux of least energy, piece by piece; a face counted twice would still give a bound."""

import fem_scenes  # noqa: F401, skips without gmsh
import numpy as np
import pytest

from demheat import gallery
from references.bracket.equations import balanced_flux
from references.bracket.faces import CORNERS, interfaces, number_faces
from references.bracket.fluxes import REFERENCE, answers, fields, mappings, masses
from references.bracket.solver import OF_MOMENTS
from references.fem.quadrature import rule
from references.mesh import make


@pytest.fixture(scope="module")
def mesh():
    return make(gallery.sphere_in_cube(10.0, periodic=True), size=0.02)


def test_each_field_has_one_moment():
    for face, corners in enumerate(CORNERS):
        a, b, c = REFERENCE[corners]
        area = np.cross(b - a, c - a) / 2
        area *= np.sign(area @ (a - REFERENCE[face]))
        # Degree two on a triangle: the middles of its edges.
        places = np.array([[0.5, 0.5, 0], [0, 0.5, 0.5], [0.5, 0, 0.5]])
        normal = fields((places @ REFERENCE[corners]).T) @ area
        moments = np.einsum("qi,qv->vi", normal, places) / 3
        wanted = np.zeros((3, 12))
        wanted[range(3), range(3 * face, 3 * face + 3)] = 1
        assert moments == pytest.approx(wanted, abs=1e-13)


def test_no_face_passes_more_than_is_told_of_its_moments():
    """One moment alone, some with both signs, and any."""
    a, b, c = REFERENCE[CORNERS[0]]
    area = np.cross(b - a, c - a) / 2
    places = np.random.default_rng(1).dirichlet(np.ones(3), 2000)
    normal = fields((places @ REFERENCE[CORNERS[0]]).T)[:, :3] @ area
    moments = np.vstack([np.eye(3), [[1, -1, 0], [1, 1, -1]], np.random.default_rng(2).normal(size=(50, 3))])
    passing = np.abs(moments @ normal.T).mean(axis=1) / np.abs(moments).sum(axis=1)
    # Of one moment alone corners are 9, -3 and -3: 1.6875 one way, .6875 the other; by 2000 points.
    assert passing[0] == pytest.approx(2.375, rel=0.05)
    assert passing.max() < OF_MOMENTS


def test_faces_are_shared(mesh):
    faces = number_faces(mesh)
    # In a periodic cell each face has two elements.
    assert np.all(np.bincount(faces.row[:, ::3].ravel() // 3) == 2)
    assert np.all(np.bincount(faces.row.ravel()) == 2)
    corners = mesh.points[mesh.cells[:, CORNERS]].reshape(-1, 3)
    apart = (corners - mesh.points[faces.node[faces.row.ravel()]]) / gallery.EDGE
    assert apart == pytest.approx(np.round(apart), abs=1e-9)
    walled = make(gallery.sphere_in_cube(10.0), size=0.02)
    count = np.bincount(number_faces(walled).row[:, ::3].ravel() // 3)
    assert np.sum(count == 1) == sum(len(wall.triangles) for wall in walled.walls.values())
    assert count.max() == 2


def test_interfaces_are_those_of_the_sphere(mesh):
    found = interfaces(mesh)
    assert np.all(found.inner == 1) and np.all(found.outer == 0)
    radius = np.linalg.norm(mesh.points[found.nodes] - gallery.EDGE / 2, axis=2)
    assert radius == pytest.approx(gallery.EDGE / 3, rel=1e-6)
    a, b, c = (mesh.points[found.nodes[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    # Flat triangles of a closed surface, a little less than the sphere's.
    assert 0.95 < area / (4 * np.pi * (gallery.EDGE / 3) ** 2) < 1


@pytest.mark.parametrize("curved", [False, True])
def test_energies_by_quadrature(mesh, curved):
    ids = np.flatnonzero(mesh.curved == curved)[:7]
    found = masses(mesh, ids, degree=11)
    X, weights = rule(14)
    jacobian, det = mappings(mesh, ids, X)
    flux = np.einsum("bqxk,qik->bqxi", jacobian, fields(X)) / det[..., None, None]
    known = np.einsum("q,bq,bqxi,bqxj->bij", weights, np.broadcast_to(det, (len(ids), len(weights))), flux, flux)
    # Two rules on curved elements, see `references.bracket.energies`: 1e-11 at these degrees.
    assert found == pytest.approx(known, rel=1e-9, abs=1e-9 * np.abs(known).max())


def test_a_linear_temperature_answers_with_a_constant_flux(mesh):
    ids, slope = np.flatnonzero(~mesh.curved)[:50], np.array([1.0, -2.0, 0.5])
    matrices = answers(masses(mesh, ids, degree=5) / 3.0)
    temperature = (mesh.points @ slope)[mesh.cells[ids][:, CORNERS]].reshape(-1, 12)
    moments = -np.einsum("bij,bj->bi", matrices, temperature)
    a, b, c = (mesh.points[mesh.cells[ids][:, CORNERS[:, k]]] for k in range(3))
    area = np.cross(b - a, c - a) / 2
    inner = mesh.points[mesh.cells[ids, :4]]
    area *= np.sign(np.einsum("bfx,bfx->bf", area, a - inner))[..., None]
    known = np.repeat(area @ (-3.0 * slope) / 3, 3, axis=1)
    assert moments == pytest.approx(known, rel=1e-9, abs=1e-12 * np.abs(known).max())
    # A constant temperature drives nothing, and no answer leaves heat behind.
    assert np.abs(matrices.sum(axis=2)).max() < 1e-12 * np.abs(matrices).max()


def test_the_flux_is_balanced_and_continuous(mesh):
    scene = gallery.sphere_in_cube(10.0, periodic=True)
    flux, faces = balanced_flux(scene, mesh, tolerance=1e-11), number_faces(mesh)
    largest = np.abs(flux.moments).max()
    assert np.abs(flux.moments.sum(axis=1)).max() < 1e-12 * largest
    # The tolerance over the scale of single rows.
    assert np.abs(np.bincount(faces.row.ravel(), flux.moments.ravel())).max() < 1e-8 * largest
    assert flux.stats["residual"] <= 1e-11
