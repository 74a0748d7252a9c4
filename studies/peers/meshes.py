"""The mesh that finite elements of others are given: ours, that of `fem-p1` or `fem-straight`, in files that they read.

Straight tetrahedra that follow every interface, the phase of each, and the triangles on the walls. On the same mesh
with the same elements all programs have the same equations: they must agree to what their solvers leave.
"""

import math
from functools import lru_cache

import numpy as np

from references.mesh import Mesh, make
from references.mesh.cells import Wall
from studies.peers.given import bodies

# Faces of the box: number and name in files, where "-" is no letter of a name.
FACES = {
    "x-": (1, "xmin"),
    "x+": (2, "xmax"),
    "y-": (3, "ymin"),
    "y+": (4, "ymax"),
    "z-": (5, "zmin"),
    "z+": (6, "zmax"),
}
# Number of phase 0 in files.
FIRST = 11
# Gmsh's types of elements by their nodes, and its order of those of a quadratic tetrahedron: the last two swapped.
TRIANGLES, TETRAHEDRA = {3: 2, 6: 9}, {4: 4, 10: 11}
GMSH_ORDER = (0, 1, 2, 3, 4, 5, 6, 7, 9, 8)
# What the rows ask for; linear elements of each size.
BODIES = bodies("pore")
SIZES = (0.08, 0.05, 0.03)
# Digits that give every number back.
EXACT = "%.17g"


def conforming(scene, *, size, order=1) -> Mesh:
    """Straight tetrahedra of what conducts in a body between two isothermal walls across x."""
    scene.require("programs of others are given two walls across x", steady=True, domain="box")
    if set(scene.walls or ()) != {"x-", "x+"}:
        raise NotImplementedError(f"walls {sorted(scene.walls or ())}: programs of others are given two across x")
    mesh = _made(scene.size, scene.matrix, scene.inclusions, tuple(scene.walls.items()), size, order)
    conducts = scene.conductivities[mesh.phase] > 0
    return mesh if conducts.all() else _kept(mesh, conducts)


@lru_cache(maxsize=4)
def _made(box, matrix, inclusions, walls, size, order):
    from demheat import Scene

    return make(Scene(box, matrix, inclusions, walls=dict(walls)), size=size, order=order, curved=False)


def _kept(mesh, chosen):
    """Some elements of a mesh, and their nodes."""
    nodes, cells = np.unique(mesh.cells[chosen], return_inverse=True)
    number, owner = np.full(len(mesh.points), -1), np.cumsum(chosen) - 1
    number[nodes] = np.arange(len(nodes))
    walls = {}
    for name, (triangles, owners) in mesh.walls.items():
        mine = chosen[owners]
        walls[name] = Wall(number[triangles[mine]], owner[owners[mine]])
    return mesh._replace(
        points=mesh.points[nodes],
        cells=cells.reshape(-1, mesh.cells.shape[1]),
        phase=mesh.phase[chosen],
        volumes=mesh.volumes[chosen],
        curved=mesh.curved[chosen],
        walls=walls,
    )


def corners(mesh) -> Mesh:
    """The same tetrahedra by their corners alone, for programs that put nodes on edges themselves."""
    linear = mesh._replace(
        cells=mesh.cells[:, :4],
        walls={name: wall._replace(triangles=wall[0][:, :3]) for name, wall in mesh.walls.items()},
    )
    return _kept(linear, np.ones(len(mesh.cells), bool))


def unknowns(mesh) -> int:
    """Nodes that no wall holds."""
    held = np.concatenate([mesh.walls[name].triangles.ravel() for name in ("x-", "x+")])
    return len(mesh.points) - len(np.unique(held))


def phases(mesh, scene) -> dict[int, float]:
    """Conductivity by the number that a phase has in files, of those that have elements, W/(m K)."""
    return {FIRST + int(phase): float(scene.conductivities[phase]) for phase in np.unique(mesh.phase)}


def drop(scene) -> float:
    """Temperature of the wall x- over that of x+, K."""
    return scene.walls["x-"] - scene.walls["x+"]


def walls(scene) -> dict:
    """The two walls as scripts are told: their numbers in files, and their temperatures."""
    numbers = {"hot": FACES["x-"][0], "cold": FACES["x+"][0]}
    return numbers | {"high": scene.walls["x-"], "low": scene.walls["x+"]}


