"""Spheres of a table that overlap, as unions: one body for each group that hangs together."""

from dataclasses import replace

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import breadth_first_order, connected_components
from scipy.spatial import cKDTree

from demheat.scene import Union


def joined(placed, size, *, periodic: bool) -> list:
    """Spheres, each with its place, where those that overlap are one union at the place of its first."""
    spheres = [sphere for sphere, _ in placed]
    centers, radii = np.array([each.center for each in spheres]), np.array([each.radius for each in spheres])
    sides = np.array(size)
    first, second, turns = _pairs(centers, radii, sides if periodic else None)
    count = len(spheres)
    graph = coo_matrix((np.ones(len(first)), (first, second)), (count, count)).tocsr()
    _, label = connected_components(graph, directed=False)
    shift = _shifts(graph, label, dict(zip(zip(first.tolist(), second.tolist(), strict=True), turns, strict=True)))
    found = []
    for group in np.unique(label):
        numbers = np.flatnonzero(label == group)
        members = [
            replace(spheres[n], center=tuple(centers[n] + shift[n] * sides), resistance=0.0) for n in numbers.tolist()
        ]
        sphere, place = placed[numbers[0]]
        if len({each.material for each in members}) > 1:
            raise ValueError(f"{place}: overlaps a sphere of another material; what is joined must be of one")
        one = sphere if len(members) == 1 else Union(members, sphere.material, resistance=sphere.resistance)
        found.append((one, place))
    return found


def _pairs(centers, radii, sides):
    """Pairs that overlap, and by how many periods the second is to be moved to lie beside the first."""
    tree = cKDTree(centers if sides is None else centers % sides, boxsize=sides)
    reach = 2 * radii.max()
    pairs = tree.query_pairs(reach if sides is None else min(reach, 0.499 * sides.min()), output_type="ndarray")
    first, second = pairs.T
    apart = centers[second] - centers[first]
    turns = np.zeros_like(apart) if sides is None else -np.round(apart / sides)
    near = np.linalg.norm(apart + turns * (0 if sides is None else sides), axis=1) < radii[first] + radii[second]
    return first[near], second[near], turns[near]


def _shifts(graph, label, turns):
    """Periods by which each sphere is moved to lie beside those that it overlaps, from the first of its group on."""
    shift = np.zeros((len(label), 3))
    for root in np.unique(label, return_index=True)[1]:
        order, before = breadth_first_order(graph, root, directed=False)
        for n in order[1:].tolist():
            m = int(before[n])
            shift[n] = shift[m] + (turns[m, n] if (m, n) in turns else -turns[n, m])
    return shift
