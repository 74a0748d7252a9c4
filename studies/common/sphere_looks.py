"""Colour and marker of the methods on the sphere in time, by the names of `sphere_in_time.name_of`.

Apart from what rows run, so that a new colour repeats none of them.
"""

from studies.harness.figures import BLUE, GREY, PINK, RED, SKY

LOOKS = {
    "DEM, laguerre": (RED, "o"),
    "DEM, calibrated": (PINK, "s"),
    "DEM, platonic": (GREY, "s"),
    "FEM, P1": (SKY, "^"),
    "FEM, P2": (BLUE, "v"),
}