def by_heat(scene, heat) -> float:
    """Effective conductivity of a body by the heat that enters at the wall x-, W/(m K)."""
    length, *sides = scene.size
    return heat * length / (math.prod(sides) * drop(scene))


def by_energy(scene, energy) -> float:
    """The same by the integral of k grad T . grad T."""
    return by_heat(scene, energy / drop(scene))


def cases(*, quadratic=(0.08, 0.05)):
    """Bodies, sizes and orders of the rows of a program."""
    sizes = {1: SIZES, 2: quadratic}
    return tuple({"scene": name, "size": h, "order": order} for name in BODIES for order in sizes for h in sizes[order])


def write_msh(path, mesh):
    """Write Gmsh's format 2.2, which nearly all read; faces and phases are its physical groups."""
    groups = [(2, *FACES[name]) for name in mesh.walls]
    groups += [(3, FIRST + int(phase), f"phase{phase}") for phase in np.unique(mesh.phase)]
    count = len(mesh.cells) + sum(len(wall.triangles) for wall in mesh.walls.values())
    with open(path, "w") as file:
        file.write(f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{len(groups)}\n")
        file.writelines(f'{dimension} {number} "{name}"\n' for dimension, number, name in groups)
        file.write(f"$EndPhysicalNames\n$Nodes\n{len(mesh.points)}\n")
        _numbered(file, 1, mesh.points, f"%d {EXACT} {EXACT} {EXACT}")
        file.write(f"$EndNodes\n$Elements\n{count}\n")
        first = 1
        for name, (triangles, _) in mesh.walls.items():
            number = np.full(len(triangles), FACES[name][0])
            first = _elements(file, first, TRIANGLES[triangles.shape[1]], number, triangles)
        order = GMSH_ORDER[: mesh.cells.shape[1]]
        _elements(file, first, TETRAHEDRA[len(order)], FIRST + mesh.phase, mesh.cells[:, order])
        file.write("$EndElements\n")


def _elements(file, first, kind, group, nodes):
    """Each with two tags, both its group; returns the number that comes next."""
    two = np.full((len(nodes), 1), 2)
    _numbered(file, first, np.column_stack([0 * two + kind, two, group, group, nodes + 1]), "%d")
    return first + len(nodes)


def _numbered(file, first, rows, form):
    """Rows, each after its number."""
    np.savetxt(file, np.column_stack([np.arange(first, first + len(rows)), rows]), fmt=form)


def write_medit(path, mesh):
    """Write Medit's format, which FreeFEM reads without a plug-in."""
    triangles = [np.insert(wall.triangles + 1, 3, FACES[name][0], axis=1) for name, wall in mesh.walls.items()]
    blocks = {
        "Vertices": (np.insert(mesh.points, 3, 0, axis=1), f"{EXACT} {EXACT} {EXACT} %d"),
        "Triangles": (np.concatenate(triangles), "%d"),
        "Tetrahedra": (np.column_stack([mesh.cells + 1, FIRST + mesh.phase]), "%d"),
    }
    with open(path, "w") as file:
        file.write("MeshVersionFormatted 2\nDimension 3\n")
        for name, (rows, form) in blocks.items():
            file.write(f"{name}\n{len(rows)}\n")
            np.savetxt(file, rows, fmt=form)
        file.write("End\n")


def write_inp(path, mesh):
    """Write nodes and elements as Abaqus and CalculiX read them; faces are sets of nodes, phases sets of elements."""
    kind = {4: "DC3D4", 10: "DC3D10"}[mesh.cells.shape[1]]
    with open(path, "w") as file:
        file.write("*NODE, NSET=ALL\n")
        _numbered(file, 1, mesh.points, f"%d,{EXACT},{EXACT},{EXACT}")
        for phase in np.unique(mesh.phase):
            mine = np.flatnonzero(mesh.phase == phase)
            file.write(f"*ELEMENT, TYPE={kind}, ELSET=PHASE{FIRST + phase}\n")
            np.savetxt(file, np.column_stack([mine, mesh.cells[mine]]) + 1, fmt="%d", delimiter=",")
        for name, (triangles, _) in mesh.walls.items():
            file.write(f"*NSET, NSET={FACES[name][1].upper()}\n")
            np.savetxt(file, np.unique(triangles) + 1, fmt="%d,")
