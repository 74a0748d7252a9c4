"""MFEM by PyMFEM: hexahedra of order 1 or 2 on the image, one for each voxel.

Its Cartesian mesh has an attribute for each label; voxels that do not conduct are left out (SubMesh). Solved as in its
example 1, by conjugate gradients with Gauss-Seidel, down to 1e-10 of the preconditioned residual; the package
of the Python index is without MPI and so without hypre. The conductivity is the energy. Version 4.10.0.1.
Its documentation prints no value of a steady solution with its error that runs from the package alone: no `own`.
"""

from studies.peers import packages
from studies.peers.given import bodies

TITLE = "MFEM"
KIND = "image"
GET = "pip: mfem"
CANNOT = {
    "hypre's multigrid": "the package of the Python index is built without MPI, which its interface to hypre needs"
}
EXPLAINED = "stairs of voxels; energies of finite elements are too large at any order"
SCENES = bodies()
# Voxels by order: as many unknowns on half of them.
VOXELS = {1: (16, 32, 64), 2: (16, 32)}
CASES = tuple({"scene": scene, "order": order, "n": n} for scene in SCENES for order in VOXELS for n in VOXELS[order])
missing, version = packages.asked_of("mfem", GET)


def solve(scene, *, n, order=1):
    """Solve the image of a body."""
    return packages.found_on_image("mfem", scene, n, order=order)
