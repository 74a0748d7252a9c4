"""A balanced flux on a mesh: temperatures on faces solved for, moments read off, and what they leave unbalanced."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix, diags
from scipy.sparse.csgraph import connected_components

from demheat.runtime.progress import stage
from demheat.scene import Scene
from references.bracket.faces import CORNERS, number_faces
from references.bracket.fluxes import answers, assemble, blocks, masses
from references.fem.multigrid import conjugate_gradients, multigrid
from references.mesh import Mesh

# Quadrature on curved elements: an error there costs sharpness, never certainty.
DEGREE = 5


class Balanced(NamedTuple):
    """A flux, linear in each element."""

    moments: np.ndarray  # (m, 12) float array, W: Of the normal flux out of each element, at the corners of its faces
    work: float  # W K: The flux's along the known part of the temperature
    # W: Sum of the magnitudes of moments by which neighbours differ, or that leave through an insulated face
    left: float
    stats: dict[str, object]  # dict: `unknowns`, `iterations`, `residual`


def balanced_flux(scene: Scene, mesh: Mesh, *, tolerance: float) -> Balanced:
    """The flux of least energy that is balanced on a mesh."""
    conductivity = scene.conductivities[mesh.phase]
    conductivity = conductivity / conductivity.max()
    faces = number_faces(mesh)
    lift, held = _known(scene, mesh, faces)
    matrix, load = assemble(mesh, conductivity, faces, lift, degree=DEGREE)
    correction, stats = _solved(matrix, load, held, faces, tolerance)
    moments = _moments(mesh, conductivity, lift + correction[faces.row])
    jumps = np.bincount(faces.row.ravel(), moments.ravel(), len(held))
    unit = scene.conductivities.max()
    return Balanced(unit * moments, -unit * float(np.sum(moments * lift)), unit * np.abs(jumps[~held]).sum(), stats)


def linear_temperature(mesh: Mesh, gradient) -> np.ndarray:
    """Temperature of a uniform gradient at the corners of each element's faces, (m, 12) float array, K."""
    return (mesh.points @ np.array(gradient))[mesh.cells[:, CORNERS]].reshape(-1, 12)


def _known(scene, mesh, faces):
    """Known temperature (m, 12) at the corners of faces, counted from the lowest wall's; which unknowns it fixes."""
    held = np.zeros(len(faces.node), bool)
    if scene.periodic:
        return linear_temperature(mesh, scene.gradient), held
    lift, low = np.zeros((len(mesh.cells), 12)), min(scene.wall_temperatures.values())
    for name, value in scene.wall_temperatures.items():
        wall, on = mesh.walls[name], np.zeros(len(mesh.points), bool)
        on[wall.triangles[:, :3]] = True
        element, face = np.nonzero(on[mesh.cells[wall.owners][:, CORNERS]].all(axis=2))
        element, columns = wall.owners[element], 3 * face[:, None] + np.arange(3)
        held[faces.row[element[:, None], columns]] = True
        lift[element[:, None], columns] = value - low
    return lift, held


def _solved(matrix, load, held, faces, tolerance):
    """Correction of the temperature on faces, and statistics."""
    diagonal, correction = matrix.diagonal(), np.zeros(len(load))
    fixed = held.copy()
    fixed[_pins(matrix, diagonal > 0, held)] = True
    free = np.flatnonzero(~fixed & (diagonal > 0))
    stats = {"unknowns": len(free), "iterations": 0, "residual": 0.0}
    if not load[free].any():
        return correction, stats
    scale = 1 / np.sqrt(diagonal[free])
    scaled = (diags(scale) @ matrix[free][:, free] @ diags(scale)).tocsr()
    precondition = multigrid(scaled, 1 / scale, _from_corners(faces.node, free, held))
    with stage("fluxes") as done:
        x, stats["iterations"], stats["residual"] = conjugate_gradients(
            scaled, scale * load[free], precondition, tolerance, done
        )
    if not stats["residual"] <= tolerance:
        raise RuntimeError(
            f"bracket: residual {stats['residual']:.2e} of the fluxes > tolerance {tolerance:.2e} after "
            f"{stats['iterations']} iterations on {len(free)} unknowns"
        )
    correction[free] = scale * x
    return correction, stats


def _pins(matrix, present, held):
    """One unknown of each connected body whose temperature nothing fixes."""
    _, body = connected_components(matrix, directed=False)
    bodies, first = np.unique(body[present], return_index=True)
    return np.flatnonzero(present)[first[~np.isin(bodies, body[held & present])]]


def _from_corners(node, free, held):
    """From temperatures at the mesh's corners to those on faces: each takes that of its node."""
    fixed = np.zeros(node.max() + 1, bool)
    fixed[node[held]] = True
    corners, column = np.unique(node[free], return_inverse=True)
    kept = ~fixed[node[free]]
    matrix = csr_matrix((np.ones(kept.sum()), (np.flatnonzero(kept), column[kept])), shape=(len(free), len(corners)))
    return matrix[:, ~fixed[corners]]


def _moments(mesh, conductivity, temperature):
    moments = np.zeros(temperature.shape)
    for ids in blocks(mesh, conductivity > 0):
        matrices = answers(masses(mesh, ids, degree=DEGREE) / conductivity[ids, None, None])
        moments[ids] = -np.einsum("bij,bj->bi", matrices, temperature[ids])
    return moments
