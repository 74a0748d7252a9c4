"""What of our own stands beside the programs of others: methods on images, meshes and bodies, and their resolutions."""

from studies.peers.given import SCENES

VOXELS = (16, 32, 64, 128)
# Elements of bricks are dear beyond this.
MOST = {"fem-p1": 32}
ON_IMAGES = ("fft-plain", "fem-p1")
ON_BODIES = {
    "dem": ("particles", (2_000, 20_000, 100_000)),
    "fem": ("size", (0.15, 0.08, 0.05)),
    "fem-p1": ("size", (0.08, 0.04, 0.025)),
    "fft": ("voxels", (32, 64, 128)),
}
# Laws that programs of grains print, and layers of grains or cells; at random there is one size.
PRINTED = ("root of area", "Hertz radius", "Hertz area", "whole grain", "cylinder")
BED_LAYERS = {
    "chain": (10, 40), "unlike chain": (10,), "simple cubic": (8, 16), "body-centred": (6, 12), "random bed": (None,)
}  # fmt: skip
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
        for arrangement, layers in BED_LAYERS.items():
            for n in layers:
                yield f"{arrangement}, {law}", {"n": n} if n else {}
