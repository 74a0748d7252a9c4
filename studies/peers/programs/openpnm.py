"""OpenPNM: a network with a pore in each voxel and throats through its faces; and PoreSpy's `tortuosity_fd` on it.

A throat's conductance is that of two half voxels in a row. Walls are "boundary pores" on the faces of the image, half a
voxel from the centres (`Cubic.add_boundary_pores`), or the "pores" of the first and last slices themselves. PoreSpy's
takes one conducting phase, with walls in the first and last slices too. Both by PyAMG's Ruge-Stueben to a residual of
1e-10.
https://openpnm.org, version 3.6.4, and https://porespy.org, version 3.2.0.
"""

from studies.peers import packages
from studies.peers.given import bodies

TITLE = "OpenPNM"
KIND = "image"
GET = "pip: openpnm, porespy"
CANNOT = {"several conducting phases in PoreSpy's tortuosity_fd": "its image is of booleans"}
EXPLAINED = (
    "walls in the pores of the first and last slices are half a voxel inside, over n - 1 voxels: so does PoreSpy's "
    "tortuosity_fd. With boundary pores layers that end between voxels are exact"
)
SCENES = bodies("sphere 1000")
CASES = (
    *({"scene": scene, "n": n, "by": "boundary pores"} for scene in SCENES for n in (16, 32, 64)),
    *({"scene": scene, "n": n, "by": "pores"} for scene in ("layers off the grid", "pore") for n in (16, 32, 64)),
    *({"scene": "pore", "n": n, "by": "tortuosity_fd"} for n in (16, 32, 64, 128)),
    # What it refuses.
    {"scene": "sphere 10", "n": 16, "by": "tortuosity_fd"},
)
missing, version = packages.asked_of("openpnm", GET)
# The tortuosity of open space by PoreSpy's `tortuosity_fd`.
own = packages.own_of("openpnm", 1.0, "PoreSpy's pull request 500: tau is now 1.000000 in an image of open space")


def solve(scene, *, n, by="boundary pores"):
    """Solve the image of a body."""
    if by == "tortuosity_fd" and sum(k > 0 for k in set(scene.conductivities)) > 1:
        raise NotImplementedError("PoreSpy's tortuosity_fd: one conducting phase only")
    return packages.found_on_image("openpnm", scene, n, by=by)
