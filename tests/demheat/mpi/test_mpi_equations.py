"""Only here: a multigrid cycle of all ranks that is not symmetric or takes more iterations; PETSc is stood in for."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from ranks import on_ranks
from scipy import sparse
from scipy.sparse.linalg import splu

from demheat import Laguerre, Material, Scene, Sphere
from demheat.conduction.balance import residual, system_of
from demheat.conduction.products import apply
from demheat.dem.options import Particles
from demheat.mpi.cells import cells_of, part_of
from demheat.mpi.equations import own_rows, preconditioner
from demheat.mpi.numbers import numbers_of
from demheat.mpi.slabs import NOBODY, slabs_of

SPHERE = Sphere((1.0, 0.4, 0.5), 0.3, Material(100.0))
WALLS = Scene((2.0, 1.0, 1.0), Material(10.0), (SPHERE,), walls={"x-": 300.0, "x+": 400.0})
CELL = Scene((2.0, 1.0, 1.0), Material(10.0), (SPHERE,), gradient=(1.0, 0.0, 0.0))
PARTICLES = Particles(particles=3000, seed=0)


class Beside:
    """What PETSc's scatter does, by gathering everything."""

    def __init__(self, numbers, own, comm):
        self.numbers, self.own, self.size, self.comm = numbers, own, len(numbers), comm
        self.known = own + np.flatnonzero(numbers[own:] != NOBODY)

    def filled(self, values):
        seen = np.full(self.size, np.nan)
        seen[: self.own] = values
        self.update(seen)
        return seen

    def update(self, seen):
        whole = np.concatenate(self.comm.allgather(seen[: self.own].copy()))
        seen[self.known] = whole[self.numbers[self.known]]


class Exactly:
    """The matrix of all aggregates, and its solution."""

    def __init__(self, comm, shift):
        self.comm, self.shift = comm, shift

    def takes(self, pointers, columns, values):
        count = len(pointers) - 1
        counts = self.comm.allgather(count)
        rows = sparse.csr_matrix((values, columns, pointers), shape=(count, sum(counts)))
        whole = sparse.vstack(self.comm.allgather(rows)).tocsc()
        # Both ranks of a link have it from their own cells, which agree to rounding.
        assert abs(whole - whole.T).max() < 1e-9 * abs(whole).max()
        self.matrix, self.here = whole, slice(*np.cumsum([0, *counts])[[self.comm.rank, self.comm.rank + 1]])
        self.lu = splu(whole + self.shift * sparse.identity(whole.shape[0]))

    def solve(self, r):
        return self.lu.solve(np.concatenate(self.comm.allgather(r.copy())))[self.here]


def made(scene, ranks, then):
    """What a function of a rank's links, diagonal, ghosts, cycle and system returns on each rank."""

    def work(comm):
        slabs, law = slabs_of(scene, PARTICLES.particles, comm.size, comm.rank), Laguerre()
        cells = cells_of(scene, law, part_of(scene, law, PARTICLES, slabs, comm), slabs, comm)
        numbers = numbers_of(cells.network, cells.own, slabs, comm)
        ghosts, below = Beside(numbers, cells.own, comm), Exactly(comm, 1e-6 if scene.periodic else 0.0)
        system = system_of(cells.network, scene, np.ones(len(numbers), dtype=bool))
        rows = own_rows(system, cells.own)
        return then(comm, system, rows, ghosts, preconditioner(*rows, ghosts, below, comm), below)

    return on_ranks(ranks, work)


def product(rows, ghosts, x):
    seen, q = ghosts.filled(x), np.empty(ghosts.own)
    apply(*rows, seen, q)
    return q


def iterations(scene, ranks):
    """Of conjugate gradients to 1e-8 of the first residual."""

    def then(comm, system, rows, ghosts, cycle, _):
        def dot(a, b):
            return comm.allreduce(float(a @ b))

        x, z = np.zeros(ghosts.own), np.empty(ghosts.own)
        r = residual(system, ghosts.filled(x))[: ghosts.own]
        first = dot(r, r) ** 0.5
        p, rz, count = np.zeros_like(r), 1.0, 0
        while dot(r, r) ** 0.5 > 1e-8 * first and count < 100:
            cycle(r, first, z)
            rz, before = dot(r, z), rz
            p = z + (rz / before if count else 0.0) * p
            q = product(rows, ghosts, p)
            step = rz / dot(p, q)
            x, r, count = x + step * p, r - step * q, count + 1
        left = system.heat[: ghosts.own] - product(rows, ghosts, x)
        return count, dot(left, left) ** 0.5 / first

    ((count, left), *others) = made(scene, ranks, then)
    assert all(each == (count, left) for each in others)
    # Rounding, at most as much as is left.
    assert left < 2e-8
    return count


@pytest.mark.parametrize("scene", [WALLS, CELL], ids=["walls", "periodic"])
def test_slabs_take_as_many_iterations_as_the_whole(scene):
    one, *more = (iterations(scene, ranks) for ranks in (1, 3))
    assert one < 30
    # Aggregates end at the slabs' ends: a little is lost.
    assert max(more) <= one + 3


def test_the_cycle_of_two_ranks_is_symmetric():
    def then(comm, _, rows, ghosts, cycle, __):
        rng = np.random.default_rng(comm.rank)
        a, b = rng.standard_normal((2, ghosts.own))
        ma, mb = np.empty_like(a), np.empty_like(a)
        cycle(a, 1.0, ma), cycle(b, 1.0, mb)
        return [comm.allreduce(float(u @ v)) for u, v in ((a, mb), (b, ma), (a, ma))]

    one, other, size = made(WALLS, 2, then)[0]
    # Single precision: 6e-8 of sums that are summed up over some thousands of rows.
    assert abs(one - other) < 1e-5 * size
    assert abs(one) > 1e-3 * size


def test_the_rows_of_the_aggregates_are_those_of_the_matrix():
    """Sums of all rows of a pair of aggregates: by a product with ones on one aggregate of each rank."""

    def then(comm, system, rows, ghosts, _, below):
        ones = np.ones(ghosts.own)
        # What all aggregates together give is what all particles together give, up to the scale.
        total = comm.allreduce(float(product(rows, ghosts, ones).sum()))
        return total, below.matrix.sum(), max(comm.allgather(float(rows[1].max()))), below.matrix.shape[0]

    (total, coarse, largest, count) = made(WALLS, 2, then)[0]
    assert_allclose(coarse, total / largest, rtol=1e-9)  # rounding of sums of some ten thousand numbers
    assert 100 < count < PARTICLES.particles / 4
