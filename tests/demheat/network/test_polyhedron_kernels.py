"""Only here: a polyhedron that a cut leaves with wrong corners, edges or areas, beside brute force."""

import numpy as np
import pytest
from brute_polyhedron import corners, measured
from numpy.testing import assert_allclose

from demheat.network.polyhedron_kernels import AREA, DISTANCE, EDGE, beyond, cut, empty_polyhedron, measure, start_box

LOW, HIGH = np.array([-1.0, -0.7, -1.2]), np.array([0.9, 1.1, 0.8])
EPS = 1e-12


def box():
    cell = empty_polyhedron(40)
    return cell, start_box(LOW, HIGH, cell)


def vertices(cell, count):
    return cell.vertex[:3, :count].T


def triples(cell, count):
    return cell.corner[:count, :3]


def check(cell, count, planes):
    """Corners, the planes that meet in each, the edges between them, facet areas and the volume."""
    normals, distances = cell.plane[:planes, :3], cell.plane[:planes, DISTANCE]
    right = corners(normals, distances)
    # Rounding of coordinates of order one; planes that meet at small angles magnify it.
    apart = np.linalg.norm(vertices(cell, count)[:, None] - right, axis=2)
    assert apart.min(axis=0).max() < 1e-12 and apart.min(axis=1).max() < 1e-12
    for vertex, triple in zip(vertices(cell, count), triples(cell, count), strict=True):
        assert_allclose(normals[triple] @ vertex, distances[triple], atol=1e-13)
        assert np.linalg.det(normals[triple]) > 0  # counter-clockwise from outside
    for v, k in np.ndindex(count, 3):
        a, b, w = cell.corner[v, k], cell.corner[v, (k + 1) % 3], cell.corner[v, EDGE + k]
        assert (b, a) in zip(cell.corner[w, :3], np.roll(cell.corner[w, :3], -1), strict=True)
    areas, volume = measured(normals, distances)
    assert_allclose(measure(cell, count, planes), volume, rtol=1e-12)
    assert_allclose(cell.plane[:planes, AREA], areas, atol=1e-12)
    return volume


@pytest.mark.twin
def test_a_box():
    cell, count = box()
    assert count == 8
    assert_allclose(check(cell, count, 6), np.prod(HIGH - LOW), rtol=1e-14)
    assert_allclose(cell.plane[:6, DISTANCE], [1.0, 0.9, 0.7, 1.1, 1.2, 0.8])


@pytest.mark.twin
@pytest.mark.parametrize("seed", range(4))
def test_cuts_leave_what_the_half_spaces_have_in_common(seed):
    rng, (cell, count) = np.random.default_rng(seed), box()
    planes, missed = 6, 0
    for _ in range(12):
        normal = rng.standard_normal(3)
        normal, distance = normal / np.linalg.norm(normal), rng.uniform(0.3, 1.2)
        cell.plane[planes, :3], cell.plane[planes, DISTANCE] = normal, distance
        over = np.sum(vertices(cell, count) @ normal > distance)
        misses = over == 0
        assert beyond(cell, count, *normal, distance) == over
        before, (count, new) = count, cut(cell, count, planes, EPS)
        assert count > 0
        if misses:
            assert (count, new) == (before, 0) and not np.any(triples(cell, count) == planes)
            missed += 1
        else:
            assert new == np.sum(triples(cell, count) == planes)
            planes += 1
    assert 0 < missed < 9
    assert 0.0 < check(cell, count, planes) < np.prod(HIGH - LOW)


@pytest.mark.twin
def test_nothing_is_left_beyond_a_plane():
    cell, count = box()
    cell.plane[6, :4] = 0.0, 1.0, 0.0, -0.8
    assert cut(cell, count, 6, EPS) == (0, 0)
