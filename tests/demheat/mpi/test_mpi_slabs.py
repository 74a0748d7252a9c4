"""Only here: slabs of ranks whose rows are not the equations of the whole body, or scenes that they cannot have."""

import numpy as np
import pytest
from ranks import on_ranks
from scipy import sparse
from scipy.sparse.linalg import spsolve

from demheat import Image, Laguerre, Layer, Material, Radiation, Scene, Sphere, solve
from demheat.conduction.balance import system_of
from demheat.dem.options import Particles
from demheat.mpi.cells import cells_of, own_part, part_of
from demheat.mpi.numbers import numbers_of
from demheat.mpi.slabs import GHOSTS, NOBODY, slabs_of
from demheat.mpi.solver import check

LAW, A, B = Laguerre(), Material(10.0), Material(100.0)
# A sphere across the first face, one across the face between two slabs.
SPHERES = (Sphere((0.1, 0.5, 0.5), 0.3, B), Sphere((1.4, 0.4, 0.5), 0.3, B))
CELL = Scene((2.0, 1.0, 1.0), A, SPHERES, gradient=(1.0, 0.0, 0.0))
WALLS = Scene((2.0, 1.0, 1.0), A, SPHERES[1:], walls={"x-": 300.0, "x+": 400.0})


def tessellated(scene, wanted, ranks):
    """Of each rank its cells, its numbers and its slabs."""

    def work(comm):
        slabs = slabs_of(scene, wanted.particles, comm.size, comm.rank)
        cells = cells_of(scene, LAW, part_of(scene, LAW, wanted, slabs, comm), slabs, comm)
        return cells, numbers_of(cells.network, cells.own, slabs, comm), slabs

    return on_ranks(ranks, work)


def by_place(points, *columns):
    order = np.lexsort(np.round(points, 9).T)
    return points[order], *(column[order] for column in columns)


@pytest.mark.filterwarnings("ignore:replicas = :DeprecationWarning")
@pytest.mark.parametrize(
    ("scene", "knobs", "ranks"),
    [(CELL, {}, 3), (CELL, {"replicas": 1}, 1), (WALLS, {"replicas": 1}, 2)],
)
def test_the_rows_of_all_ranks_are_those_of_the_whole(scene, knobs, ranks):
    number = 3000
    parts = tessellated(scene, Particles(particles=number, seed=0, **knobs), ranks)
    whole = solve(scene, particles=number, tolerance=1e-13, **knobs)
    count = sum(cells.own for cells, _, _ in parts)
    assert count == whole.stats["unknowns"]
    assert parts[0][0].packing["twins"] == whole.stats["packing"]["twins"] > 0
    columns = [[], [], [], [], []]
    for cells, numbers, _ in parts:
        network, own = own_part(cells.network, cells.own), cells.own
        system = system_of(network, scene, np.arange(len(numbers)) < own)
        row = np.repeat(numbers, np.diff(network.indptr))
        found = row, numbers[network.indices], network.conductance, system.diagonal[:own], system.heat[:own]
        for column, part in zip(columns, found, strict=True):
            column.append(part)
    row, column, conductance, diagonal, heat = map(np.concatenate, columns)
    links = sparse.csr_matrix((conductance, (row, column)), shape=(count, count))
    # Each link is made by both of its ranks: facets differ by rounding, those near an edge would by more.
    assert abs(links - links.T).max() < 1e-9 * conductance.max()
    # One number is held where nothing else says the level.
    x = np.zeros(count)
    free = slice(1 if scene.periodic else 0, None)
    x[free] = spsolve((sparse.diags(diagonal) - links).tocsc()[free, free], heat[free])
    own = whole.samples
    level = 350.0 if not scene.periodic else 0.0
    points = np.concatenate([cells.network.centers[: cells.own] for cells, _, _ in parts])
    volumes = np.concatenate([cells.network.volumes[: cells.own] for cells, _, _ in parts])
    if scene.periodic:
        x += points @ np.array(scene.gradient) - np.average(x, weights=volumes)
    mine = by_place(points, volumes, x + level)
    theirs = by_place(own.points, own.volumes, own.temperature)
    # Coordinates and volumes are rounded where slabs begin elsewhere; temperatures are as good as the two solves.
    for one, other, near in zip(mine, theirs, (1e-14, 1e-12, 1e-8), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-8, atol=near)


def test_what_a_rank_sees_is_what_others_own():
    (cells, numbers, slabs), (others, theirs, _) = tessellated(CELL, Particles(particles=3000, seed=0), 2)
    beside = np.flatnonzero(numbers[cells.own :] >= theirs[0]) + cells.own
    place = numbers[beside] - theirs[0]
    apart = cells.network.centers[beside] - others.network.centers[place]
    apart[:, 0] -= 2.0 * np.round(apart[:, 0] / 2.0)
    assert len(beside) > 500 and np.abs(apart).max() < 1e-14
    # Nobody knows some at the edge of what is seen only.
    x, (low, high) = cells.network.centers[numbers == NOBODY, 0], slabs.seen
    assert np.all((x < low + 3 * slabs.unit) | (x > high - 3 * slabs.unit))


def test_slabs_share_out_the_box():
    points = np.random.default_rng(0).random((100, 3)) * CELL.size
    owner = slabs_of(CELL, 10_000, 3, 0).owner(points)
    np.testing.assert_array_equal(owner, np.floor(points[:, 0] / 2.0 * 3))
    for rank in range(3):
        slabs = slabs_of(CELL, 10_000, 3, rank)
        near = slabs.near(points)
        assert near[owner == rank].all() and not near.all()
    # The first slab of a periodic box sees the end of the last, between walls nothing.
    last = np.array([[1.999, 0.5, 0.5]])
    assert slabs_of(CELL, 10_000, 3, 0).near(last) and not slabs_of(WALLS, 10_000, 3, 0).near(last)
    assert slabs_of(CELL, 10_000, 3, 0).cut == (True, True) and slabs_of(WALLS, 10_000, 3, 0).cut == (False, True)


def test_more_ranks_than_slabs_are_refused():
    unit = slabs_of(CELL, 10_000, 1, 0).unit
    most = int(2.0 / (GHOSTS * unit))
    slabs_of(CELL, 10_000, most, 0)
    with pytest.raises(ValueError, match=rf"ranks = {most + 1}: .* must be at most {most}"):
        slabs_of(CELL, 10_000, most + 1, 0)


@pytest.mark.parametrize(
    "scene",
    [
        Scene((1.0, 1.0, 1.0), A, [Layer(0, 0.2, 0.4, Material(0.0))], walls={"x-": 0.0, "x+": 1.0}),
        Scene((1.0, 1.0, 1.0), A, walls={"x-": 300.0, "x+": Radiation(0.5, 400.0)}),
        Scene((1.0, 1.0, 1.0), A, domain="sphere", walls={"round": 300.0}),
        Scene((1.0, 1.0, 1.0), Material(1.0, dependence=[(0.0, 1.0), (1.0, 2.0)]), walls={"x-": 0.0, "x+": 1.0}),
        Scene.of_image(Image(np.arange(8).reshape(2, 2, 2) % 2, 0.5, {0: A, 1: B}), gradient=(1, 0, 0)),
    ],
)
def test_other_scenes_are_refused(scene):
    check(WALLS, LAW, Particles(particles=3000, seed=0), 1e-8)
    with pytest.raises(NotImplementedError):
        check(scene, LAW, Particles(particles=3000, seed=0), 1e-8)
