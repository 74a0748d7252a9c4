"""What of our own stands beside the programs of others: methods on images, meshes and bodies, and their resolutions."""

import math

from studies.peers.given import SCENES

VOXELS = (16, 32, 64, 128)
# Elements of bricks are dear beyond this.
MOST = {"fem-p1": 32}
ON_IMAGES = ("fft-plain", "fem-p1")
STRAIGHT = "fem-straight"
ON_BODIES = {
    "dem": ("particles", (2_000, 20_000, 100_000)),
    "fem": ("size", (0.15, 0.08, 0.05)),
    # On the meshes of 0.08, 0.05 and 0.03 stand the elements of others.
    "fem-p1": ("size", (0.08, 0.05, 0.03)),
    STRAIGHT: ("size", (0.08, 0.05)),
    "fft": ("voxels", (32, 64, 128)),
}
# Laws that programs of grains print, and layers of grains or cells; at random there is one size.
PRINTED = ("root of area", "Hertz radius", "Hertz area", "whole grain", "cylinder")
BED_LAYERS = {"chain": 10, "unlike chain": 10, "simple cubic": 8, "body-centred": 6, "random bed": None}
# What refines a program, and the sign with which it does; bodies at every resolution, at two, and at one.
REFINES = {"n": 1, "voxels": 1, "particles": 1, "size": -1}
EVERY, TWO = ("sphere 10",), ("half 10", "dispersion 10")
# What another body says as well; and bodies of programs that are given our mesh, on which all linear elements have one
# answer.
ALIKE = ("layers along", "dispersion 0.1")
MESHED = ("layers off the grid", "sphere 0.01", "half 10", "dispersion 10")
HIGHEST = 5
QUICK_SCENES = ("sphere 10", "layers off the grid")


def ours():
    """Name of a method, what it is given, the body, and its resolution."""
    for scene in SCENES:
        for name in ON_IMAGES:
            for n in VOXELS:
                if n <= MOST.get(name, n):
                    yield name, "image", scene, {"n": n}
        for name, (knob, values) in ON_BODIES.items():
            for value in values:
                yield name, "body", scene, {knob: value}


def our_beds():
    """Scene and layers of the beds that programs of grains have: the same by `demheat.grains`."""
    for law in PRINTED:
        for arrangement, n in BED_LAYERS.items():
            yield f"{arrangement}, {law}", {"n": n} if n else {}


def thinned(cases):
    """Cases without those that say little more: one body at every resolution, some at two, others at one or at none.

    Parameters
    ----------
    cases : list of dict

    Returns
    -------
    list of dict
    """
    values = {}
    for case in cases:
        values.setdefault(_kind(case), set()).add(_fineness(case))
    return [case for case in cases if sorted(values[_kind(case)]).index(_fineness(case)) < _levels(case)]


def _kind(case):
    """What two resolutions of one program share; each bed of grains has numbers of layers of its own."""
    here = ("scene", *REFINES) if case["scene"] in SCENES else REFINES
    return tuple((key, value) for key, value in case.items() if key not in here)


def _fineness(case):
    return tuple(sign * case[knob] for knob, sign in REFINES.items() if knob in case)


def _levels(case):
    """How many resolutions a body is worth; beds of grains are exact with few layers as with many."""
    scene, given, order = case["scene"], case["given"], case.get("order", 1)
    if scene in EVERY:
        return math.inf
    if scene not in SCENES:
        return 1
    # Elements of a higher degree on the same mesh or image: as well on any body as on one.
    bent = given in ("mesh", "image") and order > 1 or case["name"] == STRAIGHT
    # Of a program that has several degrees on the body the highest.
    low = given == "body" and 1 < order < HIGHEST and scene not in TWO and case["name"] not in ON_BODIES
    meshed = case["name"] == "fem-p1" and given == "body" or given == "mesh"
    if bent or low or scene in ALIKE or (meshed and scene not in MESHED):
        return 0
    return 2 if scene in TWO and not meshed else 1
