"""Products and sums over rows beside what their formulas say, on random links."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from random_links import balanced, branch, each_link, network_of, random_links, received

from demheat.conduction import products
from demheat.conduction import steady_kernels as kernels
from demheat.runtime.threads import thread_limit

pytestmark = pytest.mark.twin

# More rows than a thread does at a time.
MANY = products.ROWS + 60
GRADIENT = np.array([1.0, -2.0, 0.5])


def vectors(count, n, seed=1):
    return np.random.default_rng(seed).standard_normal((count, n))


def test_vector_steps():
    p, q, x, r = vectors(4, MANY)
    there, left = x.copy(), r.copy()
    blocks = -(-MANY // kernels.BLOCK)
    partial = np.empty(blocks)
    kernels.advance(0, blocks, 0.7, p, q, there, left, partial)
    # One rounding or two of numbers of order one.
    assert_allclose(there, x + 0.7 * p, rtol=0, atol=1e-15)
    assert_allclose(left, r - 0.7 * q, rtol=0, atol=1e-15)
    # Sums of 33 000 numbers in another order.
    assert_allclose(partial.sum(), np.sum(left**2), rtol=1e-12)
    assert products.advance(0.7, p, q, x, r) == partial.sum() and np.array_equal(r, left)
    assert_allclose(products.dot(p, q), np.sum(p * q), rtol=0, atol=1e-11)


def test_matrix_times_vector():
    links, diagonal = balanced(MANY)
    p, q = vectors(2, MANY)
    right = diagonal * p
    for i, _, j, g in each_link(links):
        right[i] -= g * p[j]
    blocks, product = -(-MANY // kernels.BLOCK), products.apply(links, diagonal, p, q)
    again, partial = np.empty(MANY), np.empty(blocks)
    kernels.apply(0, blocks, links, diagonal, p, again, partial)
    assert np.array_equal(q, again) and product == partial.sum()
    # Rounding of sums of some ten numbers of order one to ten; of 33 000 of them.
    assert_allclose(q, right, rtol=0, atol=1e-13)
    assert_allclose(product, np.sum(p * right), rtol=1e-11)


def test_bits_do_not_depend_on_threads():
    links, diagonal = balanced(MANY)
    (p,), found = vectors(1, MANY), []
    for threads in (1, 2):
        q = np.empty(MANY)
        with thread_limit(threads):
            found.append((products.apply(links, diagonal, p, q), products.dot(p, q), q.tobytes()))
    assert found[0] == found[1]


def test_sums_of_rows():
    links, _ = random_links(MANY)
    right = np.zeros(MANY)
    for i, _, _, g in each_link(links):
        right[i] += g
    assert right[-1] == 0.0  # it has no link
    # Rounding of sums of some ten numbers.
    assert_allclose(products.row_sums(links.indptr, links.conductance), right, rtol=1e-14)
    assert products.row_sums(np.zeros(3, np.int64), np.empty(0)).tolist() == [0.0, 0.0]


@pytest.mark.parametrize("per_row", [1, 2])
def test_spread_over_conducting_links(per_row):
    n = 60
    links, _ = random_links(n, per_row=per_row)
    reached = np.zeros(n, bool)
    reached[[3, 40]] = True
    right = set(np.flatnonzero(reached).tolist())
    for _ in range(n):
        right |= {j for i, _, j, g in each_link(links) if i in right and g > 0}
    marked = np.flatnonzero(reached)
    queue = np.append(marked, np.zeros(n - len(marked), int)).astype(np.uint32)
    kernels.spread(links, reached.copy(), queue, len(marked))
    products.spread(links, reached)
    assert set(queue[: len(right)]) == right
    assert set(np.flatnonzero(reached)) == right and 2 < len(right) < n - 1


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
    network = network_of(links, places, area)
    found = *products.flows(network, GRADIENT, x), *products.reconstruct(network, GRADIENT, x)
    again = [np.full_like(each, np.nan) for each in found]
    for begin, end in ((0, 11), (11, n)):
        kernels.flows(begin, end, links, places, GRADIENT, x, *again[:3])
        kernels.reconstruct(begin, end, links, places, area, GRADIENT, x, *again[3:])
    for values, compiled, right in zip(found, again, (heat, passing, first, shape, flow), strict=True):
        # Rounding of sums of some six numbers of order ten.
        assert_allclose(values, right, rtol=0, atol=1e-13)
        assert_allclose(compiled, right, rtol=0, atol=1e-13)


def test_of_few_rows_is_what_is_compiled():
    """A network whose last row has no link, and vectors that go on beyond the rows."""
    n = 60
    links, diagonal = balanced(n)
    (p,), found, compiled, partial = vectors(1, n), np.empty(n), np.empty(n), np.empty(1)
    product = products.apply(links, diagonal, p, found)
    kernels.apply(0, 1, links, diagonal, p, compiled, partial)
    # Rounding of sums of some ten numbers of order one to ten.
    assert_allclose(found, compiled, rtol=0, atol=1e-13)
    # Rounding of a sum of 60 products, some of which cancel, and of 60 squares.
    assert_allclose(product, partial[0], rtol=1e-12)
    q, x, r = vectors(3, n, seed=2)
    there, left = x.copy(), r.copy()
    kernels.advance(0, 1, 0.7, p, q, there, left, partial)
    assert_allclose(products.advance(0.7, p, q, x, r), partial[0], rtol=1e-13)
    assert_allclose([x, r], [there, left], rtol=0, atol=1e-15)
