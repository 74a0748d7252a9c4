"""SfePy: finite elements in Python by terms of weak forms; linear or quadratic tetrahedra on the mesh that all get.

The heat is that of the energy, its Laplace term evaluated at the solution; conjugate gradients of PETSc with an
incomplete Cholesky factor, the first choice of its `ls.auto_iterative`, to 1e-12. Its own first choice of a direct
solver, MUMPS, ends the process with Debian's libmumps 5.5. No case of its documentation is run. https://sfepy.org
"""

from studies.peers import meshes
from studies.peers.python_elements import library

TITLE = "SfePy"
KIND = "mesh"
GET = "apt: python3-sfepy, python3-petsc4py"
CANNOT = {"meshes with triangles beside tetrahedra": "meshes with several cell kinds are not supported"}
EXPLAINED = "none: the equations are those of our finite elements on the same mesh"
CASES = meshes.cases()
missing, version, solve = library("sfepy", "sfepy", "petsc4py", version="sfepy.__version__")
