"""TauFactor: finite volumes on the image, a cell for each voxel, harmonic means on faces, over-relaxed on PyTorch.

`MultiPhaseSolver` takes phases of any conductivities; `Solver` one that conducts beside one that does not. Both compute
in single precision. They stop when the flux through slices across x differs by less than a share of it, by default
1e-2. Here 1e-4, which left conductivities of a sphere 1e-5 off those of double precision; layers get no further than
3e-4 at 64 voxels and 1e-3 at 128, and are 6e-5 and 2e-4 off there by iteration.
https://github.com/tldr-group/taufactor, version 1.2.1 with PyTorch 1.13.
"""

from studies.peers import packages
from studies.peers.given import bodies

TITLE = "TauFactor"
KIND = "image"
GET = "pip: taufactor, torch"
CANNOT = {"several conducting phases in `Solver`": "labels must be 0 and 1; `MultiPhaseSolver` takes them"}
EXPLAINED = (
    "`MultiPhaseSolver` puts the walls half a voxel outside of the image, in more of the material of its first and "
    "last slices, and divides by n + 1 voxels: a laminate is wrong, a homogeneous body or equal halves are not. "
    "`Solver` has them on the faces"
)
SCENES = bodies("sphere 1000")
CASES = (
    *({"scene": scene, "n": n, "solver": "MultiPhaseSolver"} for scene in SCENES for n in (16, 32, 64)),
    {"scene": "sphere 10", "n": 128, "solver": "MultiPhaseSolver"},
    *({"scene": scene, "n": n, "solver": "Solver"} for scene in ("homogeneous", "pore") for n in (16, 32, 64)),
    {"scene": "pore", "n": 128, "solver": "Solver"},
    # What it refuses.
    {"scene": "sphere 10", "n": 16, "solver": "Solver"},
)
# Voxels along an edge, and what single precision can reach with so many.
TOLERANCES, BEYOND = ((32, 1e-4), (64, 3e-4)), 1e-3
missing, version = packages.asked_of("taufactor", GET)
# The tortuosity of a strip across slanted steps, of its tests.
own = packages.own_of("taufactor", 7.51667, "tests/test_taufactor.py, test_solver_on_slanted_strip_of_ones")


def solve(scene, *, n, solver="MultiPhaseSolver"):
    """Solve the image of a body."""
    if solver == "Solver" and sum(k > 0 for k in set(scene.conductivities)) > 1:
        raise NotImplementedError("TauFactor's Solver: one conducting phase only")
    tolerance = next((value for most, value in TOLERANCES if n <= most), BEYOND)
    return packages.found_on_image("taufactor", scene, n, solver=solver, tolerance=tolerance)
