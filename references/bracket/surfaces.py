"""Interfaces of a mesh pushed to one side of the true ones, so that each material is nowhere where a bound forbids it.

Of two materials at a sphere, an upper bound may give the better conductor more room, never less, a lower bound the
other way. So a patch of the mesh's surface has to stay outside of the sphere, or inside. The distance of a quadratic
patch from the sphere's centre, squared, is a polynomial of degree four, which lies between the least and the greatest
of its Bernstein coefficients: patches are pushed along the sphere's radius until these say so. The balls then lie
inside the mesh's surfaces, or these inside the balls, for the elements fill the box without overlap.
"""

from itertools import combinations_with_replacement
from math import factorial, prod
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from demheat.scene import Scene
from references.bracket.faces import interfaces
from references.mesh import EDGE_COLUMN, Mesh, twins
from references.mesh.cells import bent, jacobian_coefficients, volumes_of

# Exponents of the quadratic Bernstein polynomials of a patch, in the order of its nodes.
QUADRATIC = ((2, 0, 0), (0, 2, 0), (0, 0, 2), (1, 1, 0), (0, 1, 1), (1, 0, 1))
# Of the radius. Nodes are on their sphere within this: rounding of gmsh's own lengths.
ON = 1e-6
# Of the radius: rounding of a distance, ten times over.
ROUNDING = 1e-14
# A push is so much longer than what is missing: the patch turns meanwhile.
FURTHER = 1.3
ROUNDS = 50
# Times that edges of elements which the push would invert are made straight.
TRIES = 10


class Patches(NamedTuple):
    """Curved patches of the interfaces."""

    nodes: np.ndarray  # (t, 6) int array
    center: np.ndarray  # (t, 3) float array, m: Of the sphere that each lies on
    radius: np.ndarray  # (t,) float array, m
    # inner, outer: (t,) int array: Phases
    inner: np.ndarray
    outer: np.ndarray


def patches(scene: Scene, mesh: Mesh) -> Patches:
    """The curved patches of a mesh, each with its sphere."""
    found = interfaces(mesh)
    round_ = np.array([False, *(shape.bounded for shape in scene.inclusions)])
    center, radius = np.full((len(found.nodes), 3), np.nan), np.full(len(found.nodes), np.nan)
    middle = mesh.points[found.nodes[:, :3]].mean(axis=1)
    images = scene.images()
    for phase in np.unique(found.inner[round_[found.inner]]):
        mine = np.flatnonzero(found.inner == phase)
        centers = np.array([image.center for number, image in images if number == phase])
        center[mine] = centers[cKDTree(centers).query(middle[mine])[1]]
        radius[mine] = scene.inclusions[phase - 1].radius
    kept = round_[found.inner]
    made = Patches(found.nodes[kept], center[kept], radius[kept], found.inner[kept], found.outer[kept])
    corners = np.linalg.norm(mesh.points[made.nodes[:, :3]] - made.center[:, None], axis=2)
    if np.any(np.abs(corners / made.radius[:, None] - 1) > ON):
        raise RuntimeError("a face of the mesh between two materials is on no surface of the scene")
    return made


def _products():
    """Pairs of quadratic Bernstein polynomials, as (row, one, other, factor) of the quartic ones they give."""
    rows, table = {}, []
    for i, j in combinations_with_replacement(range(6), 2):
        total = tuple(a + b for a, b in zip(QUADRATIC[i], QUADRATIC[j], strict=True))
        ways = [2 / prod(map(factorial, each)) for each in (QUADRATIC[i], QUADRATIC[j])]
        factor = ways[0] * ways[1] / (24 / prod(map(factorial, total))) * (1 if i == j else 2)
        table.append((rows.setdefault(total, len(rows)), i, j, factor))
    return len(rows), table


