"""Only here: kernels of multigrid beside their definitions: strong links, aggregates, sweeps, ways between levels."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from random_links import dense, each_link, random_links
from scipy import sparse
from scipy.sparse.linalg import spsolve_triangular

from demheat.conduction import multigrid_kernels as kernels

N, MOST = 60, 4


@pytest.fixture(scope="module")
def links():
    return random_links(N, single=True)[0]


@pytest.fixture(scope="module")
def top(links):
    found = np.empty(N)
    kernels.strongest(0, N, links, found)
    return found


def grouped(links, top):
    owner = np.empty(N, np.int32)
    return kernels.members(owner, kernels.aggregate(links, top, MOST, owner))


def level_of(links, inverse, scale=1.0):
    n = len(inverse)
    place, values = np.empty(len(links.indices), np.uint8), np.empty(len(links.indices), np.float32)
    ends = np.empty((n, 2), np.uint8)
    level = kernels.Level(links.indptr, links.indices, ends, place, values, inverse.astype(np.float32))
    kernels.arrange(0, -(-n // kernels.ROWS), links, scale, level)
    return level


@pytest.mark.twin
def test_strongest_links(links, top):
    right = np.zeros(N)
    for i, _, _, g in each_link(links):
        right[i] = max(right[i], g)
    assert np.array_equal(top, right) and top[-1] == 0.0


def aggregated(links, top):
    """Aggregates by the rule as written, with lists and sorting."""
    linked = [{} for _ in range(N)]
    for i, _, j, g in each_link(links):
        linked[i][j] = g
    owner, count = np.full(N, -1), 0
    for i in range(N):
        strong = {j: g for j, g in linked[i].items() if g > 0 and g >= kernels.STRONG * max(top[i], top[j])}
        free = sorted((j for j in strong if owner[j] < 0), key=strong.get, reverse=True)[: MOST - 1]
        if owner[i] < 0 and top[i] > 0 and 3 * len(free) >= MOST - 1:
            owner[[i, *free]] = count
            count += 1
    for i in range(N):
        if owner[i] < 0 and top[i] > 0:
            joined = {j: g for j, g in linked[i].items() if owner[j] >= 0 and g > kernels.STRONG * top[i]}
            owner[i] = owner[max(joined, key=joined.get)] if joined else count
            count += 0 if joined else 1
    return owner, count


@pytest.mark.twin
def test_aggregates_are_those_of_the_rule(links, top):
    right, count = aggregated(links, top)
    aggregates = grouped(links, top)
    assert np.array_equal(aggregates.owner, right)
    assert len(aggregates.start) == count + 1 and 10 < count < 40 and right[-1] == -1
    for c in range(count):
        members = aggregates.rows[aggregates.start[c] : aggregates.start[c + 1]]
        assert np.array_equal(members, np.flatnonzero(right == c))


@pytest.mark.twin
def test_galerkin_matrix(links, top):
    aggregates, diagonal = grouped(links, top), np.random.default_rng(2).random(N) + 5.0
    count = len(aggregates.start) - 1
    pointers, columns, values = kernels.galerkin(links, diagonal, 0.5, aggregates)
    coarse = sparse.csr_matrix((values, columns, pointers), shape=(count, count)).toarray()
    spread = (aggregates.owner[:, None] == np.arange(count)).astype(float)
    # Rounding of sums of some tens of numbers of order one to ten.
    assert_allclose(coarse, 0.5 * spread.T @ dense(links, diagonal) @ spread, rtol=0, atol=1e-13)
    assert np.array_equal(columns[pointers[:-1]], np.arange(count))  # the diagonal comes first


@pytest.mark.twin
def test_arranged_links():
    links, _ = random_links(N, seed=1)
    level, loops = level_of(links, np.ones(N), scale=0.7), 0
    for i in range(N):
        here = slice(links.indptr[i], links.indptr[i + 1])
        j, g = links.indices[here].astype(int), (0.7 * links.conductance[here]).astype(np.float32)
        low, own, high = np.flatnonzero(j < i), np.flatnonzero(j == i), np.flatnonzero(j > i)
        # One block holds all rows: lower ones as they come, then links to own images, higher ones from the end.
        order = [*low, *own, *high[::-1]]
        assert np.array_equal(level.place[here], order) and np.array_equal(level.values[here], g[order])
        assert level.ends[i].tolist() == [len(low), len(j) - len(high)]
        loops += len(own)
    assert loops > 0


@pytest.mark.twin
def test_sweeps():
    links, _ = random_links(N, seed=1)
    rng = np.random.default_rng(3)
    r, diagonal = rng.standard_normal(N), rng.random(N) + 20.0
    level, load = level_of(links, 1.0 / diagonal), r.astype(np.float32)
    x, d, y = np.full((3, N), np.nan, np.float32)
    kernels.forward(0, 1, level, load, x)
    kernels.defect(0, N, level, x, d)
    kernels.backward(0, 1, level, load, x, y)
    a = dense(links, diagonal)
    # Links to own images take no part in the triangles, but in what is left.
    lower, upper = np.tril(a, -1) + np.diag(diagonal), np.triu(a, 1) + np.diag(diagonal)
    slow = np.linalg.solve(lower, r)
    # Single precision: 6e-8 of sums of some six numbers of order one to ten.
    assert_allclose(x, slow, rtol=0, atol=1e-6)
    assert_allclose(d, r - a @ slow, rtol=0, atol=1e-5)
    assert_allclose(y, np.linalg.solve(upper, r - (a - upper) @ slow), rtol=0, atol=1e-6)


@pytest.mark.twin
def test_ways_to_the_aggregates_and_back(links, top):
    aggregates, rng = grouped(links, top), np.random.default_rng(4)
    count = len(aggregates.start) - 1
    d, coarse, below = rng.standard_normal(N).astype(np.float32), rng.standard_normal(count), np.full(count, np.nan)
    kernels.restrict(0, count, aggregates, d, below)
    for c in range(count):
        # Rounding of sums of up to ten numbers, in double precision.
        assert_allclose(below[c], d[aggregates.owner == c].astype(float).sum(), rtol=0, atol=1e-14)
    x = d.copy()
    kernels.correct(0, N, aggregates, coarse, 1.6, x)
    right = d + np.where(aggregates.owner >= 0, 1.6 * coarse[aggregates.owner], 0.0)
    assert_allclose(x, right, rtol=0, atol=1e-6)  # single precision


def test_sweeps_are_those_of_the_definition_within_blocks():
    """On more rows than one block has: links between blocks belong to neither sweep."""
    n = kernels.ROWS + 3000
    links, _ = random_links(n, per_row=4)
    g, indices, indptr = links.conductance, links.indices.astype(np.int32), links.indptr
    diagonal = np.bincount(np.repeat(np.arange(n), np.diff(indptr)), g, minlength=n) + 1.0
    level = level_of(links, 1.0 / diagonal)
    r = np.random.default_rng(2).standard_normal(n).astype(np.float32)
    x, y, d = np.empty((3, n), np.float32)
    kernels.forward(0, 2, level, r, x)
    kernels.defect(0, n, level, x, d)
    kernels.backward(0, 2, level, r, x, y)
    off = sparse.csr_matrix((g, indices, indptr), shape=(n, n)).tocoo()
    a = sparse.diags(diagonal) - off
    inside = (off.row // kernels.ROWS == off.col // kernels.ROWS) & (off.row != off.col)
    block = sparse.coo_matrix((off.data[inside], (off.row[inside], off.col[inside])), shape=(n, n))
    lower, upper = (sparse.diags(diagonal) - part(block, k) for part, k in ((sparse.tril, -1), (sparse.triu, 1)))
    slow = spsolve_triangular(lower.tocsr(), r.astype(float))
    # Single precision: 6e-8 of sums of some four numbers, handed on from row to row.
    assert_allclose(x, slow, atol=2e-5)
    assert_allclose(d, r - a @ slow, atol=1e-4)
    assert_allclose(y, spsolve_triangular(upper.tocsr(), r - (a - upper) @ slow, lower=False), atol=2e-5)
    assert not inside.all()
