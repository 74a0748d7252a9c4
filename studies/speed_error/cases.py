"""Which rows there are: scenes, methods and resolutions."""

from __future__ import annotations

from studies.harness import methods
from studies.harness.methods import EDGE

TIMEOUT = 3600.0
# What stands beside the methods that every study compares, and the exact method for spheres.
BESIDE = ("dem-calibrated", "fem-straight", "fem-p1", "fft-plain", "multipole")
PARTICLES = (1_000, 3_000, 10_000, 30_000, 100_000)
VOXELS = (32, 64, 128)
SIZES = (0.2, 0.1, 0.07, 0.05)
# By knob, or by name where a method needs others; sizes in edges of the cube.
USUAL = {
    "particles": PARTICLES,
    "dem-calibrated": (3_000, 30_000),
    "size": SIZES,
    "fem-straight": (0.05,),
    "fem-p1": (0.1, 0.05, 0.025),
    "voxels": VOXELS,
    "fft-plain": (32, 128),
    "order": (1, 3, 7, 15),
}
CLOSELY = USUAL | {
    "dem-calibrated": (1_000, 10_000),
    "size": (0.2, 0.14, *SIZES[1:], 0.035),
    "fem-straight": (0.1, 0.05, 0.035),
    "fft": (*VOXELS, 256),
}
# Spheres make elements fine, whatever the size that is asked for: quadratic ones around a thousand, three million
# unknowns, would take as long as a third of all rows together, linear ones as long as all others of the scene.
BY_SCENE = {
    "third": CLOSELY,
    "half": CLOSELY | {"particles": (*PARTICLES, 200_000), "order": (3, 7, 15, 31)},
    # Iterations on laminate voxels go with the root of the contrast.
    "third at 1000": USUAL | {"fft-em": VOXELS[:2]},
    "third at infinity": USUAL | {"fft": VOXELS[:1], "fft-em": VOXELS[:1]},
    "half at 100": USUAL | {"order": (3, 7, 15, 31)},
    # Of the paper's network 30 000 happen to be where its error crosses zero.
    "polydisperse": USUAL
    | {"dem-calibrated": (3_000, 30_000, 100_000), "size": (0.2, 0.05), "fem-straight": (0.2,), "fem-p1": (0.1, 0.025)},
    "83 spheres": USUAL
    | {"fft": (*VOXELS, 256), "size": (1 / 20, 1 / 34), "fem-straight": (1 / 20,), "fem-p1": (1 / 20, 1 / 40)},
    "1000 spheres": USUAL
    | {"particles": (10_000, 30_000, 100_000), "size": (), "fem-straight": (), "fem-p1": (), "order": (1, 3, 5)},
    "laminate": USUAL | {"size": (0.2, 0.1), "fem-p1": (0.2, 0.1), "order": (1,)},
}
IN_TIME = ("dem", "fem", "fem-bricks")
MARCHED = {"particles": (1_000, 10_000, 30_000)}
# Longest edges, in edges of the slab and diameters of the ball, and in lengths of the beam.
EDGES = {
    "slab": {"size": (1 / 4, 1 / 8), "fem-p1": (1 / 8, 1 / 16), "fem-bricks": (1 / 8, 1 / 16, 1 / 32)},
    "ball": {"size": (0.12, 0.08), "fem-p1": (0.08, 0.05), "fem-bricks": (1 / 12,)},
    "beam": {"size": (0.08 / 2.184,), "fem-p1": (0.08 / 2.184, 0.05 / 2.184), "fem-bricks": (1 / 30,)},
}
# m; that of the beam as in `studies.common.terreros`, which is heavy to load.
LENGTHS = {"slab": EDGE, "ball": EDGE, "beam": 2.184e-3}
# To compare the FFT schemes: tolerances that bring each within 1e-6 of its own limit, which the tight one shows.
TO_LIMIT, TIGHT = {"fft": 1e-3, "fft-em": 3e-6}, 1e-9
COMPARED = (64, 128)
STEADY = (
    *("third", "third at 0.01", "third at 1000", "third at infinity", "half", "half at 100"),
    *("thin shell", "polydisperse", "83 spheres", "1000 spheres", "laminate"),
)


def all_cases():
    """All cases, in the order of rows."""
    for scene in STEADY:
        for method in methods.compared(*BESIDE):
            yield from _ladder(scene, method, BY_SCENE.get(scene, USUAL))
    for scene, edges in EDGES.items():
        found = (methods.all_methods()[name] for name in IN_TIME)
        for method in found:
            yield from _ladder(scene, method, MARCHED | edges, LENGTHS[scene] / EDGE)
    for voxels in COMPARED:
        for name, loose in TO_LIMIT.items():
            for each in (loose, TIGHT):
                yield methods.case(name, scene="third", voxels=voxels, tolerance=each)
    for name, numbers in (("tessellation", (10_000, 100_000)), ("steady", (20_000, 1_000_000))):
        yield from ({"name": name, "particles": number, "seed": 0, "method": "dem"} for number in numbers)


def _ladder(scene, method, resolutions, length=1.0):
    """A method over its resolutions, small packings of the first scenes more than once."""
    for value in methods.spent(method, resolutions):
        several = method.name == "dem" and scene in ("third", "half") and value <= 10_000
        if method.resolution is not None and method.resolution.metric:
            value = value * length
        for seed in (0, 1, 2) if several else (0,):
            knobs = methods.at(method, value, seed)
            if method.name == "multipole":
                knobs = {"degree": value}
            yield methods.case(method.name, scene=scene, **knobs)
