"""GetFEM: finite elements in Python over C++ by bricks of models; linear or quadratic tetrahedra on the mesh all get.

The heat is that of the energy, assembled by its language of forms at the solution; solved as `Model.solve` does
unless told otherwise. Walls are held by its `simplification`, which takes their unknowns out.
No case of its documentation is run. https://getfem.org
"""

from studies.peers import meshes
from studies.peers.alone import packaged
from studies.peers.python_elements import absent, solved

TITLE = "GetFEM"
KIND = "mesh"
GET = "apt: python3-getfem++"
CANNOT = {}
EXPLAINED = "none: the equations are those of our finite elements on the same mesh"
CASES = meshes.cases()


def missing():
    """Why it cannot run here, or None."""
    return absent("getfem", "getfem")


def version():
    """Debian's: its module has none."""
    return packaged("python3-getfem")


def solve(scene, *, size, order=1):
    """Solve a body."""
    return solved("getfem", scene, size=size, order=order)
