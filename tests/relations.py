"""Relations between two scenes whose solutions follow from each other, and how far a method's solutions are from that.

Nothing here knows a right value: a scene is moved, turned, mirrored, measured in other units, told in another order,
doubled, or loaded otherwise, and the method is asked again.
"""

import inspect
from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from typing import NamedTuple

import numpy as np
from drawn_scenes import HIGH, LOW, drawn, kind
from method_scenes import METHODS, Estimated, answered, asked, resting

from demheat import Layer, Scene, Sphere, referee
from demheat.method import DEGREE
from studies.harness import methods

# Points at which two fields are compared.
POINTS = 60
# In time all is at rest after so many seconds: of 1 J/(m3 K) behind layers a hundredth as conducting as the matrix.
AT_REST, ACCURACY = 1e4, 1e-3
# Closed forms and formulas: sums of some hundred rounded numbers.
ROUNDING = 1e-12
# Solvers' tolerances at that resolution, 1e-9 or 1e-11, times the condition of the equations; as in `test_methods`.
IDENTITY = 1e-7
# Two solutions on unlike elements, each within its own error. That declared is of contrast 10; at 100 it is up to twice
# as large, but with arithmetic means at interfaces, which grow with the contrast itself, ten times.
APART, ARITHMETIC = 4.0, 20.0


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


class Relation(NamedTuple):
    """How a scene is changed, and whose discretisation changes with it.

    Attributes
    ----------
    image : callable (scene, rng) -> Image or None
        None of scenes that it says nothing of.
    words : str
    kept_by : {"all", "but meshes", "grids", "none"}
        Whose elements go with the scene, so that it is exact: those of all methods; of all but unstructured meshes,
        whose making magnifies rounding; of those that are no random packing either; or of those that have no elements.
    """

    image: Callable
    words: str
    kept_by: str


class Spread(NamedTuple):
    """Differences between two solutions of which one follows from the other.

    Attributes
    ----------
    conductivity : float
        Size of the difference of mean fluxes over that of the mean flux.
    temperature : float
        Root mean square over the imposed span; not-a-number of what knows the conductivity alone.
    flux : float
        Root mean square over the mean flux; as the temperature.
    """

    conductivity: float
    temperature: float = np.nan
    flux: float = np.nan


# Changes of scenes


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


# What methods answer


def exact(method, relation):
    """Whether a relation is to hold to rounding and the solver's tolerance, by what the method declares."""
    if method.resolution in (None, DEGREE):
        return True
    turns = "rotation" not in method.exceptions
    kept = {"all": True, "but meshes": turns or method.resolution.seeded, "grids": turns, "none": False}
    return kept[RELATIONS[relation].kept_by]


def limit(method, relation, part):
    """Largest spread that a method may have.

    Parameters
    ----------
    method : Method
    relation : str
        Of `RELATIONS`.
    part : str
        Of `Spread`.

    Returns
    -------
    float
    """
    if relation == "time":
        return ACCURACY
    if method.resolution is None:
        return ROUNDING
    if exact(method, relation) or method.errors is None:
        return IDENTITY
    apart = ARITHMETIC if method.knobs.get("interface") == "arithmetic" else APART
    return apart * getattr(method.errors, part)


def image_of(relation, seed):
    """The image of a drawn scene, the same at every call; None of one that the relation says nothing of."""
    return RELATIONS[relation].image(drawn(seed), np.random.default_rng([seed, 21]))


@cache
def first(name, seed):
    """The solution of a drawn scene by a method; None if it has no closed form."""
    return _known(METHODS[name], drawn(seed))


def _known(method, scene, **knobs):
    try:
        return answered(method, scene, **knobs)
    except NotImplementedError:
        if method.resolution is not None:
            raise
        return None


