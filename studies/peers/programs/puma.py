"""PuMA, NASA's pumapy: finite volumes on the image with harmonic means on faces; or bricks (Q1) on a periodic body.

"fv" has the temperatures of the walls in the centres of the first and last voxels. Its `tolerance` goes to SciPy as an
absolute one, beside which SciPy's relative 1e-5 of the right-hand side remains: no smaller one is heard, and laminates
were up to 2e-4 off. Conductivities in units of 1e-6 W/(m K) make the same 1e-5 a millionth of it, whence `unit`. "fe"
is of a periodic body, so of bodies that mirror themselves it answers the same question; MINRES to 1e-10.
https://github.com/nasa/puma, version 3.2.2; the package index has another program under the name pumapy.
"""

import numpy as np

from studies.peers import packages
from studies.peers.given import bodies

TITLE = "PuMA"
KIND = "image"
GET = "source: nasa/puma v3.2.2 (`pip install pumapy` gets another program)"
CANNOT = {'walls by "fe"': "its bricks are of a periodic body"}
EXPLAINED = (
    "its walls are at the centres of the first and last voxels: a body shorter by half a voxel at each end, over n - 1 "
    "voxels; a homogeneous body or equal halves do not show it"
)
SCENES = bodies("sphere 1000")
# Those that mirror themselves in the middle between the walls, and so do not notice periods.
MIRRORED = ("sphere 10", "half 10")
CASES = (
    *({"scene": scene, "n": n, "by": "fv"} for scene in SCENES for n in (16, 32, 64)),
    *({"scene": scene, "n": 128, "by": "fv"} for scene in ("layers off the grid", "sphere 10", "pore")),
    *({"scene": scene, "n": n, "by": "fe"} for scene in MIRRORED for n in (16, 32, 64)),
    # What its own units cost.
    *({"scene": "layers off the grid", "n": n, "by": "fv", "unit": 1.0} for n in (16, 32, 64)),
    # What it cannot do.
    {"scene": "dispersion 10", "n": 16, "by": "fe"},
)
UNIT = 1e-6
missing, version = packages.asked_of("pumapy", GET)
# Two halves in a row, 10 and 1 W/(m K), of its tests.
own = packages.own_of("pumapy", 1.818181818, "python/test/test_conductivity.py, test_matSeriesInx_x")


def solve(scene, *, n, by="fv", unit=UNIT):
    """Solve the image of a body."""
    if by == "fe" and not mirrored(scene):
        raise NotImplementedError("PuMA's bricks: a periodic body only, or one that mirrors itself")
    return packages.found_on_image("pumapy", scene, n, by=by, unit=unit)


def mirrored(scene, points=16):
    """Whether a body looks the same from either wall, and from either side, seen at points^3 places."""
    from studies.peers.given import image

    labels = image(scene, points).labels
    return all((labels == labels[turn]).all() for turn in (np.s_[::-1], np.s_[:, ::-1], np.s_[:, :, ::-1]))
