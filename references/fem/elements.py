"""Linear and quadratic tetrahedra: shape functions and quadrature by scikit-fem, integrals in blocks of elements."""

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix
from skfem.element import ElementTetP1, ElementTetP2, ElementTriP1, ElementTriP2
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTet, RefTri

from demheat.runtime.progress import stage

# By the number of nodes; scikit-fem orders the nodes as `Mesh.cells` and `Wall.triangles` do.
ELEMENTS = {4: ElementTetP1(), 10: ElementTetP2(), 3: ElementTriP1(), 6: ElementTriP2()}
# Elements per block: the largest array, 14 points x 10 functions x 3 components, is then 67 MB.
BLOCK = 20_000


def shapes(nodes, X):
    """Shape functions of the element with so many nodes."""
    values, gradients = zip(*(ELEMENTS[nodes].lbasis(X, i) for i in range(nodes)), strict=True)
    values = np.stack([np.broadcast_to(v, X.shape[1:]) for v in values], axis=-1)
    # scikit-fem gives the constant gradients of linear elements either once or once per point.
    gradients = [g.reshape(g.shape + (1,) * (X.ndim - g.ndim)) for g in gradients]
    gradients = np.stack([np.broadcast_to(g, X.shape) for g in gradients], axis=-1)
    return values, np.moveaxis(gradients, 0, -1)


def inverse(J):
    """Inverse and determinant of (..., 3, 3) matrices."""
    a, b, c = J[..., 0], J[..., 1], J[..., 2]
    rows = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=-2)
    det = np.einsum("...i,...i->...", a, rows[..., 0, :])
    return rows / det[..., None, None], det


def blocks(mesh, degree=5, straight=None):
    """Split a mesh into blocks of elements, each with its quadrature.

    It is exact for straight elements. Curved ones get the degree asked for: 5 (14 points, some on edges) or 7 (24, all
    inside); the Jacobian and the flux, both cubics, are integrated exactly either way, all weights are positive.
    """
    rules = straight or get_quadrature(RefTet, 0 if mesh.cells.shape[1] == 4 else 2), get_quadrature(RefTet, degree)
    for ids, rule in zip((np.flatnonzero(~mesh.curved), np.flatnonzero(mesh.curved)), rules, strict=True):
        for start in range(0, len(ids), BLOCK):
            yield ids[start : start + BLOCK], rule


def gradients(mesh, ids, rule):
    """Gradients of the shape functions of one block at its quadrature points."""
    X, weights = rule
    cells = mesh.cells[ids]
    _, local = shapes(cells.shape[1], X)
    # The mapping of a straight element is that of its corners, with one constant gradient.
    geometry = local
    if not mesh.curved[ids[0]]:
        _, geometry = shapes(4, X[:, :1])
    nodes = mesh.points[cells[:, : geometry.shape[1]]]
    back, det = inverse(np.einsum("bnx,qnk->bqxk", nodes, geometry, optimize=True))
    return local @ back, det * weights


def assemble(mesh, conductivity, dof, lift):
    """Stiffness matrix, and the load that a known part of the temperature makes."""
    matrix, (load,) = assemble_loads(mesh, conductivity, dof, [lift])
    return matrix, load


def assemble_loads(mesh, conductivity, dof, lifts, medium=None):
    """The same for several known parts, with one matrix."""
    count, parts, loads, seen = len(mesh.points), [], np.zeros((len(lifts), len(mesh.points))), 0
    with stage("assembly") as done:
        for ids, rule in blocks(mesh, straight=medium and medium.straight):
            seen += len(ids)
            done(seen / len(mesh.cells))
            ids = ids[conductivity[ids] > 0]
            if not len(ids):
                continue
            matrices = _matrices(mesh, ids, rule, conductivity[ids], medium)
            rows = dof[mesh.cells[ids]]
            for load, lift in zip(loads, lifts, strict=True):
                load -= heat_of(matrices, rows, lift[mesh.cells[ids]], count)
            parts.append(matrix_of(matrices, rows, count))
    return summed(parts, count), list(loads)


def matrix_of(matrices, rows, count) -> csr_matrix:
    """The (count, count) matrix that those of elements, (b, n, n), add up to, by the rows of their nodes, (b, n)."""
    i, j = (np.broadcast_to(index, matrices.shape).ravel() for index in (rows[:, :, None], rows[:, None, :]))
    return coo_matrix((matrices.ravel(), (i, j)), shape=(count, count)).tocsr()


def heat_of(matrices, rows, values, count):
    """Matrices of elements times values at their nodes, (b, n), summed over rows, (count,) float array."""
    return np.bincount(rows.ravel(), np.einsum("bij,bj->bi", matrices, values).ravel(), count)


def summed(parts, count) -> csr_matrix:
    """Sum of matrices, in pairs of equal size: each entry is copied log2(parts) times only."""
    while len(parts) > 1:
        parts = [parts[i] + parts[i + 1] if i + 1 < len(parts) else parts[i] for i in range(0, len(parts), 2)]
    return parts[0] if parts else csr_matrix((count, count))


def _matrices(mesh, ids, rule, conductivity, medium):
    """Stiffness matrices of one block of elements."""
    slopes, weights = gradients(mesh, ids, rule)
    if medium is not None:
        slopes = medium.bent(ids, rule[0], slopes)
    slopes *= np.sqrt(weights * conductivity[:, None])[..., None, None]
    slopes = np.swapaxes(slopes, 1, 2).reshape(len(ids), mesh.cells.shape[1], -1)
    return slopes @ np.swapaxes(slopes, 1, 2)


def wall_weights(mesh, triangles):
    """Integral of each node's shape function over triangles."""
    values, areas = at_points(mesh, triangles, 5)
    return np.bincount(triangles.ravel(), (areas @ values).ravel(), len(mesh.points))


def at_points(mesh, triangles, degree):
    """Shape functions at the points of a rule on triangles, (q, n), and their shares of the area, (t, q), m2."""
    X, weights = get_quadrature(RefTri, degree)
    values, slopes = shapes(triangles.shape[1], X)
    tangents = np.einsum("tnx,qnk->tqkx", mesh.points[triangles], slopes, optimize=True)
    return values, np.linalg.norm(np.cross(tangents[..., 0, :], tangents[..., 1, :]), axis=-1) * weights


def at_quadrature(mesh, temperature, degree=5, straight=None):
    """Solution at the quadrature points of one block after the other."""
    for ids, (X, weights) in blocks(mesh, degree, straight):
        slopes, weights = gradients(mesh, ids, (X, weights))
        values, _ = shapes(mesh.cells.shape[1], X)
        nodal = temperature[mesh.cells[ids]]
        points = np.einsum("qn,bnx->bqx", values, mesh.points[mesh.cells[ids]], optimize=True)
        yield ids, points, weights, nodal @ values.T, np.einsum("bqnx,bn->bqx", slopes, nodal, optimize=True)
