"""Hard scenes drawn by seed: each family has one hardness, the rest of its scenes is ordinary.

Boxes are about one metre wide and matrices conduct one or so, but in the family that changes units.
"""

from dataclasses import replace

import numpy as np

from demheat.packing.dispersion import dispersion
from demheat.scene import Layer, Material, Scene, Sphere
from studies.hard_cases.surfaces import KINDS, as_surfaces

LOW, HIGH = 20.0, 50.0
# Contrasts between which uniform draws of the exponent take turns with the extremes.
EXTREMES = (0.0, 1e-6, 1e-3, 1e3, 1e6)
SITES = {
    "sc": [(0.5, 0.5, 0.5)],
    "bcc": [(0.25, 0.25, 0.25), (0.75, 0.75, 0.75)],
    "fcc": [(0.25, 0.25, 0.25), (0.25, 0.75, 0.75), (0.75, 0.25, 0.75), (0.75, 0.75, 0.25)],
}
# Volume fractions up to a hair below touching, .5236, .6802 and .7405, and at most .6.
MOST = {"sc": 0.52, "bcc": 0.6, "fcc": 0.6}


def scene_of(family: str, seed: int) -> Scene:
    """The scene of a family by a seed, the same at every call."""
    scene = spheres_of(family, seed)
    return as_surfaces(KINDS[seed % len(KINDS)], scene) if family == "surface" else scene


def spheres_of(family: str, seed: int) -> Scene:
    """The same, surfaces as the spheres that they draw."""
    return FAMILIES[family](rng_of(family, seed), seed)


def rng_of(family, seed, stream=0):
    """Generator of a family and a seed; what knobs are drawn from is another stream than the scenes'."""
    return np.random.default_rng([list(FAMILIES).index(family), seed, stream, 15])


def _scene(rng, size, matrix, inclusions, periodic=None):
    """A periodic cell or walls, along an axis drawn."""
    axis = int(rng.integers(3))
    if rng.random() < 0.5 if periodic is None else periodic:
        return Scene(size, matrix, inclusions, gradient=tuple(np.eye(3)[axis]))
    return Scene(size, matrix, inclusions, walls={"xyz"[axis] + "-": LOW, "xyz"[axis] + "+": HIGH})


def _contrast(rng, decades=6.0):
    """An extreme in two of five draws."""
    if rng.random() < 0.4:
        return float(rng.choice(EXTREMES))
    return float(10 ** rng.uniform(-decades, decades))


def _matrix(rng):
    return Material(float(10 ** rng.uniform(-1, 1)))


def _times(matrix, contrast):
    return Material(matrix.conductivity * contrast)


def _array(rng, kind, contrast, fraction, periodic=True):
    matrix, sites = _matrix(rng), SITES[kind]
    radius = (3 * fraction / (4 * np.pi * len(sites))) ** (1 / 3)
    spheres = [Sphere(site, radius, _times(matrix, contrast)) for site in sites]
    return _scene(rng, (1.0, 1.0, 1.0), matrix, spheres, periodic)


def _contrasts(rng, seed):
    """Cubic arrays of any contrast and fraction; each ninth is infinite."""
    kind = ("sc", "bcc", "fcc", "sc")[seed % 4]
    contrast = np.inf if seed % 9 == 7 else _contrast(rng)
    return _array(rng, kind, contrast, rng.uniform(0.02, MOST[kind]), periodic=seed % 4 < 3)


def _gaps(rng, seed):
    """Spheres a tenth to a millionth of a diameter from each other or from a held wall, or touching."""
    gap = 0.0 if seed % 6 == 5 else 10 ** rng.uniform(-6, -1)
    contrast, matrix = _contrast(rng, 3.0), _matrix(rng)
    other = _times(matrix, contrast)
    if seed % 3 == 0:
        return _array(rng, "sc", contrast, np.pi / 6 * (1 - gap) ** 3)
    if seed % 3 == 1:
        axis, sphere = int(rng.integers(3)), np.full(3, 0.5)
        radius = float(rng.uniform(0.15, 0.35))
        sphere[axis] = radius * (1 + 2 * gap)
        walls = {"xyz"[axis] + "-": LOW, "xyz"[axis] + "+": HIGH}
        return Scene((1.0, 1.0, 1.0), matrix, [Sphere(sphere, radius, other)], walls=walls)
    # Touching ones are no more than a hundred times as conducting: see `verdicts.truth`.
    other = _times(matrix, min(contrast, 100.0)) if gap == 0 else other
    radius, way = 0.2, np.eye(3)[rng.integers(3)] + 0.3 * rng.normal(size=3)
    way *= radius * (1 + gap) / np.linalg.norm(way)
    return _scene(rng, (1.0, 1.0, 1.0), matrix, [Sphere(0.5 + s * way, radius, other) for s in (-1, 1)])


