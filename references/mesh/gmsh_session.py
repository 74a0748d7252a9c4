"""gmsh in a session of its own: loaded, set up, tried at several sizes, its tetrahedra as arrays."""

import ctypes
import importlib
import time
from typing import NamedTuple

import numpy as np

from demheat.runtime.extras import missing
from demheat.runtime.progress import stage
from references.mesh.apart import run_apart

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
# Factor on the size, gmsh's 3-D algorithm (10 = HXT, 1 = Delaunay): a size that fails often has neighbours that work.
ATTEMPTS = ((1.0, 10), (0.93, 10), (0.86, 10), (0.93, 1))
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
    # Defaults, for bits that are the same whatever they will be.
    "General.NumThreads": 1,
    "Mesh.RandomSeed": 1,
}
# Of meshing, per tetrahedron of second order; found: 7e-5 to 1.2e-4.
SECONDS_EACH = 1e-4
# Addresses that gmsh may have in a process of its own: for libraries and threads, and for each tetrahedron that is
# estimated several times what it needs (found: 1.9 kB). More than that must not take the machine's all.
BASE_BYTES, MOST_BYTES_EACH = 4 * 2**30, 5_000
# Processor seconds after which gmsh is stopped: for the geometry of many inclusions, and so many times what meshing was
# found to take.
BASE_SECONDS, MOST_TIMES = 600.0, 20.0


def load_gmsh():
    """Import gmsh."""
    try:
        return importlib.import_module("gmsh")
    except ModuleNotFoundError as error:
        raise ImportError(missing("gmsh", "meshing")) from error
    except OSError as error:
        lacking = [name for name in PACKAGES if not _loads(name)]
        packages = " ".join(PACKAGES[name] for name in lacking) or "none of the usual ones is missing"
        raise ImportError(
            f"gmsh cannot load its library ({error}). Missing system libraries: {', '.join(lacking) or 'unknown'}. "
            f"On Debian or Ubuntu: apt-get install {packages}"
        ) from error


def _loads(name):
    try:
        ctypes.CDLL(name)
    except OSError:
        return False
    return True


class Elements(NamedTuple):
    """What tetrahedra to make."""

    algorithm: int  # Number of gmsh's 3-D algorithm
    quadratic: bool  # With nodes at the middles of the edges
    curved: bool  # Put those onto the surfaces
    estimated: float  # Their number, about


def attempts(scene, attempt, size):
    """Mesh at the size asked for, or if gmsh fails at neighbouring ones."""
    begin, errors = time.perf_counter(), []
    for number, (factor, algorithm) in enumerate(ATTEMPTS, start=1):
        try:
            with stage("mesh") as done:
                mesh = attempt(factor, algorithm, done)
        except Exception as error:
            if type(error) not in (Exception, RuntimeError):  # gmsh raises plain Exception
                raise
            errors.append(f"{factor * size:.3g} m: {error}")
            continue
        stats = {"size": factor * size, "attempts": number, "mesh_s": time.perf_counter() - begin}
        return mesh._replace(stats=stats | mesh.stats)
    raise RuntimeError(
        f"gmsh could not mesh the {scene.domain} of {scene.size} m with {len(scene.inclusions)} inclusions at any of "
        f"{len(ATTEMPTS)} sizes ({'; '.join(errors)})"
    )


def call_gmsh(function, *arguments, cells, done):
    """Call function(*arguments), which works in a `session`, in another process."""
    seconds = cells * SECONDS_EACH
    limits = {"memory": BASE_BYTES + cells * MOST_BYTES_EACH, "most": BASE_SECONDS + MOST_TIMES * seconds}
    return run_apart(function, *arguments, seconds=seconds, done=done, **limits)


def session():
    """gmsh with a new model, once in a process that ends then."""
    gmsh = load_gmsh()
    gmsh.initialize(argv=[], readConfigFiles=False, run=False, interruptible=False)
    for name, value in OPTIONS.items():
        gmsh.option.setNumber(name, value)
    gmsh.model.add("demheat")
    return gmsh


def look_up(gmsh, table):
    """Take the sizes of elements from a table: gmsh's own fields all go through all features for each point."""
    from references.mesh.size_kernels import size_callback

    # gmsh's own wrapper takes functions of Python, which cost as much as the mesh.
    failed = ctypes.c_int()
    address = ctypes.c_void_p(table.ctypes.data)
    gmsh.lib.gmshModelMeshSetSizeCallback(size_callback.ctypes, address, ctypes.byref(failed))
    if failed.value:
        raise RuntimeError(gmsh.logger.getLastError())


def tetrahedra(gmsh, phases, elements):
    """Mesh the volumes of the current model."""
    gmsh.option.setNumber("Mesh.Algorithm3D", elements.algorithm)
    gmsh.option.setNumber("Mesh.SecondOrderLinear", not elements.curved)
    # All dimensions at once: one after the other they make other meshes.
    gmsh.model.mesh.generate(3)
    if elements.quadratic:
        gmsh.model.mesh.setOrder(2)
    kind, width, flat = (11, 10, (9, 6)) if elements.quadratic else (4, 4, (2, 3))
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
    if elements.quadratic:
        cells[:, [8, 9]] = cells[:, [9, 8]]  # gmsh lists edge 23 before 13
    number = np.full(len(tags), -1, dtype=np.int32)
    number[used] = np.arange(len(used))
    surface = gmsh.model.mesh.getElementsByType(flat[0])[1].reshape(-1, flat[1])[:, :3]
    return coordinates.reshape(-1, 3)[used], cells, phase, number[place[surface.astype(np.int64)]]
