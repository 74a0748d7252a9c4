"""Conjugate gradients beside the textbook's, on random links."""

import numpy as np
from numpy.testing import assert_allclose
from random_links import balanced, dense

from demheat.conduction.preconditioned import by_diagonal, preconditioned


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


def iterated(links, diagonal, b, start, limit, most):
    """Iterations done, temperatures and residual."""
    r, x = b.copy(), start.copy()
    return preconditioned(links, diagonal, by_diagonal(diagonal), r, x, limit, most, [].append), x, r


def test_conjugate_gradients():
    n = 40
    links, diagonal = balanced(n)
    a, (b, start) = dense(links, diagonal), np.random.default_rng(1).standard_normal((2, n))
    b[-1] = 0.0  # no equation
    for count in (1, 4):
        done, x, r = iterated(links, diagonal, b, start, 0.0, count)
        assert done == count
        # Rounding, before errors of directions have had time to grow.
        assert_allclose((x, r), textbook(a, diagonal, b, start, count), rtol=0, atol=1e-12)
    done, x, r = iterated(links, diagonal, b, start, 1e-11, 200)
    assert 10 < done < 60 and np.linalg.norm(r) <= 1e-11
    # The residual of 1e-11 over the least eigenvalue, which is above 1e-2.
    assert np.linalg.eigvalsh(a[:-1, :-1])[0] > 1e-2
    assert_allclose((x - start)[:-1], np.linalg.solve(a[:-1, :-1], b[:-1]), rtol=0, atol=1e-9)
    assert x[-1] == start[-1]
    assert iterated(links, diagonal, r, x, 1e-3, 200)[0] == 0  # small enough as it is


def test_it_ends_where_the_matrix_is_not_positive():
    links, diagonal = balanced(40)
    # The first direction is 1 everywhere, along which links weigh ten times what the diagonal does.
    done, x, _ = iterated(links, 0.1 * diagonal, 0.1 * diagonal, np.zeros(40), 1e-11, 200)
    assert done == 1 and not x.any()