def _placed(rng, radii, size, apart, over=None):
    """Centres of spheres that keep apart, made smaller until there is room; with `over` they reach over walls."""
    size, found = np.array(size), []
    for radius in sorted(radii, reverse=True):
        for attempt in range(4000):
            margin = radius + apart if over is None else -over * radius
            center = rng.uniform(margin, size - margin)
            if all(np.linalg.norm(center - c) > radius + r + apart for c, r in found):
                found.append((center, radius))
                break
            radius *= 1.0 if attempt % 50 else 0.9
    return found


def _cut(rng, seed):
    """Spheres that walls cut, the better part of them inside or a slice only."""
    matrix, size = _matrix(rng), rng.uniform(0.6, 1.0, 3)
    balls = _placed(rng, rng.uniform(0.15, 0.3, rng.integers(1, 4)), size, 0.04, over=0.6)
    contrast = _contrast(rng, 3.0)
    return _scene(rng, size, matrix, [Sphere(c, r, _times(matrix, contrast)) for c, r in balls], periodic=False)


def _ratios(rng, seed):
    """Two to eight spheres whose radii are as 1 to 10, each of its own material."""
    matrix, size = _matrix(rng), rng.uniform(0.7, 1.0, 3)
    radii = 0.28 * 10 ** -np.append([0.0, 1.0], rng.uniform(0, 1, rng.integers(0, 7)))
    balls = _placed(rng, radii, size, 0.01)
    return _scene(rng, size, matrix, [Sphere(c, r, _times(matrix, _contrast(rng, 3.0))) for c, r in balls])


def _dense(rng, seed):
    """Random dispersions up to a fraction of .6."""
    matrix, number = _matrix(rng), int(rng.integers(12, 17))
    knobs = {"fraction": float(rng.uniform(0.3, 0.6)), "gap": float(10 ** rng.uniform(-3, -2)), "seed": seed}
    balls = zip(*dispersion(number, **knobs), strict=True)
    other = _times(matrix, float(10 ** rng.uniform(-2, 2)))
    return _scene(rng, (1.0, 1.0, 1.0), matrix, [Sphere(c, r, other) for c, r in balls], periodic=True)


def _layers(rng, length, axis, matrix, thinnest):
    """One to five layers of their own materials, down to a thickness."""
    count = rng.integers(1, 6)
    ends = np.cumsum(10 ** rng.uniform(np.log10(thinnest), 0.0, 2 * count + 1))
    ends *= length / ends[-1]
    return [Layer(axis, a, b, _times(matrix, _contrast(rng))) for a, b in zip(ends[:-1:2], ends[1::2], strict=True)]


def _thin(rng, seed):
    """Layers down to a thousandth of the box."""
    matrix = _matrix(rng)
    return _scene(rng, rng.uniform(0.6, 1.0, 3), matrix, _layers(rng, 0.6, int(rng.integers(3)), matrix, 1e-3))


def _shells(rng, seed):
    """A coated sphere, its coat a third to a hundredth of its radius; every other one is neutral to its matrix."""
    radius = float(rng.uniform(0.2, 0.45))
    # Certain bounds of thinner coats take hundreds of thousands of elements.
    inner = radius * (1 - 10 ** rng.uniform(-2 if seed % 2 else -1.4, -0.5))
    coat, core = (10 ** rng.uniform(-3, 3, 2)).tolist()
    f, beta = (inner / radius) ** 3, (core - coat) / (core + 2 * coat)
    matrix = coat * (1 + 2 * beta * f) / (1 - beta * f) if seed % 2 else 1.0
    balls = [Sphere((0.5,) * 3, r, Material(k)) for r, k in ((radius, coat), (inner, core))]
    return _scene(rng, (1.0, 1.0, 1.0), Material(matrix), balls)


def _slender(rng, seed):
    """Needles and plates, ten to a hundred times as long as thick, of layers or with spheres."""
    aspect, matrix = 10 ** rng.uniform(1, 2), _matrix(rng)
    size = np.ones(3)
    size[rng.permutation(3)[: 1 + seed % 2]] = aspect if seed % 2 == 0 else np.sqrt(aspect)
    if seed % 4 < 2:
        axis = int(np.argmax(size))
        return _scene(rng, size, matrix, _layers(rng, size[axis], axis, matrix, 0.03))
    balls = _placed(rng, rng.uniform(0.2, 0.4, 2), size, 0.04)
    return _scene(rng, size, matrix, [Sphere(c, r, _times(matrix, _contrast(rng, 3.0))) for c, r in balls])


