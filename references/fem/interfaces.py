"""What passes interfaces with a resistance: the jump of the temperature over it, between the nodes of both sides.

With [T] the jump across the interface its share of the weak form is the integral of [T] [v] / R.
"""

import numpy as np
from scipy.sparse import csr_matrix

from references.fem.elements import at_points, matrix_of

# Exact for products of two quadratics on plane triangles; on curved ones, whose area is no polynomial, as good as that
# of the volumes beside them.
DEGREE = 6


def exchange(mesh, dof) -> csr_matrix:
    """Matrix of the heat that passes from side to side, (n, n) CSR, W/K."""
    values, parts = _parts(mesh)
    products = (values[:, :, None] * values[:, None, :]).reshape(len(values), -1)
    one = (parts @ products).reshape(len(parts), values.shape[1], -1)
    blocks = np.block([[one, -one], [-one, one]])
    rows = dof[mesh.faces.nodes.reshape(len(parts), -1)]
    return matrix_of(blocks, rows, len(mesh.points))


def power(mesh, temperature, gradient) -> float:
    """Integral of [T]^2 / R, W K."""
    values, parts = _parts(mesh)
    rest = temperature - mesh.points @ np.asarray(gradient)
    here, there = np.swapaxes(rest[mesh.faces.nodes], 0, 1)
    return float(np.einsum("tq,tq->", parts, ((here - there) @ values.T) ** 2))


def _parts(mesh):
    """Shape functions at points of triangles, (q, k), and area over resistance there, (t, q) float array, W/K."""
    values, areas = at_points(mesh, mesh.faces.nodes[:, 0], DEGREE)
    return values, areas / mesh.faces.resistance[:, None]


def passed(mesh, dof, rest) -> np.ndarray:
    """What passes from each node where a temperature less that of the mean gradient jumps, (n,) float array, W."""
    values, parts = _parts(mesh)
    nodes, count = mesh.faces.nodes, len(mesh.points)
    heat = (parts * ((rest[nodes[:, 0]] - rest[nodes[:, 1]]) @ values.T)) @ values
    here, there = (np.bincount(dof[side].ravel(), heat.ravel(), count) for side in np.swapaxes(nodes, 0, 1))
    return here - there
