import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import sparse
from scipy.sparse.linalg import spsolve_triangular

from demheat.conduction import multigrid_kernels as kernels
from demheat.conduction.multigrid import MOST, preconditioner


def lattice(side, seed=0):
    """Pointers, numbers and conductances of the links of a periodic cubic lattice; some conduct nothing."""
    rng = np.random.default_rng(seed)
    number = np.arange(side**3).reshape(side, side, side)
    ends = np.concatenate([np.column_stack([number.ravel(), np.roll(number, -1, axis).ravel()]) for axis in range(3)])
    g = rng.lognormal(0.0, 1.0, len(ends)) * (rng.random(len(ends)) > 0.05)
    a = sparse.coo_matrix((np.tile(g, 2), np.concatenate([ends, ends[:, ::-1]]).T), shape=(side**3,) * 2).tocsr()
    return a.indptr.astype(np.int64), a.indices.astype(np.uint32), a.data


def dense(indptr, indices, g, diagonal):
    n = len(diagonal)
    return np.diag(diagonal) - sparse.csr_matrix((g, indices.astype(np.int32), indptr), shape=(n, n)).toarray()


def grouped(links):
    top, owner = np.empty(len(links[0]) - 1), np.empty(len(links[0]) - 1, np.int32)
    kernels.strongest(links[0], links[2], top)
    return owner, kernels.aggregate(*links, top, MOST, owner)


def row_sums(links):
    return np.add.reduceat(links[2], links[0][:-1])


def test_aggregates_hold_every_linked_particle():
    links = lattice(9)
    links[2][links[0][5] : links[0][6]] = 0.0
    for e in range(len(links[1])):  # particle 5 has no links: none to it either
        links[2][e] *= links[1][e] != 5
    owner, count = grouped(links)
    sizes = np.bincount(owner[owner >= 0], minlength=count)
    assert owner[5] == -1 and np.all(np.delete(owner, 5) >= 0)
    assert sizes.min() >= 1 and 3 < sizes.mean() < MOST


def test_galerkin_matrix_is_that_of_the_definition():
    links = lattice(6)
    diagonal = row_sums(links) + 0.1
    owner, count = grouped(links)
    pointers, columns, values = kernels.galerkin(*links, diagonal, 0.5, owner, *kernels.members(owner, count))
    spread = np.eye(count)[owner]
    coarse = sparse.csr_matrix((values, columns, pointers), shape=(count, count)).toarray()
    # sums of some tens of numbers of order one: rounding
    assert_allclose(coarse, 0.5 * spread.T @ dense(*links, diagonal) @ spread, atol=1e-13)


def test_preconditioner_is_symmetric_positive_and_near_the_inverse():
    links = lattice(5)
    diagonal = row_sums(links) + 0.01
    apply, n = preconditioner(*links, diagonal), len(diagonal)
    m = np.empty((n, n))
    for k, unit in enumerate(np.eye(n)):
        apply(unit, 1.0, m[k])
    # Sweeps in single precision: 6e-8 of some tens of operations.
    assert_allclose(m, m.T, atol=1e-5 * np.abs(m).max())
    values = np.linalg.eigvals(m @ dense(*links, diagonal)).real
    # One V-cycle: without its coarse levels (Gauss-Seidel alone) the least eigenvalue is below 0.02.
    assert values.min() > 0.2 and values.max() < 2.0


def test_bits_do_not_depend_on_threads():
    numba = pytest.importorskip("numba")
    links = lattice(41)
    diagonal = row_sums(links) + 1e-3
    assert len(diagonal) > kernels.ROWS  # two blocks at least
    r, before, found = np.random.default_rng(1).standard_normal(len(diagonal)), numba.get_num_threads(), []
    try:
        for threads in (1, before):
            numba.set_num_threads(threads)
            z = np.empty_like(r)
            preconditioner(*links, diagonal)(r, 2.0, z)
            found.append(z)
    finally:
        numba.set_num_threads(before)
    assert np.array_equal(*found)


def test_sweeps_are_those_of_the_definition_within_blocks():
    links = lattice(41)
    indptr, indices, g = links
    diagonal, n = row_sums(links) + 1e-3, len(indptr) - 1
    columns, values, ends = np.empty(len(g), np.uint32), np.empty(len(g), np.float32), np.empty((n, 2), np.int64)
    kernels.arranged(*links, 1.0, columns, values, ends)
    r = np.random.default_rng(2).standard_normal(n).astype(np.float32)
    inverse, x, y, d = (1 / diagonal).astype(np.float32), *np.empty((3, n), np.float32)
    placed = (indptr, ends, columns, values)
    kernels.forward(*placed, inverse, r, x)
    kernels.defect(*placed, x, d)
    kernels.backward(*placed, inverse, r, x, y)
    off = sparse.csr_matrix((g, indices.astype(np.int32), indptr), shape=(n, n)).tocoo()
    a = sparse.diags(diagonal) - off
    inside = off.row // kernels.ROWS == off.col // kernels.ROWS
    block = sparse.coo_matrix((off.data[inside], (off.row[inside], off.col[inside])), shape=(n, n))
    lower, upper = (sparse.diags(diagonal) - part(block, k) for part, k in ((sparse.tril, -1), (sparse.triu, 1)))
    slow = spsolve_triangular(lower.tocsr(), r.astype(float))
    # Single precision: 6e-8 of sums of seven numbers, handed on from row to row.
    assert_allclose(x, slow, atol=2e-5)
    assert_allclose(d, r - a @ slow, atol=2e-5)
    assert_allclose(y, spsolve_triangular(upper.tocsr(), r - (a - upper) @ slow, lower=False), atol=2e-5)
