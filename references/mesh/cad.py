"""Tetrahedra that conform to every interface of a scene, by gmsh's OpenCASCADE kernel (the only home of gmsh).

The box, its layers and its spheres (with their periodic images) are cut into one another, so no element straddles an
interface; second-order elements follow the spheres. All lengths are divided by the longest edge of the box before they
reach gmsh, whose tolerances are absolute.
"""

from __future__ import annotations

import ctypes
import importlib
import math
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager

import numpy as np
from scipy.spatial import cKDTree

from demheat.scene import WALLS, Layer, Sphere
from references.mesh.cells import MATCH, Mesh, bent, check, snap, straighten, volumes_of, wall
from references.mesh.sizes import estimated_cells, unit_lengths, wanted_sizes

# Debian and Ubuntu packages of the libraries that gmsh's wheel links to and a bare system lacks (readelf -d, dpkg -S).
PACKAGES = {
    "libGLU.so.1": "libglu1-mesa",
    "libGL.so.1": "libgl1",
    "libX11.so.6": "libx11-6",
    "libXext.so.6": "libxext6",
    "libXrender.so.1": "libxrender1",
    "libXcursor.so.1": "libxcursor1",
    "libXfixes.so.3": "libxfixes3",
    "libXft.so.2": "libxft2",
    "libXinerama.so.1": "libxinerama1",
    "libfontconfig.so.1": "libfontconfig1",
    "libgomp.so.1": "libgomp1",
}
# Cube root of the box volume over the default size: about 1e5 nodes at either order,
EDGES = {1: 50, 2: 26}
# or if that is more, this times the cube root of the number of spheres (found: 0.07 % on 83 of them at order 2).
EDGES_APART = 8
MOST_CELLS = 3e7
# Factor on the size, gmsh's 3-D algorithm (10 = HXT, 1 = Delaunay): a size that fails often has neighbours that work.
ATTEMPTS = ((1.0, 10), (0.93, 10), (0.86, 10), (0.93, 1))
# How much longer edges may be one metre farther from a feature, in metres.
GROWTH = 0.3
OPTIONS = {
    "General.Terminal": 0,
    "Mesh.MeshSizeExtendFromBoundary": 0,
    "Mesh.MeshSizeFromPoints": 0,
    "Mesh.MeshSizeFromCurvature": 0,
    "Mesh.MeshSizeMin": 0,
    "Mesh.Algorithm": 6,
    "Mesh.Optimize": 1,
    # Below it slivers on the spheres cannot be curved; above it elements in narrow gaps cost much time in vain.
    "Mesh.OptimizeThreshold": 0.2,
    "Mesh.ElementOrder": 1,
    "Mesh.MaxNumThreads1D": 1,
    "Mesh.MaxNumThreads2D": 1,
    "Mesh.MaxNumThreads3D": 1,
}
SET_LATER = ("Mesh.MeshSizeMax", "Mesh.Algorithm3D", "Mesh.SecondOrderLinear")
_LOCK = threading.Lock()


def make(scene, *, size=None, order=2, curved=True):
    """Mesh a scene.

    Parameters
    ----------
    scene : Scene
    size : float, m, optional
        Longest wanted edge; it is less on small spheres, in thin layers and in narrow gaps. Default: the cube root
        of the box volume over 26 (order 2) or 50 (order 1), with many spheres an eighth of their mean distance.
    order : {1, 2}
        Nodes at the corners only, or also at the middles of the edges.
    curved : bool
        With order 2, put the middle nodes onto the spheres.

    Returns
    -------
    Mesh

    Raises
    ------
    ValueError
        If an argument is not as described, or asks for more than 3e7 elements.
    NotImplementedError
        If surfaces of the scene touch.
    RuntimeError
        If gmsh fails at four neighbouring sizes.
    ImportError
        If gmsh or a system library that it needs is missing; the message lists the packages.
    """
    size = _checked_size(scene, size, order)
    sizes = unit_lengths(wanted_sizes(scene, size), max(scene.size))
    load_gmsh()
    begin, errors = time.perf_counter(), []
    for number, (factor, algorithm) in enumerate(ATTEMPTS, start=1):
        knobs = sizes._replace(size=factor * sizes.size), algorithm, order == 2, bool(curved)
        try:
            # A thread of its own shields the caller's OpenMP settings, which gmsh changes in its thread.
            with ThreadPoolExecutor(1) as pool:
                mesh = pool.submit(_attempt, scene, *knobs).result()
        except Exception as error:
            if type(error) not in (Exception, RuntimeError):  # gmsh raises plain Exception
                raise
            errors.append(f"{factor * size:.3g} m: {error}")
            continue
        stats = {"size": factor * size, "attempts": number, "mesh_s": time.perf_counter() - begin}
        return mesh._replace(stats=stats | mesh.stats)
    raise RuntimeError(f"gmsh could not mesh the scene at any of {len(ATTEMPTS)} sizes ({'; '.join(errors)})")


def load_gmsh():
    """Import gmsh.

    Returns
    -------
    module

    Raises
    ------
    ImportError
        If the package or a system library that it needs is missing; the message names what to install.
    """
    try:
        return importlib.import_module("gmsh")
    except ModuleNotFoundError as error:
        raise ImportError("gmsh is not installed: pip install gmsh") from error
    except OSError as error:
        missing = [name for name in PACKAGES if not _loads(name)]
        packages = " ".join(PACKAGES[name] for name in missing) or "none of the usual ones is missing"
        raise ImportError(
            f"gmsh cannot load its library ({error}). Missing system libraries: {', '.join(missing) or 'unknown'}. "
            f"On Debian or Ubuntu: apt-get install {packages}"
        ) from error


