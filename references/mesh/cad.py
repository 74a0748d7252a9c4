"""Tetrahedra that conform to every interface of a scene, by gmsh's OpenCASCADE kernel or on a lattice.

The box, its layers and its spheres (with their periodic images) are cut into one another, so no element straddles an
interface; second-order elements follow the spheres. All lengths are divided by the longest edge of the box before they
reach gmsh, whose tolerances are absolute. Where a shape has no volume of OpenCASCADE all are cut out of a lattice
(`references.mesh.lattice`).
"""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from demheat.scene import Shape, check_scene
from demheat.scene.inputs import finite, flag
from references.mesh.cells import MATCH, check, finished
from references.mesh.gmsh_session import Elements, attempts, call_gmsh, look_up, session, tetrahedra
from references.mesh.lattice import make_lattice
from references.mesh.size_table import table
from references.mesh.sizes import GROWTH, Sizes, check_cost, checked_size, unit_lengths, wanted_sizes
from references.mesh.solids import known
from references.mesh.turns import turn

# Unit lengths. OpenCASCADE's bounds of what splines end may be so much too wide (found: 5e-6).
LOOSE = 1e-5
# Balls and shells that gmsh's own fields look through for each point; more are looked up in a table.
MOST_FIELDS = 400


def make(scene, *, size=None, order=2, curved=True, coarser=1.0):
    """Mesh a scene."""
    check_scene(scene)
    flag("curved", curved)
    # What surfaces resist and phases conduct does not change where they are.
    takes = ("resistance", "exchange", "anisotropy", "dependence", "perfect")
    scene.require("elements are known in a box", domain="box", takes=takes)
    finite("coarser", coarser, "a finite number >= 1", lambda v: v >= 1)
    size = min(coarser * checked_size(scene, size, order), max(scene.size))
    if not all(map(known, scene.inclusions)):
        check_cost(Sizes(size, *(np.zeros((0, width)) for width in (5, 6, 4))), scene.size, order)
        return make_lattice(scene, size=size, order=order, curved=curved)
    wanted = wanted_sizes(scene, size, coarser=coarser)
    cells = check_cost(wanted, scene.size, order)
    sizes = unit_lengths(wanted, max(scene.size))

    def attempt(factor, algorithm, done):
        finer = sizes._replace(size=factor * sizes.size)
        return _attempt(scene, finer, Elements(algorithm, order == 2, bool(curved), cells), done)

    return attempts(scene, attempt, size)


class _Geometry(NamedTuple):
    """What the mesher knows of a scene: images of the inclusions with their phases, its box and unit length, m."""

    images: list[tuple[int, Shape]]
    size: tuple[float, float, float]
    periodic: bool

    @property
    def scale(self):
        return max(self.size)

    @property
    def box(self):
        return np.array(self.size) / self.scale


def _attempt(scene, sizes, elements, done):
    """One try: geometry, mesh, arrays, checks."""
    geometry = _Geometry(scene.images(), scene.size, scene.periodic)
    points, cells, phase = call_gmsh(_tetrahedra, geometry, sizes, elements, cells=elements.estimated, done=done)
    mesh = finished(scene, points, cells, phase, elements.quadratic)
    check(scene, mesh)
    return mesh


def _tetrahedra(geometry, sizes, elements):
    """Points, cells and phases, in unit lengths."""
    gmsh = session()
    phases = _cut_geometry(gmsh, geometry)
    if geometry.periodic:
        _tie_faces(gmsh, geometry.box)
    # Kept until the end: gmsh has its address.
    features = None
    if len(sizes.balls) + len(sizes.shells) > MOST_FIELDS:
        features = table(sizes, geometry.box)
        look_up(gmsh, features)
        sizes = sizes._replace(balls=sizes.balls[:0], shells=sizes.shells[:0])
    _set_sizes(gmsh, sizes, geometry.box)
    return tetrahedra(gmsh, phases, elements)[:3]