def distances(nodes, center):
    """Bounds of the distance of quadratic patches from a point."""
    control = nodes - center[:, None]
    for column, (a, b) in zip((3, 4, 5), ((0, 1), (1, 2), (0, 2)), strict=True):
        control[:, column] = 2 * control[:, column] - (control[:, a] + control[:, b]) / 2
    count, table = _products()
    squared = np.zeros((len(nodes), count))
    for row, i, j, factor in table:
        squared[:, row] += factor * np.einsum("tx,tx->t", control[:, i], control[:, j])
    return np.sqrt(np.maximum(squared.min(axis=1), 0)), np.sqrt(squared.max(axis=1))


def pushed(scene: Scene, mesh: Mesh, *, upper: bool) -> Mesh:
    """The mesh with its curved interfaces on that side of the true ones which an upper or a lower bound needs."""
    found, twin = patches(scene, mesh), twins(len(mesh.points), mesh.pairs)
    better = np.sign(scene.conductivities[found.inner] - scene.conductivities[found.outer])
    # 1: the patch stays outside of its sphere; -1: inside; 0: anywhere.
    side = better if upper else -better
    directions, bends = _directions(scene, mesh, found), np.zeros(len(mesh.points), bool)
    bends[found.nodes] = True
    for _ in range(TRIES):
        points = _push(mesh.points.copy(), mesh, found, side, directions[twin], bends)
        bad = jacobian_coefficients(points[mesh.cells] / max(scene.size)).min(axis=1) <= 0
        if not bad.any():
            nodes = points[mesh.cells]
            return mesh._replace(points=points, volumes=volumes_of(nodes), curved=bent(nodes / max(scene.size)))
        # Their edges become straight, and their neighbours' with them; patches there are pushed farther.
        straight = np.zeros(len(points), bool)
        straight[twin[mesh.cells[bad, 4:]]] = True
        bends &= ~straight[twin]
    raise RuntimeError("elements are too coarse to be pushed off the interfaces: take a smaller size")


def _push(points, mesh, found, side, directions, bends):
    """Move the nodes, in place, until each patch is on its side."""
    twin, free = twins(len(points), mesh.pairs), _middles(mesh, bends)
    for _ in range(ROUNDS):
        _straighten(points, free)
        least, greatest = distances(points[found.nodes], found.center)
        missing = np.where(side > 0, found.radius - least, np.where(side < 0, greatest - found.radius, -np.inf))
        late = missing > -ROUNDING * found.radius
        if not late.any():
            return points
        push = np.zeros(len(points))
        wanted = FURTHER * missing + 2 * ROUNDING * found.radius
        np.maximum.at(push, twin[found.nodes[late]], wanted[late, None])
        # Patches of one sphere between the same two materials go one way.
        push[twin[found.nodes[late]]] *= side[late, None]
        points += push[twin][:, None] * directions
    raise RuntimeError(f"after {ROUNDS} rounds {late.sum()} faces of the mesh are still on the wrong side of a sphere")


def _directions(scene, mesh, found):
    """Displacement (n, 3) of each node on a sphere that takes it one metre off the centre; within faces of the box."""
    directions, box = np.zeros_like(mesh.points), np.array(scene.size)
    nodes, which = np.unique(found.nodes, return_index=True)
    outward = mesh.points[nodes] - found.center[which // 6]
    outward /= np.linalg.norm(outward, axis=1)[:, None]
    outward[(mesh.points[nodes] == 0) | (mesh.points[nodes] == box)] = 0.0
    directions[nodes] = outward / np.einsum("nx,nx->n", outward, outward)[:, None]
    return directions


def _middles(mesh, bends):
    """Middle nodes (p,) of edges that stay straight, and both their ends (p, 2)."""
    columns = [(c, a, b) for (a, b), c in EDGE_COLUMN.items()]
    rows = np.concatenate([mesh.cells[:, each] for each in columns])
    rows = rows[~bends[rows[:, 0]]]
    _, first = np.unique(rows[:, 0], return_index=True)
    return rows[first, 0], rows[first, 1:]


def _straighten(points, middles):
    """Put middle nodes between their ends, in place."""
    middle, ends = middles
    points[middle] = points[ends].mean(axis=1)
