"""Sizes of elements looked up in a table beside the smallest that any ball or shell asks for."""

import numpy as np
import pytest
from meshed_here import gmsh_or_skip, mesh_here
from numpy.testing import assert_allclose

from demheat.scene import Material, Scene, Sphere
from references import mesh
from references.mesh import cad, gmsh_session, size_table, sizes

# A kernel with C's interface is compiled where it is imported, so not by those who list the tests.


def asked(seed=0, balls=80):
    rng = np.random.default_rng(seed)
    radius = rng.uniform(0.005, 0.05, balls)
    rows = np.column_stack([rng.uniform(-0.1, 1.1, (balls, 3)), radius, 0.4 * radius])
    shells = np.array([[0.5, 0.6, 0.3, 0.2, 0.22, 0.04], [0.2, 0.2, 0.2, 0.1, 0.101, 0.002]])
    return sizes.Sizes(0.06, rows, shells, np.zeros((0, 4)))


def slow(wanted, points):
    least = np.full(len(points), wanted.size)
    for x, y, z, radius, h in wanted.balls:
        beyond = np.maximum(np.linalg.norm(points - [x, y, z], axis=1) - radius, 0)
        least = np.minimum(least, h + sizes.GROWTH * beyond)
    for x, y, z, inner, outer, h in wanted.shells:
        off = np.abs(np.linalg.norm(points - [x, y, z], axis=1) - (inner + outer) / 2)
        least = np.minimum(least, h + sizes.GROWTH * off)
    return least


@pytest.mark.twin
@pytest.mark.parametrize("box", [(1.0, 1.0, 1.0), (1.0, 0.4, 0.7)])
@pytest.mark.parametrize("balls", [0, 1, 80])
def test_size_at(box, balls):
    from references.mesh import size_kernels

    wanted, box = asked(balls=balls), np.array(box)
    table = size_table.table(wanted, box)
    # Corners of the box and points that rounding puts beyond them, too.
    points = np.vstack([np.random.default_rng(1).random((500, 3)) * box, [0, 0, 0], box, 1.0000001 * box, [-1e-9] * 3])
    found = [size_kernels.size_at(*point, wanted.size, table) for point in points]
    assert_allclose(found, slow(wanted, points), rtol=1e-12)  # rounding
    # Not more than was asked for before.
    assert size_kernels.size_at(*points[0], 1e-5, table) == 1e-5


def test_features_looked_at_do_not_grow_with_their_number():
    longest = []
    for n in (6, 12):
        places = (np.stack(np.meshgrid(*[np.arange(n)] * 3), axis=-1).reshape(-1, 3) + 0.5) / n
        balls = np.column_stack([places, np.full(n**3, 0.1 / n), np.full(n**3, 0.04 / n)])
        table = size_table.table(sizes.Sizes(0.1 / n, balls, np.zeros((0, 6)), np.zeros((0, 4))), np.ones(3))
        starts = table[int(table[7]) : int(table[8])]
        longest.append(np.diff(starts).max())
    # Of cells as large as the distance of the balls: those around.
    assert longest[0] == longest[1] <= 27


def test_features_that_reach_everywhere_are_heard_where_they_ask_for_least():
    from references.mesh import size_kernels

    # 4000 of them reach across the box; all in all cells once were 16 million rows, of 26 000 some 280 million.
    rng = np.random.default_rng(3)
    balls = np.column_stack([rng.random((4000, 3)), rng.uniform(0.001, 0.15, 4000), rng.uniform(0.001, 0.08, 4000)])
    wanted = sizes.Sizes(0.5, balls, np.zeros((0, 6)), np.zeros((0, 4)))
    table = size_table.table(wanted, np.ones(3))
    points = rng.random((300, 3))
    found = [size_kernels.size_at(*point, wanted.size, table) for point in points]
    assert_allclose(found, slow(wanted, points), rtol=1e-12)  # rounding
    assert len(table) < 20 * size_kernels.WIDTH * len(balls)


def test_a_mesh_with_a_table_is_as_fine_as_with_fields_of_gmsh(monkeypatch):
    gmsh_or_skip()
    rng, metal = np.random.default_rng(0), Material(10.0)
    places = 0.2 + 0.3 * np.stack(np.meshgrid(*[np.arange(3)] * 2), axis=-1).reshape(-1, 2)
    spheres = [Sphere((x, y, 0.5 + 0.2 * rng.random()), 0.08, metal) for x, y in places]
    of = Scene((1.0,) * 3, Material(1.0), spheres, walls={"x-": 0.0, "x+": 1.0})
    plain = mesh.make(of, size=0.2, order=1)
    monkeypatch.setattr(cad, "MOST_FIELDS", 0)
    monkeypatch.setattr(gmsh_session, "run_apart", mesh_here)
    looked_up = mesh.make(of, size=0.2, order=1)
    # The sizes differ by rounding, which moves a few of 1e4 elements.
    assert_allclose(len(looked_up.cells), len(plain.cells), rtol=0.02)
    fractions = [np.bincount(m.phase, m.volumes) for m in (plain, looked_up)]
    assert_allclose(fractions[1], fractions[0], rtol=2e-3)  # chords of the same length