def _cut_geometry(gmsh, geometry):
    """Cut box, layers and spheres into one another; {volume tag: phase}."""
    occ, box = gmsh.model.occ, geometry.box
    tools = [(phase, (3, shape.cad(occ, box, geometry.scale))) for phase, shape in geometry.images]
    _turn_spheres(occ, geometry, [tag for _, (_, tag) in tools])
    body = (3, occ.addBox(0, 0, 0, *box))
    phases = {body[1]: 0}
    if tools:
        pieces, (kept, *parts) = occ.fragment([body], [tag for _, tag in tools])
        occ.remove(list(set(pieces) - set(kept)), recursive=True)
        phases = {tag: 0 for _, tag in kept}
        for (phase, _), part in zip(tools, parts, strict=True):
            phases.update({tag: phase for _, tag in part if tag in phases})
    occ.synchronize()
    return phases


def _turn_spheres(occ, geometry, tags):
    """Turn spheres about their centres, all images of one alike; layers cut none."""
    faces, turns = [np.array([0.0, length]) for length in geometry.box], {}
    for (phase, shape), tag in zip(geometry.images, tags, strict=True):
        if shape.fills_ball:
            center, radius = (each / geometry.scale for each in shape.ball())
            if phase not in turns:
                turns[phase] = turn(center, radius, faces)
            *axis, angle = turns[phase]
            occ.rotate([(3, tag)], *center, *axis, angle)


def _tie_faces(gmsh, box):
    """Make the mesh on each face "+" the translate of that on the face "-"."""
    for axis in range(3):
        low, high = (_face_pieces(gmsh, axis, at) for at in (0.0, box[axis]))
        if len(low) != len(high):
            raise RuntimeError("opposite faces of the periodic cell were cut into different pieces")
        shift = np.eye(4)
        shift[axis, 3] = box[axis]
        keys = np.array([key for key, _ in low])
        distance, match = cKDTree(keys).query(np.array([key for key, _ in high]) - [*shift[:3, 3], 0])
        if distance.max() > MATCH or len(set(match)) != len(match):
            raise RuntimeError("opposite faces of the periodic cell do not match")
        for (_, tag), i in zip(high, match, strict=True):
            gmsh.model.mesh.setPeriodic(2, [tag], [low[i][1]], shift.ravel().tolist())


def _face_pieces(gmsh, axis, at):
    """[((centre x, y, z, area), tag)] of the surfaces in one face of the box."""
    found = []
    for _, tag in gmsh.model.getEntities(2):
        bounds = np.reshape(gmsh.model.getBoundingBox(2, tag), (2, 3))[:, axis]
        if np.abs(bounds - at).max() < LOOSE:
            middle = gmsh.model.occ.getCenterOfMass(2, tag)
            if abs(middle[axis] - at) < MATCH:
                found.append(((*middle, gmsh.model.occ.getMass(2, tag)), tag))
    return found


def _set_sizes(gmsh, sizes, box):
    field, size = gmsh.model.mesh.field, sizes.size
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    tags = []

    def add(kind, **numbers):
        tags.append(field.add(kind))
        for name, value in numbers.items():
            field.setNumber(tags[-1], name, value)

    for x, y, z, radius, h in sizes.balls[sizes.balls[:, 4] < size]:
        thick = (size - h) / GROWTH
        add("Ball", XCenter=x, YCenter=y, ZCenter=z, Radius=radius, Thickness=thick, VIn=h, VOut=size)
    for axis, start, stop, h in sizes.slabs[sizes.slabs[:, 3] < size]:
        low, high = np.zeros(3), box.copy()
        low[int(axis)], high[int(axis)] = start, stop
        ends = dict(zip(("XMin", "YMin", "ZMin", "XMax", "YMax", "ZMax"), (*low, *high), strict=True))
        add("Box", VIn=h, VOut=size, Thickness=(size - h) / GROWTH, **ends)
    for x, y, z, inner, outer, h in sizes.shells:
        add("MathEval")
        distance = f"Sqrt((x-({x:.12f}))^2+(y-({y:.12f}))^2+(z-({z:.12f}))^2)"
        field.setString(tags[-1], "F", f"{h:.12f}+{GROWTH}*Fabs({distance}-{(inner + outer) / 2:.12f})")
    if tags:
        least = field.add("Min")
        field.setNumbers(least, "FieldsList", tags)
        field.setAsBackgroundMesh(least)