def applies(name, relation, seed):
    """Whether a method is asked for a relation on a drawn scene: it refuses neither of the two."""
    method, image = METHODS[name], image_of(relation, seed)
    if image is None or (image.in_time and not _evolves(method)):
        return False
    if (asked(drawn(seed)) | asked(image.scene)) & set(method.refuses):
        return False
    # Of layers a method that is not exact there declares no error.
    if kind(seed) == "layers" and "laminate" in method.exceptions and not exact(method, relation):
        return False
    # Closed forms are of fewer scenes than such words can say, and of cells, not of pairs of them.
    return method.resolution is not None or second(name, relation, seed) is not None


def _evolves(method):
    """Whether the method's module also has a transient of the same discretisation."""
    module = methods.load(method.module)
    if not hasattr(module, "evolve") or method.call != "solve":
        return False
    taken, usual = (inspect.signature(getattr(module, call)).parameters for call in ("evolve", "solve"))
    if "accuracy" not in taken:
        return False
    some = any(each.kind is each.VAR_KEYWORD for each in taken.values())
    return some or all(name in taken or usual[name].default == value for name, value in method.knobs.items())


@cache
def second(name, relation, seed):
    """The solution of an image, on elements of the size of the first's; None if either has no closed form."""
    method, image = METHODS[name], image_of(relation, seed)
    if first(name, seed) is None:
        return None
    if image.in_time:
        return _last(method, image.scene)
    return _known(method, image.scene, **_size(method, image, max(drawn(seed).size)))


def _size(method, image, edge):
    """Knobs of the same size of elements in an image of a box of an edge."""
    if image.cells == 1 or method.resolution in (None, DEGREE):
        return {}
    refined = method.resolution
    if refined.metric:
        return method.at(method.coarse, edge)
    longer = image.cells if refined.seeded else max(image.scene.size) / edge
    return {refined.knob: round(method.coarse * longer)}


def _last(method, scene):
    evolve = methods.load(method.module).evolve
    taken = inspect.signature(evolve).parameters
    some = any(each.kind is each.VAR_KEYWORD for each in taken.values())
    knobs = {name: value for name, value in method.knobs.items() if some or name in taken}
    knobs |= {name: value for name, value in method.tight.items() if name in taken}
    *_, last = evolve(
        resting(scene), (AT_REST,), **knobs, **method.at(method.coarse, max(scene.size)), accuracy=ACCURACY
    )
    return last


def _mean_flux(field, image):
    """The mean flux; of what came to rest in time that through the walls, as a transient's mean is another number."""
    if not image.in_time:
        return field.mean_flux
    axis = field.scene.axis
    wall = "xyz"[axis] + "-"
    return np.eye(3)[axis] * field.wall_heat[wall] * field.scene.size[axis] / field.scene.volume


def spread(name, relation, seed):
    """How far two solutions by a method are from what a relation says.

    Parameters
    ----------
    name : str
        Of a method.
    relation : str
        Of `RELATIONS`.
    seed : int
        Of a drawn scene of which `applies` is true.

    Returns
    -------
    Spread
    """
    image = image_of(relation, seed)
    one, two = first(name, seed), second(name, relation, seed)
    if isinstance(one, Estimated):
        return Spread(abs(two.conductivity / (image.conductivity * one.conductivity) - 1))
    scale = abs(image.flux) * np.linalg.norm(one.mean_flux)
    k = np.linalg.norm(_mean_flux(two, image) - image.flux * image.mean_turn @ _mean_flux(one, image)) / scale
    points = np.random.default_rng(seed).random((POINTS, 3)) * one.scene.size
    there = image.points(points)
    warmer = two.temperature_at(there) - image.warmth * one.temperature_at(points) - image.level
    warmer -= warmer.mean() if one.scene.periodic else 0.0
    span = abs(image.warmth) * referee.span(one.scene)
    more = two.flux_at(there) - image.flux * one.flux_at(points) @ image.turn.T
    rms = [float(np.sqrt(np.mean(np.sum(np.atleast_2d(v.T) ** 2, axis=0)))) for v in (warmer / span, more / scale)]
    return Spread(float(k), *rms)
