"""GetFEM: finite elements in Python over C++ by bricks of models; linear or quadratic tetrahedra on the mesh all get.

The heat is that of the energy, assembled by its language of forms at the solution; solved as `Model.solve` does
unless told otherwise. Walls are held by its `simplification`, which takes their unknowns out.
No case of its documentation is run. https://getfem.org
"""

from functools import partial

from studies.peers import meshes
from studies.peers.alone import packaged
from studies.peers.python_elements import library

TITLE = "GetFEM"
KIND = "mesh"
GET = "apt: python3-getfem++"
CANNOT = {}
EXPLAINED = "none: the equations are those of our finite elements on the same mesh"
CASES = meshes.cases()
# Its module has no version: Debian's.
missing, _, solve = library("getfem", "getfem", version="")
version = partial(packaged, "python3-getfem")
