"""Tetrahedra that conform to shapes without a geometry of OpenCASCADE: a body-centred lattice, cut along surfaces.

The lattice fills the box and repeats with it, so periodic faces match by themselves. Shapes are asked what they hold,
nothing else: level sets, unions in pieces and meshes are all the same here. Second-order nodes are put onto surfaces.
"""

import time
from functools import partial

import numpy as np

from demheat.runtime.progress import stage
from demheat.scene.volumes import sampled_fractions
from references.mesh.cells import EDGE_COLUMN, check, finished, triangles_on, volumes_of
from references.mesh.cut import EDGES, Cells, crossing, cut, faces_of

# Sides of the lattice's cubes over the size asked for: 12 tetrahedra each, as many as gmsh makes of that size.
CUBE = (12 / 4.5) ** (1 / 3)
# Cubes along an edge of the box, at least: with fewer an edge may join a node to its own twin's neighbour twice.
FEWEST = 4
# Of an edge, how far off its middle the surface is sought, near first.
SOUGHT = (0.02, 0.08, 0.25)
# What a phase may lack of its volume, as chords of coarse elements do; and of the box, as volumes by points do.
LOST, OFF, POINTS = 0.25, 5e-3, 1 << 15


def make_lattice(scene, *, size, order, curved):
    """Mesh a box whose shapes are known by what they hold."""
    begin = time.perf_counter()
    with stage("mesh") as done:
        mesh = _made(scene, size, order == 2, curved, done)
    stats = {"size": size, "attempts": 1, "mesh_s": time.perf_counter() - begin}
    return mesh._replace(stats=stats | mesh.stats)


def _made(scene, size, quadratic, curved, done):
    scale = max(scene.size)
    box = np.array(scene.size) / scale
    counts = cubes(box, size / scale)
    body = lattice(box, counts, periodic=scene.periodic)
    holds = [partial(_holds, shape, scale, scene.period) for shape in scene.inclusions]
    for number, inside in enumerate(holds, start=1):
        body = cut(body, inside, number)
        done(number / (len(holds) + 1))
    used, corners = np.unique(body.cells, return_inverse=True)
    points, cells = body.points[used], corners.reshape(-1, 4).astype(np.int32)
    if quadratic:
        points, cells = _with_middles(body, points, cells, holds if curved else [])
    mesh = finished(scene, points, cells, body.phase.astype(np.int32), quadratic)
    _check_volumes(scene, mesh, size)
    check(scene, mesh)
    return mesh._replace(stats=mesh.stats | {"cubes": int(counts.min())})


def _holds(shape, scale, period, points):
    return shape.contains(points * scale, period=period)


def cubes(box, size):
    """How many of about a size there are along each edge, (3,) int array."""
    return np.maximum(FEWEST, np.ceil(box / (CUBE * size) * (1 - 1e-9)).astype(int))


def lattice(box, counts, *, periodic) -> Cells:
    """Tetrahedra of so many cubes along each edge: each face between two cubes and both middles make four."""
    ticks = [length * np.arange(n + 1) / n for length, n in zip(box, counts, strict=True)]
    middles = [0.5 * (t[1:] + t[:-1]) for t in ticks]
    corner = np.arange(np.prod(counts + 1)).reshape(counts + 1)
    middle = corner.size + np.arange(np.prod(counts)).reshape(counts)
    points, cells, number = [_grid(*ticks), _grid(*middles)], [], corner.size + middle.size
    for axis in range(3):
        own, here = (np.moveaxis(each, axis, 0) for each in (corner, middle))
        ends = []
        for at in (0, -1):
            ends.append(number + np.arange(here[0].size).reshape(here[0].shape))
            points.append(_grid(*(ticks[a][[at]] if a == axis else middles[a] for a in range(3))))
            number += here[0].size
        beside = np.concatenate([ends[0][None], here, ends[1][None]])
        around = [own[:, :-1, :-1], own[:, 1:, :-1], own[:, 1:, 1:], own[:, :-1, 1:]]
        for one, other in zip(around, around[1:] + around[:1], strict=True):
            cells.append(np.stack([one, other, beside[:-1], beside[1:]], axis=-1).reshape(-1, 4))
    points, cells = np.concatenate(points), np.concatenate(cells)
    turned = volumes_of(points[cells]) < 0
    cells[turned] = cells[turned][:, [1, 0, 2, 3]]
    twin = np.arange(len(points))
    if periodic:
        # On a face "+" coordinates are those on the face "-" but for one.
        home = np.where(points == box, 0.0, points)
        _, first, which = np.unique(home, axis=0, return_index=True, return_inverse=True)
        twin = first[which.ravel()]
    return Cells(points, cells, np.zeros(len(cells), int), twin, np.zeros(len(points), bool), box)


def _grid(*ticks):
    return np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1).reshape(-1, 3)


