"""Changes of a scene after which its solution is known from that before: moved, turned, mirrored, doubled, other units.

Nothing here knows a right value, or a method.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np
from drawn_scenes import HIGH, LOW

from demheat import Layer, Scene, Sphere


class Image(NamedTuple):
    """Another scene, and its solution by that of the first: q' = flux turn q and, but for a level, T' = warmth T.

    Attributes
    ----------
    scene : Scene
    points : callable (n, 3) float array, m -> (n, 3) float array, m
        Where the points of the first scene lie in this one.
    turn : (3, 3) float array
    warmth, flux, conductivity : float
    level : float, K
        Of a box with walls; that of a periodic cell is free.
    mean : (3, 3) float array, optional
        What turns the mean flux, if not `turn`: of two cells the mean of both.
    cells : int
        Copies of the first scene that it holds.
    in_time : bool
        It is the end of a transient.
    """

    scene: Scene
    points: Callable = np.array
    turn: np.ndarray = np.eye(3)
    warmth: float = 1.0
    level: float = 0.0
    flux: float = 1.0
    conductivity: float = 1.0
    mean: np.ndarray | None = None
    cells: int = 1
    in_time: bool = False

    @property
    def mean_turn(self):
        return self.turn if self.mean is None else self.mean

    @property
    def capacity(self):
        """Heat capacity of a volume by which heat takes as long to settle: conductivity over the square of a length."""
        return (self.flux / self.warmth) ** 2 / self.conductivity


class Relation(NamedTuple):
    """How a scene is changed, and whose discretisation changes with it."""

    image: Callable  # callable (scene, rng) -> Image or None: None of scenes that it says nothing of
    words: str
    # {"all", "but meshes", "grids", "none"}: Whose elements go with the scene, so that it is exact: those of all
    # methods; of all but unstructured meshes, whose making magnifies rounding; of those that are no random packing
    # either; or of those that have no elements
    kept_by: str


def _load_of(scene):
    return {"gradient": scene.gradient} if scene.periodic else {"walls": dict(scene.walls)}


def _turned(scene, order, flips):
    """Axes order[0], order[1], order[2] become axes 0, 1, 2; then those of flips are mirrored."""
    size = np.array(scene.size)[list(order)]
    matrix = np.eye(3)[list(order)] * np.where(flips, -1.0, 1.0)[:, None]
    inclusions = [_mirrored(each.turned(order), size, flips) for each in scene.inclusions]
    if scene.periodic:
        load = {"gradient": tuple(matrix @ scene.gradient)}
    else:
        load = {"walls": {_wall(name, order, flips): value for name, value in scene.walls.items()}}
    offset = np.where(flips, size, 0.0)
    return Image(Scene(size, scene.matrix, inclusions, **load), lambda points: points @ matrix.T + offset, matrix)


def _mirrored(shape, size, flips):
    if isinstance(shape, Layer):
        length = size[shape.axis]
        return replace(shape, start=length - shape.stop, stop=length - shape.start) if flips[shape.axis] else shape
    return replace(shape, center=np.where(flips, size - shape.center, shape.center))


def _wall(name, order, flips):
    axis = list(order).index("xyz".index(name[0]))
    return "xyz"[axis] + ("+-" if flips[axis] else "-+")["-+".index(name[1])]


def _rotated(scene, rng):
    """Draw one of the 23 rotations by right angles that move something."""
    while True:
        order, flips = rng.permutation(3), rng.random(3) < 0.5
        matrix = np.eye(3)[order] * np.where(flips, -1.0, 1.0)[:, None]
        if np.linalg.det(matrix) > 0 and np.trace(matrix) < 3:
            return _turned(scene, order.tolist(), flips)


def _reflected(scene, rng):
    return _turned(scene, (0, 1, 2), np.arange(3) == rng.integers(3))


def _shifted(scene, shifts):
    """Move all inclusions of a periodic cell by the first of some vectors that lets no face cut a layer."""
    size = np.array(scene.size)
    for shift in shifts:
        moved = [_moved(each, shift, size) for each in scene.inclusions]
        if all(isinstance(each, Sphere) or each.stop <= size[each.axis] for each in moved):
            return Image(replace(scene, inclusions=moved), partial(np.add, shift))
    raise AssertionError("every shift cuts a layer")


def _moved(shape, shift, size):
    if isinstance(shape, Sphere):
        return replace(shape, center=(shape.center + shift) % size)
    start = (shape.start + shift[shape.axis]) % size[shape.axis]
    return replace(shape, start=start, stop=start + shape.stop - shape.start)


def _translated(scene, rng):
    return _shifted(scene, rng.random((1000, 3)) * scene.size) if scene.periodic else None


def _translated_by_quarters(scene, rng):
    if not scene.periodic:
        return None
    steps = np.stack(np.unravel_index(1 + rng.permutation(63), (4, 4, 4)), axis=1)
    return _shifted(scene, steps / 4 * scene.size)


def _units(scene, rng):
    """Lengths and conductivities times powers of ten, the extremes among them; temperatures stay."""
    metre, watt = 10.0 ** rng.choice([-9, 9, rng.uniform(-9, 9)], 2)
    inclusions = [replace(_scaled(each, metre), material=_times(each.material, watt)) for each in scene.inclusions]
    load = {"gradient": tuple(np.array(scene.gradient) / metre)} if scene.periodic else _load_of(scene)
    other = Scene(np.array(scene.size) * metre, _times(scene.matrix, watt), inclusions, **load)
    return Image(other, lambda points: points * metre, flux=watt / metre, conductivity=watt)


def _scaled(shape, factor):
    if isinstance(shape, Layer):
        return replace(shape, start=shape.start * factor, stop=shape.stop * factor)
    return replace(shape, center=np.array(shape.center) * factor, radius=shape.radius * factor)


def _times(material, factor):
    return replace(material, conductivity=material.conductivity * factor)


def _reordered(scene, rng):
    """Another order of inclusions; those painted on others stay behind them."""
    depth, parents = np.zeros(len(scene.inclusions) + 1), scene.parents()
    for number in range(1, len(depth)):
        depth[number] = depth[parents[number]] + 1
    order = np.lexsort((rng.random(len(depth) - 1), depth[1:]))
    if np.array_equal(order, np.arange(len(order))):
        order = np.lexsort((-np.arange(len(order)), depth[1:]))
    if np.array_equal(order, np.arange(len(order))):
        return None
    return Image(replace(scene, inclusions=[scene.inclusions[k] for k in order]))


def _swapped(scene, rng):
    """The cold wall warm and the warm one cold."""
    if scene.periodic:
        return None
    walls = {name: LOW + HIGH - value for name, value in scene.walls.items()}
    return Image(replace(scene, walls=walls), warmth=-1.0, level=LOW + HIGH, flux=-1.0)


def _loaded(scene, rng):
    """A load of another size and, half of the time, of the other sign; walls have another level too."""
    factor = rng.choice([-1, 1]) * 10 ** rng.uniform(-3, 3)
    if scene.periodic:
        other = replace(scene, gradient=tuple(factor * np.array(scene.gradient)))
        return Image(other, warmth=factor, flux=factor)
    level = 100 * factor * rng.normal()
    other = replace(scene, walls={name: factor * value + level for name, value in scene.walls.items()})
    return Image(other, warmth=factor, level=level, flux=factor)


def _doubled(scene, rng):
    """Two cells side by side, or a box and its mirror image in an insulated side; the second is looked at."""
    axis = int(rng.integers(3)) if scene.periodic else _free_axis(scene, rng)
    if axis is None:
        return None
    size, beside = np.array(scene.size), np.eye(3)[axis] * scene.size
    if scene.periodic:
        second, turn = [_beside(each, axis, beside) for each in scene.inclusions], np.eye(3)
        points = partial(np.add, beside)
    else:
        flips = np.arange(3) == axis
        second = [_beside(_mirrored(each, size, flips), axis, beside) for each in scene.inclusions]
        turn = np.diag(np.where(flips, -1.0, 1.0))
        points = lambda x: np.where(flips, 2 * size - x, x)  # noqa: E731
    inclusions = [*scene.inclusions, *(each for each in second if each is not None)]
    other = Scene(size + beside, scene.matrix, inclusions, **_load_of(scene))
    return Image(other, points, turn, mean=(np.eye(3) + turn) / 2, cells=2)


def _free_axis(scene, rng):
    """An axis without load whose sides cut no sphere."""
    spheres = [each for each in scene.inclusions if not isinstance(each, Layer)]
    ends = [(np.subtract(s.center, s.radius), np.add(s.center, s.radius)) for s in spheres]
    free = [a for a in range(3) if all(low[a] >= 0 and high[a] <= scene.size[a] for low, high in ends)]
    free = [axis for axis in free if axis != scene.axis]
    return int(rng.choice(free)) if free else None


def _beside(shape, axis, offset):
    if not isinstance(shape, Layer):
        return replace(shape, center=np.array(shape.center) + offset)
    # One that goes on through both is there already.
    if shape.axis != axis:
        return None
    return replace(shape, start=shape.start + offset[axis], stop=shape.stop + offset[axis])


def _in_time(scene, rng):
    return None if scene.periodic else Image(scene, in_time=True)


RELATIONS = {
    "units": Relation(_units, "lengths and conductivities times 1e-9 to 1e9", "but meshes"),
    "load": Relation(_loaded, "the load times a factor of either sign", "all"),
    "walls": Relation(_swapped, "temperatures of the two walls swapped", "all"),
    "time": Relation(_in_time, "the end of a transient", "all"),
    "rotation": Relation(_rotated, "turned by right angles", "grids"),
    "reflection": Relation(_reflected, "mirrored", "grids"),
    "quarters": Relation(_translated_by_quarters, "moved by quarters of the cell", "grids"),
    "order": Relation(_reordered, "inclusions in another order", "grids"),
    "union": Relation(_doubled, "two side by side", "grids"),
    "translation": Relation(_translated, "moved by any vector", "none"),
}