def _islands(rng, seed):
    """Bodies that pores cut off, pores that stop all heat or leave it a way, cores in coats of pores."""
    pore, metal = Material(0.0), _matrix(rng)
    kind = seed % 5
    if kind == 0:
        coats = [Sphere((0.5,) * 3, r, m) for r, m in ((rng.uniform(0.3, 0.45), pore), (0.2, metal))]
        return _scene(rng, (1.0, 1.0, 1.0), metal, coats)
    if kind == 1:
        layers = [Layer(0, a, a + rng.uniform(0.05, 0.2), pore) for a in (0.1, 0.6)]
        return _scene(rng, (1.0, 0.8, 0.9), metal, layers)
    if kind == 2:
        balls = _placed(rng, rng.uniform(0.1, 0.3, 4), np.ones(3), 0.02)
        return _scene(rng, (1.0, 1.0, 1.0), pore, [Sphere(c, r, metal) for c, r in balls])
    if kind == 3:
        within = [Layer(1, 0.2, 0.8, pore), Sphere((0.5, 0.5, 0.5), rng.uniform(0.1, 0.28), metal)]
        return _scene(rng, (1.0, 1.0, 1.0), metal, within)
    balls = _placed(rng, rng.uniform(0.12, 0.3, 5), np.ones(3), 0.01)
    return _scene(rng, (1.0, 1.0, 1.0), metal, [Sphere(c, r, pore) for c, r in balls])


def _coarse(rng, seed):
    """A sphere of a moderate contrast: what is hard is the resolution, see `ways`."""
    return _array(rng, "sc", 10 ** rng.uniform(-2, 2), rng.uniform(0.05, 0.5), periodic=bool(seed % 2))


def _infinite(rng, seed):
    """Perfect conductors at a tenth to a thousandth of a radius from each other, pores or others among them."""
    matrix, gap = _matrix(rng), 10 ** rng.uniform(-3, -1)
    radii = rng.uniform(0.12, 0.25, rng.integers(2, 7))
    balls = _placed(rng, radii, np.ones(3), gap * float(radii.min()))
    kinds = (np.inf, (0.0, 10.0)[seed % 2])
    inclusions = [Sphere(c, r, _times(matrix, kinds[k % 3 == 2])) for k, (c, r) in enumerate(balls)]
    return _scene(rng, (1.0, 1.0, 1.0), matrix, inclusions)


def _films(rng, seed):
    """Surfaces that resist like a thousandth to a thousand radii of the matrix, around anything from bad to perfect."""
    matrix = _matrix(rng)
    balls = _placed(rng, rng.uniform(0.12, 0.3, rng.integers(1, 6)), np.ones(3), 0.02)
    contrast = np.inf if seed % 3 == 2 else float(10 ** rng.uniform(-3, 6))
    film = 10 ** rng.uniform(-3, 3) / matrix.conductivity
    inclusions = [Sphere(c, r, _times(matrix, contrast), resistance=film * r) for c, r in balls]
    return _scene(rng, (1.0, 1.0, 1.0), matrix, inclusions)


def _surfaces(rng, seed):
    """Arrays of any contrast, drawn by surfaces of other kinds."""
    # Limits of two level sets must not meet.
    kind, most = (("sc", 0.45), ("bcc", 0.1))[seed // len(KINDS) % 2]
    return _array(rng, kind, _contrast(rng, 3.0), rng.uniform(0.03, most))


def _units(rng, seed):
    """Scenes of other families in lengths and conductivities of 1e-9 to 1e9."""
    family = ("contrast", "ratio", "thin", "islands")[seed % 4]
    metre, watt = 10.0 ** rng.choice([-9, 9, rng.uniform(-9, 9)], 2)
    return in_units(FAMILIES[family](rng, seed + 100), metre, watt)


def in_units(scene: Scene, metre: float, watt: float) -> Scene:
    """The same scene, its lengths and its conductivities multiplied."""
    made = {m: Material(m.conductivity * watt) for m in scene.materials}
    load = {"gradient": scene.gradient} if scene.periodic else {"walls": dict(scene.walls)}
    inclusions = [replace(_longer(each, metre), material=made[each.material]) for each in scene.inclusions]
    return Scene(np.array(scene.size) * metre, made[scene.matrix], inclusions, **load)


def _longer(shape, factor):
    if isinstance(shape, Layer):
        return replace(shape, start=shape.start * factor, stop=shape.stop * factor)
    return replace(shape, center=np.array(shape.center) * factor, radius=shape.radius * factor)


FAMILIES = {
    "contrast": _contrasts,
    "gap": _gaps,
    "cut": _cut,
    "ratio": _ratios,
    "dense": _dense,
    "thin": _thin,
    "shell": _shells,
    "slender": _slender,
    "islands": _islands,
    "coarse": _coarse,
    "units": _units,
    "infinite": _infinite,
    "film": _films,
    "surface": _surfaces,
}