def _checked_size(scene, size, order):
    if order not in (1, 2):
        raise ValueError(f"order = {order!r}: must be 1 or 2")
    if size is None:
        spheres = sum(isinstance(inclusion, Sphere) for inclusion in scene.inclusions)
        return scene.volume ** (1 / 3) / max(EDGES[order], EDGES_APART * spheres ** (1 / 3))
    try:
        good = math.isfinite(size) and size > 0
    except TypeError:
        good = False
    if not good:
        raise ValueError(f"size = {size!r}: must be a finite number > 0 m")
    if estimated_cells(scene, size) > MOST_CELLS:
        least = (estimated_cells(scene, 1.0) / MOST_CELLS) ** (1 / 3)
        raise ValueError(f"size = {size!r} m: more than {MOST_CELLS:.0e} tetrahedra; must be >= {least:.3g} m")
    return float(size)


def _loads(name):
    try:
        ctypes.CDLL(name)
    except OSError:
        return False
    return True


@contextmanager
def _session():
    """A fresh gmsh model; options, model and the caller's own gmsh session are afterwards as before."""
    gmsh = load_gmsh()
    with _LOCK:
        mine = not gmsh.isInitialized()
        if mine:
            gmsh.initialize(argv=[], readConfigFiles=False, run=False, interruptible=False)
        before = {name: gmsh.option.getNumber(name) for name in (*OPTIONS, *SET_LATER)}
        current = gmsh.model.getCurrent()
        try:
            for name, value in OPTIONS.items():
                gmsh.option.setNumber(name, value)
            gmsh.model.add("demheat")
            yield gmsh
        finally:
            if mine:
                gmsh.finalize()
            else:
                gmsh.model.remove()
                gmsh.model.setCurrent(current)
                for name, value in before.items():
                    gmsh.option.setNumber(name, value)


def _attempt(scene, sizes, algorithm, quadratic, curved):
    """One try: geometry, mesh, arrays, checks."""
    scale = max(scene.size)
    box = np.array(scene.size) / scale
    with _session() as gmsh:
        phases = _geometry(gmsh, scene, scale)
        if scene.periodic:
            _tie_faces(gmsh, box)
        _set_sizes(gmsh, sizes, box)
        gmsh.option.setNumber("Mesh.Algorithm3D", algorithm)
        gmsh.option.setNumber("Mesh.SecondOrderLinear", not curved)
        gmsh.model.mesh.generate(3)
        if quadratic:
            gmsh.model.mesh.setOrder(2)
        points, cells, phase = _arrays(gmsh, phases, quadratic)
    pairs = snap(points, box, scene.periodic)
    straightened, jacobian = straighten(points, cells, pairs) if quadratic else (0, 1.0)
    volumes, curves = volumes_of(points[cells]) * scale**3, bent(points[cells])
    walls = {name: wall(points, cells, box, name) for name in WALLS}
    stats = {"straightened": straightened, "jacobian": jacobian}
    # Exactly on the faces in metres too, whatever the rounding of the scale.
    metres = np.where(points == box, scene.size, points * scale)
    mesh = Mesh(metres, cells, phase, volumes, curves, walls, pairs, stats)
    check(scene, mesh)
    return mesh


def _geometry(gmsh, scene, scale):
    """Cut box, layers and spheres into one another; {volume tag: phase}."""
    occ, box = gmsh.model.occ, np.array(scene.size) / scale
    tools = []
    for phase, inclusion in enumerate(scene.inclusions, start=1):
        if isinstance(inclusion, Layer):
            low, span = np.zeros(3), box.copy()
            start, stop = np.clip([inclusion.start / scale, inclusion.stop / scale], 0.0, box[inclusion.axis])
            low[inclusion.axis], span[inclusion.axis] = start, stop - start
            tools.append((phase, (3, occ.addBox(*low, *span))))
    for phase, sphere in scene.images():
        center = np.array(sphere.center) / scale
        tag = occ.addSphere(*center, sphere.radius / scale)
        # A generic turn keeps poles and seam off the faces, edges and symmetry planes of the scene.
        occ.rotate([(3, tag)], *center, 1, 2, 3, 1.0)
        tools.append((phase, (3, tag)))
    body = (3, occ.addBox(0, 0, 0, *box))
    phases = {body[1]: 0}
    if tools:
        tools.sort()
        pieces, (kept, *parts) = occ.fragment([body], [tag for _, tag in tools])
        occ.remove(list(set(pieces) - set(kept)), recursive=True)
        phases = {tag: 0 for _, tag in kept}
        for (phase, _), part in zip(tools, parts, strict=True):
            phases.update({tag: phase for _, tag in part if tag in phases})
    occ.synchronize()
    return phases


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
        if np.abs(bounds - at).max() < MATCH:
            found.append(((*gmsh.model.occ.getCenterOfMass(2, tag), gmsh.model.occ.getMass(2, tag)), tag))
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


def _arrays(gmsh, phases, quadratic):
    """Points, cells and the phase of each cell, in unit lengths, nodes of cells only."""
    kind, width = (11, 10) if quadratic else (4, 4)
    parts = {tag: gmsh.model.mesh.getElementsByType(kind, tag)[1].reshape(-1, width) for tag in phases}
    cells = np.concatenate(list(parts.values())).astype(np.int64)
    phase = np.repeat(np.array(list(phases.values()), np.int32), [len(part) for part in parts.values()])
    if not len(cells):
        raise RuntimeError("no tetrahedra were made")
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    place = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    place[tags.astype(np.int64)] = np.arange(len(tags))
    used, cells = np.unique(place[cells], return_inverse=True)
    cells = cells.reshape(-1, width).astype(np.int32)
    if quadratic:
        cells[:, [8, 9]] = cells[:, [9, 8]]  # gmsh lists edge 23 before 13
    return coordinates.reshape(-1, 3)[used], cells, phase
