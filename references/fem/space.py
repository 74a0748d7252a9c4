"""What a transient needs of a mesh, whatever its elements; here of tetrahedra."""

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTet

from references.fem import interfaces
from references.fem.elements import BLOCK, assemble, gradients, matrix_of, shapes, wall_weights
from references.fem.lookup import LOST, NodalField
from references.fem.multigrid import prolongation
from references.fem.robin import on_triangles

# A quadratic boundary leaves a point of the true surface this far, in local coordinates, outside: an edge as long as
# the radius has a sagitta of 1/8, and the quadratic arc misses the circle by under a tenth of that.
LOST_ON_ROUND = 0.05
LOST_ON_CHORDS = 0.3
# Points of a moving source per edge.
RESOLVE = 3


class WallNodes(NamedTuple):
    """A wall on the nodes."""

    nodes: np.ndarray  # (k,) int array: Those on it
    weights: np.ndarray  # (n,) float array, m2: Integrals of all shape functions over it
    surface: Callable  # callable () -> Surface: Its elements and their quadrature


class Space(NamedTuple):
    """Equations C dT/dt + K T = heat of the n nodes of a mesh."""

    points: np.ndarray  # (n, 3) float array, m
    mass: csr_matrix  # (n, n) CSR matrix, J/K: Consistent
    stiffness: csr_matrix  # (n, n) CSR matrix, W/K
    volumes: np.ndarray  # (n,) float array, m3: Integrals of the shape functions
    walls: dict[str, WallNodes]  # mapping of str to WallNodes
    # callable (free nodes) -> CSR matrix or None: From the corners to all free nodes of quadratic elements
    quadratic: Callable
    # callable (free nodes) -> callable (tau, load) -> solution, or None: Exact inverse of mass / tau + stiffness, where
    # there is a fast one
    separable: Callable | None
    # callable (points, amounts) -> (n,) float array: Amounts at points shared among the nodes by their shape functions
    spread: Callable
    # callable (axis) -> (p,) float array, m: Coordinates along an axis; one point between each two resolves the shape
    # functions
    planes: Callable
    spacing: float  # m: Distance between points in a plane that resolves them
    view: Callable  # callable (temperature) -> object: With `temperature_at`, `flux_at`, `samples` and `mean_flux`
    fractions: np.ndarray  # (1 + number of inclusions,) float array
    stats: dict[str, object]  # dict


def tetrahedra(scene, mesh) -> Space:
    """`Space` of tetrahedra."""
    count, dof = len(mesh.points), np.arange(len(mesh.points))
    stiffness, _ = assemble(mesh, scene.conductivities[mesh.phase], dof, np.zeros(count))
    if mesh.faces is not None:
        stiffness = (stiffness + interfaces.exchange(mesh, dof)).tocsr()
    mass, volumes = _mass(mesh, capacities(scene)[mesh.phase])
    # Quadratic elements that were straightened are chords, too.
    arcs = mesh.cells.shape[1] == 10 and not mesh.stats["straightened"]
    lost = LOST if scene.domain == "box" else LOST_ON_ROUND if arcs else LOST_ON_CHORDS
    # Distance of nodes that are neighbours.
    edge = mesh.stats["size"] / (2 if mesh.cells.shape[1] == 10 else 1)
    view = partial(NodalField, scene, mesh, lost=lost)
    walls = {
        name: WallNodes(np.unique(t), wall_weights(mesh, t), partial(on_triangles, mesh, t))
        for name, (t, _) in mesh.walls.items()
    }
    return Space(
        points=mesh.points,
        mass=mass,
        stiffness=stiffness,
        volumes=volumes,
        walls=walls,
        quadratic=lambda free: prolongation(mesh, free, dof),
        separable=None,
        spread=view(np.zeros(count)).spread,
        planes=partial(_planes, scene, edge / 2),
        spacing=edge / RESOLVE,
        view=view,
        fractions=np.bincount(mesh.phase, mesh.volumes, len(scene.materials)) / mesh.volumes.sum(),
        stats={"elements": len(mesh.cells), "nodes": count} | mesh.stats,
    )


def _planes(scene, spacing, axis):
    return np.linspace(0, scene.size[axis], 1 + math.ceil(scene.size[axis] / spacing))


def capacities(scene):
    """Heat capacity of each phase per volume, (1 + number of inclusions,) float array, J/(m3 K)."""
    return np.array([material.density * material.heat_capacity for material in scene.materials])


def _mass(mesh, capacity):
    """Consistent mass matrix, J/K, and the integrals of the shape functions, m3."""
    nodes, count = mesh.cells.shape[1], len(mesh.points)
    total, volumes = csr_matrix((count, count)), np.zeros(count)
    # Degree of a product of two shape functions; the Jacobian of a curved element adds a cubic.
    straight = 2 if nodes == 4 else 4
    for curved, degree in ((False, straight), (True, straight + 3)):
        chosen, (X, weights) = np.flatnonzero(mesh.curved == curved), get_quadrature(RefTet, degree)
        values, _ = shapes(nodes, X)
        products = (values[:, :, None] * values[:, None, :]).reshape(len(weights), -1)
        for start in range(0, len(chosen), BLOCK):
            ids = chosen[start : start + BLOCK]
            parts = gradients(mesh, ids, (X, weights))[1] if curved else 6 * mesh.volumes[ids, None] * weights
            cells, blocks = mesh.cells[ids], (capacity[ids, None] * parts) @ products
            total = total + matrix_of(blocks.reshape(len(ids), nodes, nodes), cells, count)
            volumes += np.bincount(cells.ravel(), (parts @ values).ravel(), count)
    return total, volumes
