"""Only here: kernels of the steady solver beside their formulas, on random links, over several blocks."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from random_links import branch, dense, each_link, random_links, received

from demheat.conduction import steady_kernels as kernels

pytestmark = pytest.mark.twin

# More than one block of rows.
MANY = kernels.BLOCK + 60
GRADIENT = np.array([1.0, -2.0, 0.5])


def vectors(count, n, seed=1):
    return np.random.default_rng(seed).standard_normal((count, n))


def balance(n, seed=0):
    """Links and a diagonal that makes a positive matrix; the last point has no link and no equation."""
    links, _ = random_links(n, seed=seed)
    total = np.add.reduceat(np.append(links.conductance, 0.0), links.indptr[:-1]) * (np.diff(links.indptr) > 0)
    diagonal = total + np.where(np.arange(n) % 7 == 0, 0.5, 0.0)
    diagonal[-1] = 0.0
    return links, diagonal


def test_vector_steps():
    p, q, z, x, r = vectors(5, MANY)
    turned, there, left = p.copy(), x.copy(), r.copy()
    kernels.direct(0.3, z, turned)
    squares = kernels.advance(0.7, p, q, there, left)
    # One rounding or two of numbers of order one.
    assert_allclose(turned, z + 0.3 * p, rtol=0, atol=1e-15)
    assert_allclose(there, x + 0.7 * p, rtol=0, atol=1e-15)
    assert_allclose(left, r - 0.7 * q, rtol=0, atol=1e-15)
    # Sums of 2000 numbers in another order.
    assert_allclose(squares, np.sum(left**2), rtol=1e-13)
    assert_allclose(kernels.dot(p, q), np.sum(p * q), rtol=0, atol=1e-12)


def test_matrix_times_vector():
    links, diagonal = balance(MANY)
    p, b, q, r = vectors(4, MANY)
    right = diagonal * p
    for i, _, j, g in each_link(links):
        right[i] -= g * p[j]
    product = kernels.apply(links, diagonal, p, q)
    kernels.residual(links, diagonal, b, p, r)
    # Rounding of sums of some ten numbers of order one to ten; of 2000 of them.
    assert_allclose(q, right, rtol=0, atol=1e-13)
    assert_allclose(r, b - right, rtol=0, atol=1e-13)
    assert_allclose(product, np.sum(p * right), rtol=1e-12)


def textbook(a, diagonal, b, x, count):
    """Some iterations of conjugate gradients, preconditioned by a diagonal, for a dx = b."""
    r, inverse = b.copy(), np.divide(1.0, diagonal, out=np.zeros(len(b)), where=diagonal > 0)
    p = inverse * r
    for _ in range(count):
        rz = r @ (inverse * r)
        alpha = rz / (p @ a @ p)
        x, r = x + alpha * p, r - alpha * (a @ p)
        p = inverse * r + (r @ (inverse * r)) / rz * p
    return x, r


def fresh(n):
    return np.full(n, np.nan), np.zeros(1)


def test_conjugate_gradients_go_on_where_they_stopped():
    n = 40
    links, diagonal = balance(n)
    (b, start), whole, parts = vectors(2, n), fresh(n), fresh(n)
    b[-1] = 0.0  # no equation
    once, twice = (b.copy(), start.copy()), (b.copy(), start.copy())
    kernels.conjugate_gradients(links, diagonal, *once, 0.0, 7, *whole)
    for count in (3, 1, 3):
        kernels.conjugate_gradients(links, diagonal, *twice, 0.0, count, *parts)
    assert np.array_equal(once, twice) and np.array_equal(whole[0], parts[0])


def test_conjugate_gradients():
    n = 40
    links, diagonal = balance(n)
    a, (b, start) = dense(links, diagonal), vectors(2, n)
    b[-1] = 0.0  # no equation
    for count in (1, 4):
        r, x = b.copy(), start.copy()
        assert kernels.conjugate_gradients(links, diagonal, r, x, 0.0, count, *fresh(n)) == -count
        # Rounding, before errors of directions have had time to grow.
        assert_allclose((x, r), textbook(a, diagonal, b, start, count), rtol=0, atol=1e-12)
    r, x = b.copy(), start.copy()
    done = kernels.conjugate_gradients(links, diagonal, r, x, 1e-11, 200, *fresh(n))
    assert 10 < done < 60 and np.linalg.norm(r) <= 1e-11
    # The residual of 1e-11 over the least eigenvalue, which is above 1e-2.
    assert np.linalg.eigvalsh(a[:-1, :-1])[0] > 1e-2
    assert_allclose((x - start)[:-1], np.linalg.solve(a[:-1, :-1], b[:-1]), rtol=0, atol=1e-9)
    assert x[-1] == start[-1]
    assert kernels.conjugate_gradients(links, diagonal, r, x, 1e-3, 200, *fresh(n)) == 0  # small enough as it is


def test_sums_of_rows():
    links, _ = random_links(MANY)
    total, right = np.empty(MANY), np.zeros(MANY)
    kernels.row_sums(links, total)
    for i, _, _, g in each_link(links):
        right[i] += g
    assert np.array_equal(total, right)  # the same order: the same bits


@pytest.mark.parametrize("per_row", [1, 2])
def test_spread_over_conducting_links(per_row):
    n = 60
    links, _ = random_links(n, per_row=per_row)
    reached = np.zeros(n, bool)
    reached[[3, 40]] = True
    right = set(np.flatnonzero(reached).tolist())
    for _ in range(n):
        right |= {j for i, _, j, g in each_link(links) if i in right and g > 0}
    kernels.spread(links, reached)
    assert set(np.flatnonzero(reached)) == right and 2 < len(right) < n - 1


def test_spread_over_more_links_than_there_was_room_for():
    n = 1500
    links, _ = random_links(n, per_row=2)
    first, last = np.ones(n - 1, int), np.full(n - 1, n - 1)
    # Every point is linked to the first one: a front of all others, once it is reached.
    star = links._replace(
        indptr=np.concatenate([[0], [n - 1], n - 1 + np.cumsum(first)]),
        indices=np.concatenate([np.arange(1, n), 0 * last]).astype(np.uint32),
        conductance=np.ones(2 * (n - 1)),
    )
    reached = np.arange(n) == 7
    kernels.spread(star, reached)
    assert reached.all()


def test_flows_and_moments():
    n = 30
    links, places = random_links(n)
    x, area = vectors(1, n)[0], np.random.default_rng(5).random(len(links.indices))
    heat, passing, first = np.zeros(n), np.zeros(n), np.zeros((n, 3))
    shape, flow = np.zeros((n, 3, 3)), np.zeros((n, 3))
    for i, e, _, _ in each_link(links):
        w, b = received(i, e, links, places, GRADIENT, x), branch(i, e, links, places)
        unit = b / np.linalg.norm(b)
        heat[i] += w
        passing[i] += abs(w)
        first[i] += 0.5 * w * b
        shape[i] += area[e] * np.outer(unit, unit)
        flow[i] += w * unit
    found = [np.full_like(right, np.nan) for right in (heat, passing, first, shape, flow)]
    kernels.flows(links, places, GRADIENT, x, *found[:2])
    kernels.moments(links, places, GRADIENT, x, found[2])
    kernels.reconstruct(links, places, area, GRADIENT, x, *found[3:])
    for values, right in zip(found, (heat, passing, first, shape, flow), strict=True):
        # Rounding of sums of some six numbers of order ten.
        assert_allclose(values, right, rtol=0, atol=1e-13)
