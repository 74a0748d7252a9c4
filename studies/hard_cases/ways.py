"""The methods that take part, with knobs drawn by seed."""

from typing import NamedTuple

import numpy as np

from demheat.method import Method
from demheat.scene import Scene
from studies.harness import methods

# Beside the declared ones: the rule that the FFT method chooses by itself, held to what its best rule declares.
AUTO = "fft-auto"
NAMES = (
    "dem", "dem-plain", "dem-calibrated", "fft", "fft-plain", "fft-links", AUTO, "fft-em", "fem", "fem-p1", "multipole",
)  # fmt: skip
ODD = (5, 7, 9, 11, 13, 15, 17, 19, 23, 25, 29, 31)
COARSE = (1, 2, 3, 4, 5, 7, 11, 13, 17, 23, 31, 41, 50)
# Gives up beyond, which is a refusal: the square root of the contrast counts for Eyre and Milton.
ITERATIONS = {"fft": 1000, "fft-em": 400}
# Estimated elements of a mesh beyond which finite elements are not asked: thin layers take a square of them each.
ELEMENTS = 30_000
# The sphere on which methods declare their errors is so many edges of the cube wide.
DECLARED = 2 / 3


class Way(NamedTuple):
    """One method with its knobs."""

    name: str
    method: Method  # As declared
    knobs: dict  # Of its `solve`
    element: float  # m: Size of an element; 0 of what has none


def ways(family: str, scene: Scene, rng: np.random.Generator) -> list[Way]:
    """All methods, with resolutions drawn; finite elements only where the scene's own details let a mesh be cheap."""
    coarse = family == "coarse"
    particles = int(rng.integers(1, 16)) ** 3 if coarse else int(10 ** rng.uniform(2.3, 3.5))
    voxels = int(rng.choice(COARSE if coarse else ODD))
    parts = {"fem": rng.integers(1 if coarse else 3, 7), "fem-p1": rng.integers(1 if coarse else 4, 10)}
    edge = scene.volume ** (1 / 3)
    found = []
    for name in NAMES:
        method = methods.all_methods()["fft" if name == AUTO else name]
        if name.startswith("dem"):
            found.append(_dem(name, method, edge, particles, int(rng.integers(100))))
        elif name.startswith("fft"):
            single = rng.random() < 0.25
            found.append(_fft(name, method, scene, edge / voxels, single))
        elif name.startswith("fem"):
            size = float(edge / parts[name])
            if _elements(scene, size, method.knobs["order"]) < ELEMENTS:
                found.append(Way(name, method, {**method.knobs, "size": size}, size))
        else:
            found.append(Way(name, method, {"accuracy": 1e-4}, 0.0))
    return found


def _dem(name, method, edge, particles, seed):
    knobs = {**method.knobs, "particles": particles, "seed": seed, "allow_few": True}
    return Way(name, method, knobs, edge / particles ** (1 / 3))


def _fft(name, method, scene, spacing, single):
    """Along each side as many voxels as make them nearly cubic."""
    shape = tuple(max(1, round(side / spacing)) for side in scene.size)
    knobs = {**method.knobs, "voxels": shape, "max_iterations": ITERATIONS.get(name, ITERATIONS["fft"])}
    if name == AUTO:
        knobs["rule"] = "auto"
    if single:
        knobs["precision"] = "float32"
    return Way(name, method, knobs, max(side / n for side, n in zip(scene.size, shape, strict=True)))


def _elements(scene, size, order):
    """Estimated number of tetrahedra; none where the mesher refuses, which is a case too."""
    from references.mesh.sizes import check_cost, wanted_sizes

    try:
        return check_cost(wanted_sizes(scene, size), scene.size, order)
    except (ValueError, NotImplementedError):
        return 0
