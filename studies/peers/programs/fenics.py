"""FEniCS: finite elements in Python by forms that it compiles; linear or quadratic tetrahedra on the mesh that all get.

DOLFIN, the library before DOLFINx. The heat is that of the energy, assembled at the solution; solved by the default of
its `solve`, a direct solver of PETSc. What it compiles it compiles before the clock starts, on a cube of six elements.
No case of its documentation is run. https://fenicsproject.org
"""

from studies.peers import meshes
from studies.peers.python_elements import library

TITLE = "FEniCS"
KIND = "mesh"
GET = "apt: python3-dolfin"
CANNOT = {}
EXPLAINED = "none: the equations are those of our finite elements on the same mesh"
CASES = meshes.cases()
missing, version, solve = library("fenics", "dolfin", version="dolfin.__version__")
