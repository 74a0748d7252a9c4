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
