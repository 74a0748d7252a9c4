"""What of our own stands beside the programs of others: methods on images, meshes and bodies, and their resolutions."""

import math

from studies.peers import beds
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
# Laws that programs of grains print.
PRINTED = ("root of area", "Hertz radius", "Hertz area", "whole grain", "cylinder")
# What refines a program, and the sign with which it does; bodies at every resolution, at two, and at one.
REFINES = {"n": 1, "voxels": 1, "particles": 1, "size": -1}
EVERY, TWO = ("sphere 10",), ("half 10", "dispersion 10")
# What another body says as well; and bodies of programs that are given our mesh, on which all linear elements have one
# answer.
ALIKE = ("layers along", "dispersion 0.1")
MESHED = ("layers off the grid", "sphere 0.01")
HIGHEST = 5
QUICK_SCENES = ("sphere 10", "layers off the grid")
# How far programs of others are refined, and elements of a higher degree, or with a matrix slow to make: beyond that
# a row takes ten seconds to a minute for one point more of a curve. Matrices of a million rows are in `speed_error`.
FINEST = {
    "image": ("n", 64, 32),
    "mesh": ("size", 0.05, 0.08),
    "network": ("particles", 20_000, 20_000),
    "packing": ("particles", 2_000, 2_000),
}
CELLS = ("fipy",)


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
    """Cases of the beds that programs of grains have: the same by `demheat.grains`."""
    for law in PRINTED:
        yield from beds.cases(law, most=1)


def thinned(cases):
    """Cases without those that say little more: one body at every resolution, some at two, others at one or at none."""
    values, cases = {}, [case for case in cases if not _dear(case)]
    for case in cases:
        values.setdefault(_kind(case), set()).add(_fineness(case))
    return [case for case in cases if sorted(values[_kind(case)]).index(_fineness(case)) < _levels(case)]


def _dear(case):
    """Whether a row of somebody else's program takes long for one point more of a curve: see `FINEST`."""
    if case["name"] in (*ON_IMAGES, *ON_BODIES) or case["given"] not in FINEST:
        least = 0.2 if case.get("order") == HIGHEST else 0.1
        # Of several degrees on the body the highest is enough at its coarsest.
        return case["given"] == "body" and "order" in case and case["name"] not in ON_BODIES and case["size"] < least
    knob, most, bent = FINEST[case["given"]]
    elements = case.get("by") == "fe" or "order" in case or case["name"] in CELLS
    most = bent if elements and case.get("order", 2) > 1 else most
    return REFINES[knob] * case.get(knob, REFINES[knob] * most) > REFINES[knob] * most or case.get("density") == "max"


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
    # Our matrix is solved on one body: its error is ours.
    if bent or low or scene in ALIKE or given == "network" or (meshed and scene not in MESHED):
        return 0
    return 2 if scene in TWO and given == "body" and not meshed else 1
