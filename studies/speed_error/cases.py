"""Which rows there are: scenes, methods and resolutions."""

from __future__ import annotations

from studies.harness import methods
from studies.harness.methods import EDGE

TIMEOUT = 3600.0
# Steady solves whose costs say what costs scatter by, and what a packing costs that is made on the spot.
STEADY = {
    "third": {"dem": (1_000, 3_000, 10_000, 30_000, 100_000)},
    "half": {"dem": (1_000, 3_000, 10_000, 30_000, 100_000, 200_000)},
    "polydisperse": {"dem-calibrated": (3_000, 30_000, 100_000)},
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


def all_cases():
    """All cases, in the order of rows."""
    for scene, resolutions in STEADY.items():
        for name in resolutions:
            yield from _ladder(scene, methods.all_methods()[name], resolutions)
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
            yield methods.case(method.name, scene=scene, **methods.at(method, value, seed))
