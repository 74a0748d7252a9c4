"""The methods that take part, with knobs drawn by seed, and what each may be off before it must say so."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from demheat.method import DEGREE, Method
from demheat.scene import Layer, Scene, Sphere
from demheat.scene.volumes import coats
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
# What is exact but for the solver: a tolerance of 1e-5 to 1e-9, and rounding at contrasts of 1e6.
SOLVED = 1e-3
# Nobody need be better where a body is a few elements thick; nobody may be worse without a word.
LEAST, MOST = 0.05, 0.20
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


def allowed(way: Way, scene: Scene) -> float:
    """Largest relative error of the conductivity that is no fault where the method says nothing.

    What the method declares, at the resolution at which it does, grows with the size of an element over the thinnest
    feature: with the first order, which is less than declared orders grow. It stays between `LEAST` and `MOST`.
    Features are bodies, and gaps of an element or more. Narrower gaps earn nothing: what they spoil must be said.
    """
    method = way.method
    if method.resolution == DEGREE or (scene.only(Layer) and "laminate" not in method.exceptions):
        return SOLVED
    at_declared = DECLARED / method.resolution.size(method.coarse)
    grown = method.errors.conductivity * at_declared * way.element / thinnest(scene, way.element)
    return float(np.clip(grown, LEAST, MOST))


def thinnest(scene: Scene, least_gap: float = np.inf) -> float:
    """Least thickness of a feature, m: box, spheres, layers and between them, coats, gaps not narrow."""
    spheres = [each for each in scene.inclusions if isinstance(each, Sphere)]
    found = [min(scene.size), *coats(scene), *(2 * each.radius for each in spheres)]
    for axis, side in enumerate(scene.size):
        ends = {x for each in scene.inclusions if isinstance(each, Layer) and each.axis == axis for x in _ends(each)}
        found += np.diff(sorted({0.0, side} | ends)).tolist()
    found += [gap for gap in _gaps(scene, spheres) if gap >= least_gap]
    return float(min(x for x in found if x > 0))


def _gaps(scene, spheres):
    """Between the surfaces of spheres, their images and walls; less than nothing where they are nested or cut."""
    size = np.array(scene.size)
    centers, radii = np.array([each.center for each in spheres]), np.array([each.radius for each in spheres])
    for number, (center, radius) in enumerate(zip(centers, radii, strict=True)):
        apart = centers[number + 1 :] - center
        if scene.periodic:
            apart -= size * np.round(apart / size)
            yield size.min() - 2 * radius
        else:
            yield from (*(center - radius), *(size - center - radius))
        yield from np.linalg.norm(apart, axis=1) - radii[number + 1 :] - radius


def _ends(layer):
    return layer.start, layer.stop
