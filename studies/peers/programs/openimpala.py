"""OpenImpala: finite volumes on the image with harmonic means on faces, on AMReX and HYPRE.

"mlmg" is AMReX's multigrid, the default of its Python interface, with walls on the faces of the image; "pcg" HYPRE's
conjugate gradients, with walls in the centres of the first and last voxels. The Python interface knows one conducting
phase. Its C++ program takes several from a file, `tortuosity.active_phases` and `tortuosity.phase_diffusivities`; the
same code is in the Python package and hears them by AMReX's interface for C, which is how several phases get here
("pcg" only). MLMG to 1e-12, PCG to 1e-9 as it is.
https://github.com/BASE-Laboratory/OpenImpala, version 4.4.9.
"""

from studies.peers import packages
from studies.peers.given import bodies

TITLE = "OpenImpala"
KIND = "image"
GET = "pip: openimpala"
CANNOT = {'several conducting phases by "mlmg"': "it looks for a way through one phase alone and finds none"}
EXPLAINED = (
    "by PCG walls are in the centres of the first and last voxels, n - 1 voxels apart, and it divides by n: a "
    "homogeneous body conducts n / (n - 1) of what it should, as its manual says. MLMG has a little too "
    "much flux where an insulator meets a wall"
)
SEVERAL = bodies("homogeneous", "sphere 1000", "pore")
CASES = (
    *(
        {"scene": scene, "n": n, "solver": solver}
        for scene in ("homogeneous", "pore")
        for solver in ("mlmg", "pcg")
        for n in (16, 32, 64)
    ),
    *({"scene": scene, "n": n, "solver": "pcg"} for scene in SEVERAL for n in (16, 32, 64)),
    # What it refuses.
    {"scene": "sphere 10", "n": 16, "solver": "mlmg"},
)
missing, version = packages.asked_of("openimpala", GET)
# The tortuosity of a homogeneous cube of 16 voxels by HYPRE.
own = packages.own_of(
    "openimpala", 15 / 16, "docs/user-guide/concepts.md: for a uniform medium on N cells tau = (N - 1) / N"
)


def solve(scene, *, n, solver="mlmg"):
    """Solve the image of a body."""
    if solver == "mlmg" and sum(k > 0 for k in set(scene.conductivities)) > 1:
        raise NotImplementedError("OpenImpala's MLMG: one conducting phase only")
    return packages.found_on_image("openimpala", scene, n, solver=solver)
