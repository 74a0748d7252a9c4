"""FiPy: finite volumes on the image, a cell for each voxel, harmonic means on faces.

Wall temperatures stand on the outer faces of the cells (`constrain`), so layers that end between voxels are exact. What
does not conduct is held by a source of its own, as its manual fixes values inside of a domain. SciPy's conjugate
gradients with FiPy's Jacobi go down to 1e-10 of the right-hand side; it solves with the diagonal as with any sparse
matrix, at each iteration anew, which costs about as much as it saves at a contrast of 10 and saves half at 1000. The
conductivity is the mean of the heat through both walls.
https://www.ctcms.nist.gov/fipy, version 4.0.3.
"""

from studies.peers import packages
from studies.peers.given import bodies

TITLE = "FiPy"
KIND = "image"
GET = "pip: fipy"
CANNOT = {}
EXPLAINED = "stairs of voxels; the heat between two voxels passes their face alone, as through resistances in a row"
SCENES = bodies()
# A minute each at 64.
FINE = ("layers off the grid", "sphere 10", "sphere 1000", "pore")
CASES = tuple({"scene": scene, "n": n} for scene in SCENES for n in ((16, 32, 64) if scene in FINE else (16, 32)))
missing, version = packages.asked_of("fipy", GET)
# The last of the values that its manual's "non-uniform steady-state diffusion" has in a formula.
own = packages.own_of("fipy", 49.5 + 18 * 50 / 4, "examples/diffusion/mesh1D.py, x + 18 L / 4 at the last of 50 cells")


def solve(scene, *, n):
    """Solve the image of a body."""
    return packages.found_on_image("fipy", scene, n)
