"""Only here: a preconditioner that is not symmetric, or whose bits depend on threads where blocks are several."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import sparse

from demheat.conduction import multigrid_kernels as kernels
from demheat.conduction.multigrid import MOST, preconditioner
from demheat.network.links_kernels import Links


def lattice(side, seed=0):
    """Links of a periodic cubic lattice; some conduct nothing."""
    rng = np.random.default_rng(seed)
    number = np.arange(side**3).reshape(side, side, side)
    ends = np.concatenate([np.column_stack([number.ravel(), np.roll(number, -1, axis).ravel()]) for axis in range(3)])
    g = rng.lognormal(0.0, 1.0, len(ends)) * (rng.random(len(ends)) > 0.05)
    a = sparse.coo_matrix((np.tile(g, 2), np.concatenate([ends, ends[:, ::-1]]).T), shape=(side**3,) * 2).tocsr()
    return Links(a.indptr.astype(np.int64), a.indices.astype(np.uint32), a.data)


def dense(links, diagonal):
    n = len(diagonal)
    rows = links.conductance, links.indices.astype(np.int32), links.indptr
    return np.diag(diagonal) - sparse.csr_matrix(rows, shape=(n, n)).toarray()


def row_sums(links):
    return np.add.reduceat(links.conductance, links.indptr[:-1])


def test_aggregates_hold_every_linked_particle():
    links = lattice(9)
    links.conductance[links.indptr[5] : links.indptr[6]] = 0.0
    links.conductance[links.indices == 5] = 0.0  # particle 5 has no links: none to it either
    top, owner = np.empty(9**3), np.empty(9**3, np.int32)
    kernels.strongest(0, len(top), links, top)
    count = kernels.aggregate(links, top, MOST, owner)
    sizes = np.bincount(owner[owner >= 0], minlength=count)
    assert owner[5] == -1 and np.all(np.delete(owner, 5) >= 0)
    assert sizes.min() >= 1 and 3 < sizes.mean() < MOST


def test_preconditioner_is_symmetric_positive_and_near_the_inverse():
    links = lattice(5)
    diagonal = row_sums(links) + 0.01
    apply, n = preconditioner(links, diagonal), len(diagonal)
    m = np.empty((n, n))
    for k, unit in enumerate(np.eye(n)):
        apply(unit, 1.0, m[k])
    # Sweeps in single precision: 6e-8 of some tens of operations.
    assert_allclose(m, m.T, atol=1e-5 * np.abs(m).max())
    values = np.linalg.eigvals(m @ dense(links, diagonal)).real
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
            preconditioner(links, diagonal)(r, 2.0, z)
            found.append(z)
    finally:
        numba.set_num_threads(before)
    assert np.array_equal(*found)
