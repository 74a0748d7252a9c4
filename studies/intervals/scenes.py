"""Scenes of every kind, drawn by seed, each with what is known of its conductivity; matrices conduct 1."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from demheat import gallery
from demheat.scene import Box, Cylinder, Ellipsoid, HalfSpace, Image, Layer, LevelSet, Material, Scene, Sphere, Union
from references.exact.squares import checkerboard, square_rods
from studies.common import drawn
from studies.intervals import truth

# Contrasts are drawn between these powers of ten either way; one in five is an end.
DECADES, ENDS = 6.0, 0.2
# Of bodies that are judged by finer elements, and of boards, whose edges have no answer from 25 on.
MILD, BOARD = 2.0, 2.0
ONE = Material(1.0)
# How a ball is told by a function of points: negative inside; r is the distance from the centre, a the radius.
LEVELS: dict[str, Callable] = {
    "distance": lambda r, a: r - a,
    "squares": lambda r, a: r**2 - a**2,
    "squared": lambda r, a: (r - a) * np.abs(r - a),
    "cubed": lambda r, a: (r - a) ** 3,
    "clipped": lambda r, a: np.clip(r - a, -0.01, 0.01),
    "sign": lambda r, a: np.sign(r - a),
    "mask": lambda r, a: np.where(r <= a, -1.0, 1.0),
    "scaled": lambda r, a: 1e4 * (r - a),
}


class Drawn(NamedTuple):
    """A scene, what tells its conductivity, and its dual: the two conductivities have the product 1 (Keller 1964)."""

    scene: Scene
    known: Callable | None  # () -> `truth.Truth`; None where the dual alone tells
    dual: Scene | None = None


def _contrast(rng, decades=DECADES):
    power = rng.choice([-1, 1]) if rng.random() < ENDS else rng.uniform(-1, 1)
    return float(10.0 ** (decades * power))


def _load(rng, size, periodic=None, across=None):
    """A periodic cell or walls; `across` an axis, along one of the two others."""
    axis = int(rng.choice([each for each in range(3) if each != across]))
    return gallery.loaded(size, axis=axis, periodic=bool(rng.random() < 0.5) if periodic is None else periodic)


def _array(rng):
    """Cubic arrays up to nearly touching."""
    name = str(rng.choice(list(drawn.ARRAYS)))
    fraction = drawn.ARRAYS[name] * rng.uniform(0.05, 0.9)
    make = gallery.sphere_in_cube if name == "simple_cubic" and rng.random() < 0.5 else getattr(gallery, name)
    scene = make(_contrast(rng), fraction=fraction, edge=1.0, matrix=ONE, axis=int(rng.integers(3)))
    return Drawn(scene, truth.closed(scene))


def _ball(rng, contrast, radius, periodic=None):
    return Scene((1.0,) * 3, ONE, [Sphere((0.5,) * 3, radius, Material(contrast))], **_load(rng, (1.0,) * 3, periodic))


def _speck(rng):
    """A sphere down to a five-hundredth of the cell."""
    scene = _ball(rng, _contrast(rng), 10.0 ** rng.uniform(-2.7, -1))
    return Drawn(scene, truth.closed(scene))


def _copies(rng):
    """Up to twenty copies of a sphere in its cube, in boxes up to 1:20, of other lengths."""
    counts = rng.permutation([(1, 1, 20), (1, 1, 5), (1, 4, 5), (2, 2, 2), (1, 2, 10)][rng.integers(5)])
    one = _ball(rng, _contrast(rng), rng.uniform(0.1, 0.45), periodic=True)
    edge, ball = 10.0 ** rng.uniform(-6, 3), one.inclusions[0]
    places = (np.indices(counts).reshape(3, -1).T + 0.5) * edge
    spheres = [Sphere(place, ball.radius * edge, ball.material) for place in places]
    size = counts * edge
    return Drawn(Scene(size, ONE, spheres, **_load(rng, size)), truth.closed(one))


def _coat(rng):
    """A coated sphere that its matrix does not notice, the coat down to a thousandth of the radius."""
    core, shell = 10.0 ** rng.uniform(-3, 3, 2)
    inner = 1 - 10.0 ** rng.uniform(-3, -0.5)
    load = {"periodic": bool(rng.random() < 0.5), "axis": int(rng.integers(3))}
    scene = gallery.coated_sphere(core, shell, radius=rng.uniform(0.2, 0.45), core_fraction=inner**3, edge=1.0, **load)
    return Drawn(scene, truth.closed(scene))


def _stretched(rng):
    """Sides of a box, one or two of them up to twenty times the others."""
    size = np.ones(3)
    size[rng.permutation(3)[: rng.integers(3)]] = 20.0 ** -rng.uniform(0, 1)
    return size


def _layers(rng):
    """One to three layers down to a ten-thousandth of the box."""
    size, axis, count = _stretched(rng), int(rng.integers(3)), int(rng.integers(1, 4))
    ends = np.cumsum(10.0 ** rng.uniform(-4, 0, 2 * count + 1))
    ends *= size[axis] / ends[-1]
    layers = [Layer(axis, a, b, Material(_contrast(rng))) for a, b in zip(ends[:-1:2], ends[1::2], strict=True)]
    scene = Scene(size, ONE, layers, **_load(rng, size))
    return Drawn(scene, truth.closed(scene))


def _fibre_scene(rng, make):
    """A fibre in the middle of a square, told by `make` from its radius, direction and material."""
    axis, radius, material = int(rng.integers(3)), rng.uniform(0.05, 0.48), Material(_contrast(rng))
    size = np.ones(3)
    size[axis] = rng.uniform(0.2, 1.0)
    load = _load(rng, size, across=axis if rng.random() < 0.8 else None)
    same = Scene(size, ONE, [Cylinder(size / 2, radius, np.eye(3)[axis], material)], **load)
    return Drawn(replace(same, inclusions=[make(same.inclusions[0])]), truth.closed(same))


def _fibre(rng):
    """Fibres from thin to nearly touching, mostly across."""
    return _fibre_scene(rng, lambda plain: plain)


def _square(rng, contrast):
    """Square rods on a quarter of the area, across."""
    axis = int(rng.integers(3))
    size, sides = np.ones(3), np.full(3, 0.5)
    size[axis] = sides[axis] = rng.uniform(0.1, 0.5)
    return axis, size, sides, Material(contrast)


def _rod(rng):
    """Square rods from one box."""
    axis, size, sides, material = _square(rng, _contrast(rng))
    scene = Scene(size, ONE, [Box(size / 2, sides, material)], **_load(rng, size, across=axis))
    return Drawn(scene, truth.number(square_rods(material.conductivity), "Obnosov's rods"))


def _board(rng):
    """Checkerboards of two boxes, or of one on its edge: four edges meet."""
    axis, size, sides, material = _square(rng, _contrast(rng, BOARD))
    load = _load(rng, size, across=axis)
    middles = [np.where(np.arange(3) == axis, size / 2, 0.25 + 0.5 * k) for k in range(2)]
    boxes = [Box(middle, sides, material) for middle in middles]
    if rng.random() < 0.5:
        sides[np.arange(3) != axis] = math.sqrt(0.5)
        boxes = [Box(size / 2, sides, material, rotation=math.pi / 4 * np.eye(3)[axis])]
    return Drawn(Scene(size, ONE, boxes, **load), truth.number(checkerboard(material.conductivity), "self-duality"))


def _plate(rng):
    """A box from face to face, down to a hundredth of the cell: a layer."""
    size, axis, material = _stretched(rng), int(rng.integers(3)), Material(_contrast(rng))
    thickness = size[axis] * 10.0 ** rng.uniform(-2, -0.3)
    middle = np.where(np.arange(3) == axis, rng.uniform(0.5 * thickness, size[axis] - 0.5 * thickness), size / 2)
    layer = Layer(axis, middle[axis] - thickness / 2, middle[axis] + thickness / 2, material)
    same = Scene(size, ONE, [layer], **_load(rng, size))
    plate = Box(middle, np.where(np.arange(3) == axis, thickness, size), material)
    return Drawn(replace(same, inclusions=[plate]), truth.closed(same))


def _dual(rng):
    """Rods of any sides, up to 1:20, across, and their duals: the other contrast, the other direction."""
    axis, size, sides, material = _square(rng, _contrast(rng, 3.0))
    across = np.delete(np.arange(3), axis)
    sides[across] = rng.permutation([rng.uniform(0.3, 0.95), 10.0 ** rng.uniform(-1.3, -0.1)])
    one, other = (gallery.loaded(size, axis=int(along)) for along in rng.permutation(across))
    scene = Scene(size, ONE, [Box(size / 2, sides, material)], **one)
    return Drawn(scene, None, Scene(size, ONE, [Box(size / 2, sides, Material(1 / material.conductivity))], **other))


def _union(rng):
    """Overlapping shapes that are one simple shape as a whole: rods of two boxes, fibres and balls with others in."""
    kind = rng.integers(3)
    if kind == 0:
        axis, size, sides, material = _square(rng, _contrast(rng))
        along = int(rng.choice([each for each in range(3) if each != axis]))
        parts = []
        for end in (-1, 1):
            part, middle = sides.copy(), size / 2
            part[along] *= 0.7
            middle[along] += end * 0.5 * (sides[along] - part[along])
            parts.append(Box(middle, part, material))
        scene = Scene(size, ONE, [Union(parts, material)], **_load(rng, size, across=axis))
        return Drawn(scene, truth.number(square_rods(material.conductivity), "Obnosov's rods"))
    if kind == 1:

        def twice(plain):
            aside = np.array(plain.center) + 0.1 * plain.radius * np.roll(plain.axis, 1)
            return Union([plain, Cylinder(aside, 0.8 * plain.radius, plain.axis, plain.material)], plain.material)

        return _fibre_scene(rng, twice)
    one = _ball(rng, _contrast(rng), rng.uniform(0.1, 0.47))
    ball = one.inclusions[0]
    inner = Box(ball.center, (ball.radius,) * 3, ball.material, rotation=rng.normal(size=3))
    return Drawn(replace(one, inclusions=[Union([ball, inner], ball.material)]), truth.closed(one))


def _level(rng):
    """A ball told by a function of any legitimate kind."""
    one, form = _ball(rng, _contrast(rng), rng.uniform(0.1, 0.45)), LEVELS[str(rng.choice(list(LEVELS)))]
    ball = one.inclusions[0]

    def function(points):
        return form(np.linalg.norm(points - 0.5, axis=1), ball.radius)

    body = LevelSet(function, ((0.01,) * 3, (0.99,) * 3), ball.material)
    return Drawn(replace(one, inclusions=[body]), truth.closed(one))


def _image(rng):
    """Images whose conductivity is known: layers, square rods, checkerboards of blocks; a few voxels deep."""
    axis, block = int(rng.integers(3)), int(rng.integers(2, 9))
    form = ("layers", "rods", "board")[rng.integers(3)]
    s, x = _contrast(rng, BOARD if form == "board" else DECADES), np.arange(4 * block) // block
    if form == "layers":
        plane, found = (x == 1)[:, None] & np.ones(len(x), bool), None
    elif form == "rods":
        plane, found = np.logical_and.outer(*(np.isin(x, (1, 2)),) * 2), square_rods(s)
    else:
        plane, found = (x[:, None] // 2 + x[None] // 2) % 2 == 1, checkerboard(s)
    labels = np.moveaxis(np.repeat(plane[:, :, None], int(rng.integers(3, 9)), axis=2), 2, axis)
    image = Image(labels.astype(np.uint8), 1.0 / len(x), {0: ONE, 1: Material(s)})
    scene = Scene.of_image(image, **_load(rng, image.size, across=axis))
    if found is None:
        found = 1 / (0.75 + 0.25 / s) if truth.axis_of(scene) == (axis == 0) else 0.75 + 0.25 * s
    return Drawn(scene, truth.number(float(found), "exact of an image"))


def _spheres(kind):
    """At random, as other studies draw them, with other seeds."""

    def draw(rng):
        scene = drawn.scene_of(kind, int(rng.integers(10**6, 10**9)))
        return Drawn(scene, truth.multipoles(scene))

    return draw


def _small(rng):
    """Needles and discs up to 1:20, far apart: known to the first order of their volume."""
    longest, aspect, contrast = 10.0 ** rng.uniform(-1.7, -0.9), 20.0 ** rng.uniform(0.1, 1), _contrast(rng)
    axes = np.full(3, longest / aspect)
    axes[rng.permutation(3)[: rng.integers(1, 3)]] = longest
    scene = Scene((1.0,) * 3, ONE, [Ellipsoid((0.5,) * 3, axes, Material(contrast))], **_load(rng, (1.0,) * 3))
    return Drawn(scene, truth.few(scene, contrast, axes))


def _half(rng):
    """Half-spaces that end where layers do."""
    size, axis, material = _stretched(rng), int(rng.integers(3)), Material(_contrast(rng))
    place = size[axis] * rng.uniform(0.02, 0.98)
    half = HalfSpace(np.where(np.arange(3) == axis, place, size / 2), np.eye(3)[axis], material)
    same = Scene(size, ONE, [Layer(axis, 0.0, place, material)], **_load(rng, size, periodic=False))
    return Drawn(replace(same, inclusions=[half]), truth.closed(same))


def _body(rng):
    """What has no closed form: turned ellipsoids and boxes, rods with ends, merged balls, inclined planes."""
    material, turn, middle = Material(_contrast(rng, MILD)), rng.normal(size=3), np.full(3, 0.5)
    kind = rng.integers(5)
    if kind == 0:
        body = Ellipsoid(middle, rng.uniform(0.1, 0.45, 3), material, rotation=turn)
    elif kind == 1:
        body = Box(middle, rng.uniform(0.1, 0.5, 3), material, rotation=turn)
    elif kind == 2:
        body = Cylinder(middle, rng.uniform(0.05, 0.25), turn, material, length=rng.uniform(0.2, 0.7))
    elif kind == 3:
        radii, way = rng.uniform(0.15, 0.25, 2), turn / np.linalg.norm(turn)
        balls = [Sphere(middle + end * 0.12 * way, r, material) for end, r in zip((-1, 1), radii, strict=True)]
        body = Union(balls, material)
    else:
        body = HalfSpace(middle, turn, material)
    scene = Scene((1.0,) * 3, ONE, [body], **_load(rng, (1.0,) * 3, periodic=False if kind == 4 else None))
    return Drawn(scene, truth.finer(scene))


def _satellites(rng):
    """A large sphere with one to twelve small ones about it, 3 to 20 times smaller, gaps down to a third of theirs."""
    count, core, others = int(rng.integers(1, 13)), _contrast(rng), _contrast(rng)
    ratio, gap = 10.0 ** rng.uniform(0.5, 1.3), 10.0 ** rng.uniform(-0.5, 0.5)
    small = rng.uniform(0.3, 0.48) / (ratio + 2 + gap)
    large, away = ratio * small, (ratio + 1 + gap) * small
    ways: list[np.ndarray] = []
    for way in rng.normal(size=(200, 3)):
        way /= np.linalg.norm(way)
        if len(ways) < count and all(away * np.linalg.norm(way - other) > 2.2 * small for other in ways):
            ways.append(way)
    spheres = [Sphere((0.5,) * 3, large, Material(core))]
    spheres += [Sphere(0.5 + away * way, small, Material(others)) for way in ways]
    scene = Scene((1.0,) * 3, ONE, spheres, **_load(rng, (1.0,) * 3, periodic=True))
    return Drawn(scene, truth.finer_multipoles(scene))


DRAW = {
    "array": _array, "speck": _speck, "copies": _copies, "coat": _coat, "layers": _layers, "fibre": _fibre,
    "rod": _rod, "board": _board, "plate": _plate, "dual": _dual, "union": _union, "level set": _level,
    "image": _image, "spheres": _spheres("spheres, periodic"), "spheres, walls": _spheres("spheres, walls"),
    "polydisperse": _spheres("polydisperse"), "needles, discs": _small, "half-space": _half, "bodies": _body,
    "satellites": _satellites,
}  # fmt: skip
KINDS = tuple(DRAW)


def scene_of(kind: str, seed: int) -> Drawn:
    """What a kind draws by a seed, the same at every call."""
    return DRAW[kind](np.random.default_rng([seed, KINDS.index(kind), 36]))
