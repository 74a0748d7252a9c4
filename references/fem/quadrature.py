"""Quadrature on the reference tetrahedron with positive weights, of any degree."""

from functools import cache

import numpy as np
from scipy.special import roots_jacobi
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTet

# scikit-fem's rules by the degree that they integrate exactly, found to be one less than that they are called by.
KNOWN = {1: 1, 2: 2, 3: 6, 4: 6, 5: 6, 6: 7}


@cache
def rule(degree: int):
    """Local points (3, q) and positive weights (q,) of a quadrature on the reference element.

    scikit-fem's up to degree 6; beyond, products of Gauss's on the cube, which is mapped onto the element.
    """
    if degree in KNOWN:
        return get_quadrature(RefTet, KNOWN[degree])
    # The mapping's Jacobian, (1 - z)^2 (1 - y), is the weight of the one-dimensional rules.
    (x, a), (y, b), (z, c) = (roots_jacobi(degree // 2 + 1, power, 0) for power in (0, 1, 2))
    (x, a), (y, b), (z, c) = ((1 + x) / 2, a / 2), ((1 + y) / 2, b / 4), ((1 + z) / 2, c / 8)
    x, y, z = (each.ravel() for each in np.meshgrid(x, y, z, indexing="ij"))
    weights = np.einsum("i,j,k->ijk", a, b, c).ravel()
    return np.stack([x * (1 - y) * (1 - z), y * (1 - z), z]), weights
