"""Which rows there are: scenes, methods and resolutions."""

from studies.harness import methods

TIMEOUT = 3600.0
# Steady solves whose costs say what costs scatter by, and what a packing costs that is made on the spot.
STEADY = {
    "third": {"dem": (1_000, 3_000, 10_000, 30_000, 100_000)},
    "half": {"dem": (1_000, 3_000, 10_000, 30_000, 100_000, 200_000)},
    "polydisperse": {"dem-calibrated": (3_000, 30_000, 100_000)},
}
# To compare the FFT schemes: tolerances that bring each within 1e-6 of its own limit, which the tight one shows.
TO_LIMIT, TIGHT = {"fft": 1e-3, "fft-em": 3e-6}, 1e-9
COMPARED = (64, 128)


def all_cases():
    """All cases, in the order of rows."""
    for scene, resolutions in STEADY.items():
        for name in resolutions:
            yield from _ladder(scene, methods.all_methods()[name], resolutions)
    for voxels in COMPARED:
        for name, loose in TO_LIMIT.items():
            for each in (loose, TIGHT):
                yield methods.case(name, scene="third", voxels=voxels, tolerance=each)
    for name, numbers in (("tessellation", (10_000, 100_000)), ("steady", (20_000, 1_000_000))):
        yield from ({"name": name, "particles": number, "seed": 0, "method": "dem"} for number in numbers)


def _ladder(scene, method, resolutions):
    """A method over its resolutions, small packings of the first scenes more than once."""
    for value in methods.spent(method, resolutions):
        several = method.name == "dem" and scene in ("third", "half") and value <= 10_000
        for seed in (0, 1, 2) if several else (0,):
            yield methods.case(method.name, scene=scene, **methods.at(method, value, seed))
