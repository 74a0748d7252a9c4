"""SfePy: finite elements in Python by terms of weak forms; linear or quadratic tetrahedra on the mesh that all get.

The heat is that of the energy, its Laplace term evaluated at the solution; conjugate gradients of PETSc with an
incomplete Cholesky factor, the first choice of its `ls.auto_iterative`, to 1e-12. Its own first choice of a direct
solver, MUMPS, ends the process with Debian's libmumps 5.5. Of conduction its documentation prints pictures and no
number. https://sfepy.org
"""

import subprocess
import tempfile
from pathlib import Path

import numpy as np

from studies.peers import meshes
from studies.peers.alone import THREADS
from studies.peers.outside import Found, asked, python_of

TITLE = "SfePy"
KIND = "mesh"
GET = "apt: python3-sfepy, python3-petsc4py"
CANNOT = {"meshes with triangles beside tetrahedra": "meshes with several cell kinds are not supported"}
EXPLAINED = "none: the equations are those of our finite elements on the same mesh"
CASES = meshes.cases()
SCRIPT = Path(__file__).parent / "scripts" / "sfepy_body.py"


def missing():
    """Why it cannot run here, or None."""
    for name in ("sfepy", "petsc4py"):
        if python_of("sfepy", name) is None:
            return f"no Python here has {name}; Debian has it as python3-{name}"
    return None


def version():
    """As it says."""
    code = "import sfepy.version; print(sfepy.version.__version__)"
    return subprocess.run([python_of("sfepy"), "-c", code], capture_output=True, text=True).stdout.strip()


def solve(scene, *, size, order=1):
    """Solve a body.

    Parameters
    ----------
    scene : Scene
    size : float, m
        Longest edge.
    order : {1, 2}
    """
    mesh = meshes.corners(meshes.conforming(scene, size=size, order=order))
    given = {
        "order": order,
        "phases": meshes.phases(mesh, scene),
        "length": scene.size[0],
        "high": scene.walls["x-"],
        "low": scene.walls["x+"],
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "body.npz"
        np.savez(path, points=mesh.points, cells=mesh.cells, groups=meshes.FIRST + mesh.phase)
        told = asked(python_of("sfepy"), SCRIPT, given | {"mesh": str(path)}, folder=folder, environment=THREADS)
    found = meshes.by_energy(scene, told["energy"])
    apart = 100 * (meshes.by_heat(scene, abs(told["flux"])) / found - 1)
    note = f"by its flux integrated over the wall x- {apart:+.2g} % of this"
    return Found(found, told["cost"], unknowns=told["unknowns"], note=note)
