"""Only here: cells at round walls that leave gaps, slivers or planes off the wall."""

from functools import cache, partial

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import sparse
from scipy.sparse.linalg import eigsh
from scipy.spatial import ConvexHull, HalfspaceIntersection

from demheat.conduction.steady import Solution, matrix
from demheat.network.base import SIDES, branches, row_numbers
from demheat.network.curved import ROUND_SIDE, round_wall, tangents_within
from demheat.network.interface import connect
from demheat.network.laguerre import laguerre
from demheat.packing.domain import cut
from demheat.packing.relax import relax, settle
from demheat.packing.twins.interfaces import fibonacci_sphere
from demheat.packing.twins.surfaces import circumscribed_volume
from demheat.sampling.field_of import field_of
from demheat.scene import ROUND_AXES, Material, Scene, domain_volume

BODIES = [("sphere", (2.0, 2.0, 2.0)), ("cylinder-x", (3.0, 1.0, 1.0)), ("cylinder-z", (1.0, 1.0, 0.7))]


def cloud(domain, size, n=500, *, seed=0):
    """Random weighted points in a body, up to 2 % of its radius off the wall: harder than any packing."""
    rng = np.random.default_rng(seed)
    size, axes = np.array(size), list(ROUND_AXES[domain])
    points = rng.random((3 * n, 3)) * size
    off = np.linalg.norm((points - size / 2)[:, axes], axis=1)
    points = points[off < 0.98 * size[axes[0]] / 2][:n]
    spacing = np.cbrt(domain_volume(domain, size) / len(points))
    return points, (rng.uniform(0.4, 1.6, len(points)) * 0.5 * spacing) ** 2, spacing


def closure(facets, centers, size):
    """Sum of the outward facet vectors of each cell."""
    total = np.zeros_like(centers)
    branch = branches(centers, size, facets.indptr, facets.indices, facets.image)
    unit = branch / np.linalg.norm(branch, axis=1)[:, None]
    np.add.at(total, row_numbers(facets.indptr), facets.area[:, None] * unit)
    np.add.at(total, facets.wall_particle, facets.wall_area[:, None] * facets.wall_normal)
    return total


@cache
def packed(domain, size, number):
    return relax(number, size=size, domain=domain, periodic=False, seed=1, overlap=0.01)


@cache
def network(packing_of):
    """Facets, network, matrix (W/K) and its diagonal of a packing, conductivity 1."""
    packing = packed(*packing_of)
    return assembled(packing)


def assembled(packing):
    facets = laguerre(packing.centers, packing.radii**2, packing.size, periodic=packing.periodic, domain=packing.domain)
    made = connect(packing, facets, np.zeros(packing.number, dtype=int), np.ones(1))
    diagonal = np.bincount(row_numbers(made.indptr), made.conductance, minlength=packing.number)
    diagonal += np.bincount(made.wall_particle, made.wall_conductance, minlength=packing.number)
    return facets, made, matrix(made, diagonal), diagonal


@pytest.mark.parametrize(
    "domain, size, through", [(*each, False) for each in BODIES] + [("cylinder-y", (1.0, 2.0, 1.0), True)]
)
def test_cells_close_and_fill_the_body(domain, size, through):
    """Also a cylinder that goes on periodically along its axis."""
    centers, weights, spacing = cloud(domain, size)
    periodic = np.array([through and k not in ROUND_AXES[domain] for k in range(3)])
    facets = laguerre(centers, weights, size, periodic=periodic, domain=domain)
    # Rounding: positions carry 1e-16 of the box, facets below 1e-11 of a squared spacing are dropped.
    assert_allclose(facets.volumes.sum(), domain_volume(domain, size), rtol=1e-12)
    assert_allclose(closure(facets, centers, np.array(size)), 0.0, atol=1e-10 * spacing**2)
    assert facets.volumes.min() >= 0 and facets.wall_distance.min() > 0
    feet = (centers - np.array(size) / 2)[facets.wall_particle] + facets.wall_distance[:, None] * facets.wall_normal
    feet = feet[facets.wall_side == ROUND_SIDE][:, list(ROUND_AXES[domain])]
    assert_allclose(np.linalg.norm(feet, axis=1), size[ROUND_AXES[domain][0]] / 2, rtol=1e-12)
    # Planes tangent to a sphere or a cylinder of radius r about a volume V: area 3 V/r or 2 V/r.
    curved, wall = facets.wall_side == ROUND_SIDE, round_wall(domain, size, spacing)
    area = len(ROUND_AXES[domain]) * domain_volume(domain, size) / wall.radius
    assert_allclose(facets.wall_area[curved].sum(), area, rtol=1e-12)
    flat = 0.0 if domain == "sphere" or through else np.pi / 2 * size[ROUND_AXES[domain][0]] ** 2
    assert_allclose(facets.wall_area[~curved].sum(), flat, rtol=1e-12)


def test_wide_facets(monkeypatch):
    """Where a plane that cuts a cell touches the body beyond the cell's first reach, the reach must grow."""
    monkeypatch.setattr("demheat.network.laguerre.round_wall", partial(round_wall, width=6.0))
    centers, weights, spacing = cloud("sphere", (2, 2, 2), 2000)
    facets = laguerre(centers, weights, (2, 2, 2), periodic=False, domain="sphere")
    assert_allclose(facets.volumes.sum(), domain_volume("sphere", np.full(3, 2.0)), rtol=1e-12)


