"""What a temperature or a flux on a mesh proves: energies, with what rounding and quadrature may hide."""

from __future__ import annotations

import numpy as np

from references.bracket.fluxes import blocks, masses
from references.fem.elements import gradients
from references.fem.quadrature import rule
from references.mesh import Mesh

# Energies on curved elements are integrals of rational functions. They are worked out by these two rules, and what the
# rules differ by, element by element, is counted against the bound: found, a hundred times what the finer one is off.
# On straight elements both are exact.
DEGREES = (5, 6)


def temperature_energy(mesh: Mesh, conductivity, temperature) -> float:
    """Upper bound of the integral of k |grad T|^2, W K.

    Parameters
    ----------
    mesh : Mesh
    conductivity : (m,) float array, W/(m K)
    temperature : (n,) float array, K
        At the nodes.
    """
    return _bounded(
        mesh, conductivity > 0, lambda ids, degree: _of_temperature(mesh, conductivity, temperature, ids, degree)
    )


def flux_energy(mesh: Mesh, conductivity, moments) -> float:
    """Upper bound of the integral of |q|^2/k, W K.

    Parameters
    ----------
    mesh : Mesh
    conductivity : (m,) float array, W/(m K)
    moments : (m, 12) float array, W
        Of the normal flux out of each element; 0 where there is no conductivity.
    """
    return _bounded(mesh, conductivity > 0, lambda ids, degree: _of_flux(mesh, conductivity, moments, ids, degree))


def _bounded(mesh, conducting, energy):
    total = off = 0.0
    for ids in blocks(mesh, conducting):
        if not mesh.curved[ids[0]]:
            total += energy(ids, 2).sum()
            continue
        rough, fine = (energy(ids, degree) for degree in DEGREES)
        total += fine.sum()
        off += np.abs(fine - rough).sum()
    return float(total + off)


def _of_temperature(mesh, conductivity, temperature, ids, degree):
    slopes, weights = gradients(mesh, ids, rule(degree))
    gradient = np.einsum("bqnx,bn->bqx", slopes, temperature[mesh.cells[ids]], optimize=True)
    return conductivity[ids] * np.einsum(
        "bqx,bqx,bq->b", gradient, gradient, np.broadcast_to(weights, gradient.shape[:2]), optimize=True
    )


def _of_flux(mesh, conductivity, moments, ids, degree):
    matrices = masses(mesh, ids, degree=degree)
    return np.einsum("bi,bij,bj->b", moments[ids], matrices, moments[ids], optimize=True) / conductivity[ids]
