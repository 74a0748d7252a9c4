"""What temperatures or fluxes on a mesh prove: energies, with what rounding and quadrature may hide."""

import numpy as np

from references.bracket.fluxes import blocks, masses
from references.fem.elements import gradients
from references.fem.quadrature import rule
from references.mesh import Mesh

# Energies on curved elements are integrals of rational functions. They are worked out by these two rules, and what the
# rules differ by, element by element, is counted against the bound: found, twenty times what the finer one is off.
# On straight elements both are exact.
DEGREES = (5, 6)


def temperature_energies(mesh: Mesh, conductivity, temperatures) -> np.ndarray:
    """Upper bound, as a quadratic form of the loads, of the integrals of k grad T_i . grad T_j."""
    temperatures = np.asarray(temperatures)

    def energies(ids, degree):
        slopes, weights = gradients(mesh, ids, rule(degree))
        gradient = np.einsum("bqnx,lbn->blqx", slopes, temperatures[:, mesh.cells[ids]], optimize=True)
        weights = np.broadcast_to(conductivity[ids, None] * weights, slopes.shape[:2])
        return np.einsum("bq,blqx,bmqx->blm", weights, gradient, gradient, optimize=True)

    return _bounded(mesh, conductivity > 0, energies)


def flux_energies(mesh: Mesh, conductivity, moments) -> np.ndarray:
    """Upper bound, as a quadratic form of the loads, of the integrals of q_i . q_j / k."""
    moments = np.asarray(moments)

    def energies(ids, degree):
        matrices = masses(mesh, ids, degree=degree) / conductivity[ids, None, None]
        return np.einsum("lbi,bij,mbj->blm", moments[:, ids], matrices, moments[:, ids], optimize=True)

    return _bounded(mesh, conductivity > 0, energies)


def _bounded(mesh, conducting, energies):
    total = off = 0.0
    for ids in blocks(mesh, conducting):
        if not mesh.curved[ids[0]]:
            total = total + energies(ids, 2).sum(axis=0)
            continue
        rough, fine = (energies(ids, degree) for degree in DEGREES)
        total = total + fine.sum(axis=0)
        off += np.linalg.norm(fine - rough, axis=(1, 2)).sum()
    return total + off * np.eye(len(np.atleast_2d(total)))