@pytest.mark.parametrize("domain, size", BODIES[:1])
def test_links_stand_in_both_rows_with_one_area(domain, size):
    centers, weights, spacing = cloud(domain, size)
    facets = laguerre(centers, weights, size, periodic=False, domain=domain)
    rows = row_numbers(facets.indptr)
    there = {(p, q): (a, h) for p, q, a, h in zip(rows, facets.indices, facets.area, facets.distance, strict=True)}
    length = np.linalg.norm(branches(centers, np.array(size), facets.indptr, facets.indices, facets.image), axis=1)
    for p, q, d in zip(rows, facets.indices, length, strict=True):
        assert there[p, q][0] == there[q, p][0]
        # Both ends measure the same plane, to rounding of the box's coordinates.
        assert abs(there[p, q][1] + there[q, p][1] - d) < 1e-12


def test_volume_within_tangent_planes():
    cube = np.concatenate([np.eye(3), -np.eye(3)])
    corners = np.array([[a, b, c] for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)]) / np.sqrt(3)
    assert_allclose(circumscribed_volume(cube), 8.0, rtol=1e-14)
    # A regular octahedron about the unit sphere has the edge sqrt(6) and the volume sqrt(2)/3 edge^3.
    assert_allclose(circumscribed_volume(corners), np.sqrt(2) / 3 * 6**1.5, rtol=1e-14)
    normals = fibonacci_sphere(157)
    planes = np.column_stack([normals, -np.ones(len(normals))])
    # Two computations by qhull, each to rounding.
    slow = ConvexHull(HalfspaceIntersection(planes, np.zeros(3)).intersections).volume
    assert_allclose(circumscribed_volume(normals), slow, rtol=1e-12)


def test_tangents_within():
    wall = round_wall("sphere", (2, 2, 2), 0.2)
    points = np.random.default_rng(2).uniform(0.4, 1.6, (50, 3))
    pointers, planes = tangents_within(wall, points, 0.6)
    touch = wall.middle + wall.radius * wall.normals
    for p, (a, b) in enumerate(zip(pointers, pointers[1:], strict=False)):
        assert np.array_equal(planes[a:b], np.flatnonzero(np.linalg.norm(touch - points[p], axis=1) <= 0.6))
    assert 0 < len(planes) < 50 * len(touch)


def spectral_radius(packing):
    """Largest eigenvalue of the scaled matrix over the median of its diagonal."""
    facets, _, a, diagonal = assembled(packing)
    root = sparse.diags(facets.volumes**-0.5)
    return eigsh(root @ a @ root, 1, return_eigenvectors=False, tol=1e-3)[0] / np.median(diagonal / facets.volumes)


def test_no_slivers():
    """Found 7 in periodic boxes, 10 to 18 between flat or round walls, where the smallest spheres touch the wall."""
    assert spectral_radius(packed("sphere", (2.0, 2.0, 2.0), 400)) < 25
    clipped = cut(relax(3000, size=(2, 2, 2), seed=3, overlap=0.01), "sphere", keep="center")
    # Centres just inside the wall make slivers; pushed off it by half their radius or more they do not.
    assert spectral_radius(clipped) > 250  # found 980, with two other seeds 300 and 560
    assert spectral_radius(settle(clipped, steps=100)) < 25  # found 8


@pytest.mark.parametrize(
    "change, words",
    [
        (dict(domain="cone"), "must be one of box"),
        (dict(periodic=True), "not periodic"),
        (dict(size=(2, 2, 3)), "must be equal"),
        (dict(centers=np.array([[1.0, 1.0, 1.0], [0.1, 0.1, 0.1]]), weights=np.zeros(2)), r"centers\[1\].*less than"),
    ],
)
def test_bad_input(change, words):
    centers, weights, _ = cloud("sphere", (2, 2, 2), 50)
    good = dict(centers=centers, weights=weights, size=(2, 2, 2), periodic=False, domain="sphere")
    with pytest.raises(ValueError, match=words):
        laguerre(**good | change)


@pytest.mark.parametrize("domain, size", BODIES[:2])
def test_linear_fields_at_points(domain, size):
    """Temperature and flux wherever they are asked for in the body, also between the facets and the round wall."""
    packing, (facets, made, _, _) = packed(domain, size, 400), network((domain, size, 400))
    gradient, names = np.array([1.0, 0.3, -0.7]), {SIDES[side]: 0.0 for side in np.unique(facets.wall_side)}
    scene = Scene(size=size, matrix=Material(1.0), domain=domain, initial=0.0, walls=names)
    there = (packing.centers[facets.wall_particle] + facets.wall_distance[:, None] * facets.wall_normal) @ gradient
    here = packing.centers @ gradient
    heat = made.wall_conductance * (there - here[facets.wall_particle])
    solution = Solution(here, np.zeros(3), there, heat, {})
    field = field_of(scene, made, solution, stats={})
    axes, rng = list(ROUND_AXES[domain]), np.random.default_rng(4)
    points = rng.random((500, 3)) * size
    points = points[np.linalg.norm((points - np.array(size) / 2)[:, axes], axis=1) < size[axes[0]] / 2]
    rim = np.array(size) / 2
    rim[axes[1]] = size[axes[1]]
    points = np.vstack([points, rim])
    # Sums of some twenty heat flows of the size of the spacing squared: rounding.
    assert_allclose(field.flux_at(points), np.tile(-gradient, (len(points), 1)), atol=1e-10)
    assert_allclose(field.temperature_at(points), points @ gradient, atol=1e-10)
    assert_allclose(field.mean_flux, -gradient, atol=1e-10)
    assert_allclose(sum(field.wall_heat.values()), 0.0, atol=1e-10)
    assert set(field.wall_temperature) == set(names)
    # Outside of the round wall, in the box.
    rim[axes[:2]] = size[axes[0]] / 2 * (1 + (1 + 1e-6) * np.sqrt(0.5))
    with pytest.raises(ValueError, match=f"lies outside the {domain}"):
        field.temperature_at(rim)
