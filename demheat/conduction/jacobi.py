"""Conjugate gradients preconditioned by the diagonal, in blocks of iterations that Ctrl-C can come between."""

import numpy as np

import demheat.runtime.threads  # noqa: F401 (chooses the threading layer)
from demheat.conduction import steady_kernels as kernels
from demheat.runtime.blocks import blocks

# Iterations of the first block; those that follow are as many as last a tenth of a second.
FIRST = 4


def jacobi(links, diagonal, r, x, limit, most):
    """Solve A dx = r, adding dx to x in place."""
    direction, product, total = np.empty_like(x), np.zeros(1), 0
    for begin, end in blocks(most, FIRST):
        done = kernels.conjugate_gradients(links, diagonal, r, x, limit, end - begin, direction, product)
        total += abs(done)
        # At the limit, or where rounding has made the matrix indefinite.
        if done >= 0 or -done < end - begin:
            break
    return total
