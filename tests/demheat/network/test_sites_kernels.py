"""Only here: sites that cut a cell and that the search by rings does not reach."""

import numpy as np
import pytest

import demheat.runtime.threads  # noqa: F401 (chooses the threading layer)
from demheat.network import sites_kernels as kernels
from demheat.network.laguerre import filed

SIZE = np.array([2.0, 1.0, 1.0])


def cloud(periodic, *, n=200):
    rng = np.random.default_rng(2)
    weights = rng.uniform(0.0, 0.02, n)
    weights[:3] = 0.5, 0.6, 4.0  # two more levels
    return filed(rng.random((n, 3)) * SIZE, weights, SIZE, np.array(periodic), (2.0 / n) ** (1 / 3))


def brute(i, level, sites, farthest):
    """Labels and plane distances of all images of the sites of a level that cut a ball around site i."""
    found = {}
    items = sites.items[level_of(sites) == level]
    shifts = [(-1, 0, 1) if wraps else (0,) for wraps in sites.periodic]
    for code, shift in ((9 * a + 3 * b + c + 13, (a, b, c)) for a in shifts[0] for b in shifts[1] for c in shifts[2]):
        for j in items:
            offset = sites.points[j] + np.array(shift) * SIZE - sites.points[i]
            square = offset @ offset
            if square == 0.0:
                continue
            plane = (square + sites.weights[i] - sites.weights[j]) / (2 * np.sqrt(square))
            if plane < farthest:
                found[32 * int(j) + code] = plane
    return found


def offset_of(label, i, sites):
    """From site i to the image of a site that a label names."""
    j, code = divmod(label, 32)
    return sites.points[j] + (np.array([code // 9, code // 3 % 3, code % 3]) - 1) * SIZE - sites.points[i]


def level_of(sites):
    """Level of each item."""
    cells = sites.counts.prod(axis=1)
    ends = [sites.start[first + number] for first, number in zip(sites.first, cells, strict=True)]
    return np.searchsorted(ends, np.arange(len(sites.items)), side="right")


def test_a_cell_of_a_grid_holds_about_one_site():
    """Fewer are searched for nothing and fill the memory, more are compared one by one."""
    points = np.random.default_rng(0).random((2000, 3)) * SIZE
    sites = filed(points, np.zeros(2000), SIZE, np.array([True] * 3), (2.0 / 2000) ** (1 / 3))
    # 1.1^3 of them, and more where widths are made to divide the box.
    assert 1.3 < 2000 / sites.counts.prod() < 2.0


@pytest.mark.twin
@pytest.mark.parametrize("periodic", [(False, False, False), (True, True, False)])
def test_rings_find_every_site_that_cuts_and_keep_their_distance(periodic):
    sites, found = cloud(periodic), kernels.empty_candidates(6000)
    assert len(sites.heaviest) == 3 and sorted(sites.items) == list(range(200))
    for i, level in ((i, level) for i in (0, 2, 50, 120) for level in range(3)):
        farthest = 0.3
        kernels.find_home(i, level, sites, found)
        right, got, ring, distance = brute(i, level, sites, farthest), {}, 1, 0.0
        while True:
            m = kernels.gather_ring(i, ring, level, farthest, sites, found)
            for label, plane in zip(found.label[:m], found.plane, strict=False):
                offset = offset_of(label, i, sites)
                assert label not in got and np.linalg.norm(offset) >= distance
                np.testing.assert_allclose(plane[:3], offset / np.linalg.norm(offset), atol=1e-12)
                got[int(label)] = plane[3]
            ring += 1
            distance, ended = kernels.ring_distance(ring, found.grid, found.frame)
            reach = kernels.cutting_reach(farthest, sites.weights[i], sites.heaviest[level])
            if distance >= reach or ended:
                break
        # Where the rings ended before the reach did, the images that are left are farther than the box is wide.
        assert distance >= min(reach, 1.0)
        assert got.keys() == right.keys()
        assert all(abs(got[label] - right[label]) < 1e-12 for label in got)  # rounding of coordinates of order one


@pytest.mark.twin
def test_no_site_beyond_the_reach_cuts():
    for farthest, weight, heaviest in ((0.5, 0.1, 0.3), (0.5, 0.3, 0.1), (0.1, 0.3, 0.1)):
        reach = kernels.cutting_reach(farthest, weight, heaviest)
        far = np.linspace(reach + 1e-6, 3.0, 200)
        assert np.all((far**2 + weight - heaviest) / (2 * far) > farthest)
        if reach > 0:  # and it is no larger than need be
            assert ((reach - 1e-6) ** 2 + weight - heaviest) / (2 * (reach - 1e-6)) < farthest


@pytest.mark.twin
def test_candidates_without_room():
    sites, found = cloud((True, True, True)), kernels.empty_candidates(3)
    kernels.find_home(7, 0, sites, found)
    assert kernels.gather_ring(7, 1, 0, 1.0, sites, found) == -1


@pytest.mark.twin
def test_candidates_come_nearest_plane_first_but_for_those_of_a_bin():
    rng, found = np.random.default_rng(1), kernels.empty_candidates(80)
    for plane in (rng.uniform(-0.5, 2.0, 80), np.full(5, -np.inf), np.append(rng.random(30), -np.inf), np.ones(1)):
        m = len(plane)
        found.plane[:m, 3] = plane
        kernels.arrange(found, m)
        order = found.order[:m]
        assert sorted(order) == list(range(m))
        # Within a bin they stay as they were; those that are not before the site itself share the first bin.
        widest = max(plane.max(), 0.0) / (kernels.BINS - 1)
        steps = np.diff(np.maximum(plane[order], 0.0))
        assert np.all((steps > 0) | (-steps <= widest) & (np.diff(order.astype(int)) > 0))
