"""Fluxes that are balanced in every element and continuous across every face: linear elements of H(div), hybrid.

Each element's flux is linear in local coordinates and has 12 moments, those of the normal flux with the three linear
functions of each face; Piola's mapping keeps them on curved elements, where the flux stays free of sources too. The
unknowns are temperatures on the faces, the multipliers of the flux's continuity: an element answers them with the
balanced flux of least energy (Brezzi, Douglas and Marini 1985; hybrid as by Arnold and Brezzi 1985).
"""

from functools import cache

import numpy as np
from scipy.sparse import csr_matrix

from demheat.runtime.progress import stage
from references.bracket.faces import CORNERS
from references.fem.elements import heat_of, matrix_of, shapes, summed
from references.fem.quadrature import rule
from references.mesh import Mesh

# Corners of the reference element.
REFERENCE = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
# Elements per block: 20 MB of matrices.
BLOCK = 20_000


@cache
def _basis():
    """Coefficients (12, 3, 4) of the fields whose moments are one each: of component x in barycentric function l."""
    moments = np.zeros((12, 3, 4))
    for face, corners in enumerate(CORNERS):
        a, b, c = REFERENCE[corners]
        area = np.cross(b - a, c - a) / 2
        area *= np.sign(area @ (a - REFERENCE[face]))
        for place, corner in enumerate(corners):
            for other in corners:
                moments[3 * face + place, :, other] = area * (2 if other == corner else 1) / 12
    return np.linalg.inv(moments.reshape(12, 12)).T.reshape(12, 3, 4)


def fields(X):
    """The 12 basis fields of the reference element at local points."""
    barycentric = np.vstack([1 - X.sum(axis=0), X])
    return np.einsum("ixl,lq->qix", _basis(), barycentric)


def mappings(mesh: Mesh, ids, X):
    """Jacobians of elements at local points, and their determinants."""
    curved = mesh.curved[ids[0]]
    _, slopes = shapes(10 if curved else 4, X)
    nodes = mesh.points[mesh.cells[ids][:, : slopes.shape[1]]]
    jacobian = np.einsum("bnx,qnk->bqxk", nodes, slopes, optimize=True)
    return jacobian, np.linalg.det(jacobian)


def masses(mesh: Mesh, ids, *, degree: int):
    """Matrices (b, 12, 12) of the integral of flux times flux by elements, all curved or all straight, 1/m."""
    curved = mesh.curved[ids[0]]
    X, weights = rule(degree if curved else 2)
    basis = fields(X)
    if curved:
        jacobian, det = mappings(mesh, ids, X)
        flux = np.einsum("bqxk,qik->bqxi", jacobian, basis, optimize=True) * np.sqrt(weights / det)[..., None, None]
        flux = flux.reshape(len(ids), -1, 12)
        return np.swapaxes(flux, 1, 2) @ flux
    jacobian, det = mappings(mesh, ids, X[:, :1])
    metric = np.swapaxes(jacobian[:, 0], 1, 2) @ jacobian[:, 0] / det[:, :, None]
    products = np.einsum("q,qia,qjb->abij", weights, basis, basis).reshape(9, 144)
    return (metric.reshape(-1, 9) @ products).reshape(-1, 12, 12)


def blocks(mesh: Mesh, conducting, size: int = BLOCK):
    """Conducting elements in blocks, straight ones first."""
    for curved in (False, True):
        ids = np.flatnonzero(conducting & (mesh.curved == curved))
        yield from (ids[start : start + size] for start in range(0, len(ids), size))


def answers(matrices):
    """Matrices that turn temperatures on faces into minus the moments of the balanced flux of least energy."""
    inverse = np.linalg.inv(matrices)
    flows = inverse.sum(axis=2)
    inverse -= flows[:, :, None] * flows[:, None, :] / flows.sum(axis=1)[:, None, None]
    return (inverse + np.swapaxes(inverse, 1, 2)) / 2


def assemble(mesh: Mesh, conductivity, faces, lift, *, degree: int) -> tuple[csr_matrix, np.ndarray]:
    """Equations of the temperatures on faces."""
    count, parts, load, seen = len(faces.node), [], np.zeros(len(faces.node)), 0
    with stage("assembly of fluxes") as done:
        for ids in blocks(mesh, conductivity > 0):
            seen += len(ids)
            matrices = answers(masses(mesh, ids, degree=degree) / conductivity[ids, None, None])
            load -= heat_of(matrices, faces.row[ids], lift[ids], count)
            parts.append(matrix_of(matrices, faces.row[ids], count))
            done(seen / len(mesh.cells))
    return summed(parts, count), load
