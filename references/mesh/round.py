"""Meshes of round bodies: the cylinder and the sphere inscribed in the box, by gmsh, with curved tetrahedra."""

from itertools import combinations

import numpy as np

from demheat.scene import check_scene
from references.mesh.cells import EDGE_COLUMN, Mesh, Wall, bent, snap, straighten, volumes_of
from references.mesh.gmsh_session import Elements, attempts, call_gmsh, session, tetrahedra
from references.mesh.sizes import CELLS, checked_size

# Of the volume; chords of elements as long as the radius lose about this much.
LARGEST_LOSS = 0.2


def make_round(scene, *, size, order):
    """Mesh a round body."""
    check_scene(scene)
    scene.require("only boxes can have them here", shapes=(), takes=("exchange",))
    size = checked_size(scene, size, order)

    def attempt(factor, algorithm, done):
        elements = Elements(algorithm, order == 2, True, CELLS * scene.volume / size**3)
        return _attempt(scene, factor * size, elements, done)

    return attempts(scene, attempt, size)


def _attempt(scene, size, elements, done):
    """One try: geometry, mesh, arrays, checks."""
    scale = max(scene.size)
    box = np.array(scene.size) / scale
    what = scene.domain, box, size / scale, elements
    points, cells, phase, surface = call_gmsh(_tetrahedra, *what, cells=elements.estimated, done=done)
    pairs = snap(points, box, False)
    straightened, jacobian = straighten(points, cells, pairs) if elements.quadratic else (0, 1.0)
    volumes, curved = volumes_of(points[cells]) * scale**3, bent(points[cells])
    error = float(volumes.sum() / scene.volume - 1)
    if volumes.min() <= 0 or abs(error) > LARGEST_LOSS:
        raise RuntimeError(f"smallest element {volumes.min():.3g} m3, volume off by {error:.3g}")
    faces, owners = _outer(cells)
    if not np.array_equal(*(np.unique(np.sort(each[:, :3], axis=1), axis=0) for each in (faces, surface))):
        raise RuntimeError("the elements do not fill what the triangles on the surface enclose")
    stats = {"straightened": straightened, "jacobian": jacobian, "volume_error": error}
    return Mesh(points * scale, cells, phase, volumes, curved, _walls(scene, points, box, faces, owners), pairs, stats)


def _tetrahedra(domain, box, size, elements):
    """Points, cells, phases and triangles on the surface, in unit lengths."""
    gmsh = session()
    tag = _body(gmsh.model.occ, domain, box)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    return tetrahedra(gmsh, {tag: 0}, elements)


def _body(occ, domain, box):
    """Add the body, in unit lengths; its tag."""
    if domain == "sphere":
        tag = occ.addSphere(*(box / 2), box[0] / 2)
    else:
        axis = "xyz".index(domain[-1])
        low, along = box / 2, np.zeros(3)
        low[axis], along[axis] = 0, box[axis]
        tag = occ.addCylinder(*low, *along, min(np.delete(box, axis)) / 2)
    occ.synchronize()
    return tag


def _outer(cells):
    """Faces (k, 3 or 6) of one element only, and the elements (k,)."""
    faces, owners = [], []
    for a, b, c in combinations(range(4), 3):
        middles = [EDGE_COLUMN[a, b], EDGE_COLUMN[b, c], EDGE_COLUMN[a, c]] if cells.shape[1] == 10 else []
        faces.append(cells[:, [a, b, c, *middles]])
        owners.append(np.arange(len(cells)))
    faces, owners = np.concatenate(faces), np.concatenate(owners)
    _, first, count = np.unique(np.sort(faces[:, :3], axis=1), axis=0, return_index=True, return_counts=True)
    outer = first[count == 1]
    return faces[outer], owners[outer]


def _walls(scene, points, box, faces, owners):
    """The outer faces by wall."""
    walls, rest = {}, np.ones(len(faces), bool)
    if scene.domain != "sphere":
        axis = "xyz".index(scene.domain[-1])
        for side, at in (("-", 0.0), ("+", box[axis])):
            on = np.all(points[faces[:, :3], axis] == at, axis=1)
            walls["xyz"[axis] + side] = Wall(faces[on], owners[on])
            rest &= ~on
    return walls | {"round": Wall(faces[rest], owners[rest])}