def _with_middles(body, points, cells, holds):
    """Points and cells with nodes at the middles of edges, put onto the surfaces of what holds points."""
    count = len(body.points)
    keys, which = np.unique(np.sort(body.cells[:, EDGES], axis=2) @ [count, 1], return_inverse=True)
    edges = np.column_stack([keys // count, keys % count])
    middles = body.points[edges].mean(axis=1)
    if holds:
        middles += _bends(body, holds, edges, middles)
    found = np.empty((len(cells), 10), np.int32)
    found[:, :4], found[:, list(EDGE_COLUMN.values())] = cells, len(points) + which.reshape(-1, 6)
    return np.concatenate([points, middles]), found


def _bends(body, holds, edges, middles):
    """How far the middles of edges are from the surfaces that these lie on, (n, 3) float array."""
    bends, count = np.zeros_like(middles), len(body.points)
    triangles, number, across = _on_surfaces(body)
    if not len(triangles):
        return bends
    sides = triangles[:, [(0, 1), (1, 2), (0, 2)]].reshape(-1, 2)
    # Normals summed over the triangles at an edge and at its twins; edges between two phases are of the last one.
    kind, which = np.unique(np.sort(body.twin[sides], axis=1) @ [count, 1], return_inverse=True)
    normal, owner = np.zeros((len(kind), 3)), np.zeros(len(kind), int)
    np.add.at(normal, which, np.repeat(across, 3, axis=0))
    np.maximum.at(owner, which, np.repeat(number, 3))
    wanted = np.sort(body.twin[edges], axis=1) @ [count, 1]
    place = np.minimum(np.searchsorted(kind, wanted), len(kind) - 1)
    # Edges of one kind that are no twins have other ends only by chance of a coarse lattice: see `FEWEST`.
    found = np.flatnonzero(kind[place] == wanted)
    place, first = place[found], np.unique(place[found], return_index=True)[1]
    faces = faces_of(body.points, body.box)
    on = np.any((faces[edges[:, 0]] & faces[edges[:, 1]])[found].reshape(-1, 2, 3), axis=1)
    way = np.where(on[first], 0.0, normal)
    length = np.linalg.norm(np.diff(body.points[edges[found[first]]], axis=1)[:, 0], axis=1)
    size = np.linalg.norm(way, axis=1)
    way *= np.divide(length, size, out=np.zeros_like(size), where=size > 0)[:, None]
    shift = np.zeros_like(way)
    for phase in np.unique(owner):
        mine = np.flatnonzero(owner == phase)
        shift[mine] = _onto(middles[found[first[mine]]], way[mine], holds[phase - 1])
    bends[found] = shift[place]
    return bends


def _on_surfaces(body):
    """Triangles between two phases, (t, 3) int array, the later of the two, and normals out of that, (t, 3)."""
    triangles, owners = triangles_on(body.cells, body.fixed)
    order = np.lexsort(np.sort(triangles, axis=1).T)
    alike = np.sort(triangles, axis=1)[order]
    same = np.flatnonzero(np.all(alike[1:] == alike[:-1], axis=1))
    one, other = (owners[order[same + k]] for k in (0, 1))
    apart = body.phase[one] != body.phase[other]
    one, other, found = one[apart], other[apart], triangles[order[same[apart]]]
    later = body.phase[one] > body.phase[other]
    a, b, c = np.moveaxis(body.points[found], 1, 0)
    across = np.cross(b - a, c - a)
    outwards = np.einsum("ij,ij->i", across, body.points[body.cells[one]].mean(axis=1) - a) > 0
    across[outwards == later] *= -1
    return found, np.maximum(body.phase[one], body.phase[other]), across


def _onto(points, way, inside):
    """Shifts of points along their ways, either way, onto a surface; none where it is not found."""
    shift, open_ = np.zeros_like(points), np.any(way != 0, axis=1)
    for reach in SOUGHT:
        rows = np.flatnonzero(open_)
        low, high = (points[rows] + sign * reach * way[rows] for sign in (-1, 1))
        into = inside(low)
        met = into != inside(high)
        rows, low, high = rows[met], low[met], high[met]
        swapped = ~into[met][:, None]
        one, other = np.where(swapped, high, low), np.where(swapped, low, high)
        shift[rows] = one + crossing(one, other, inside)[:, None] * (other - one) - points[rows]
        open_[rows] = False
    return shift


def _check_volumes(scene, mesh, size):
    """Raise RuntimeError where much of an inclusion was thinner than the elements, and is lost."""
    found = np.bincount(mesh.phase, mesh.volumes, len(scene.materials)) / scene.volume
    for number, (part, known) in enumerate(zip(found, sampled_fractions(scene, POINTS), strict=True)):
        if abs(part - known) > LOST * known + OFF:
            raise RuntimeError(
                f"phase {number} is {part:.3g} of the box in elements of size = {size:.3g} m, by itself {known:.3g}: "
                "it has parts thinner than these; must be a smaller size"
            )
