"""What a scene is checked for as it is made: inclusions and where they lie, body, load, sources, initial state."""

from collections.abc import Mapping, Sequence

import numpy as np

from demheat.scene.bodies import ROUND_AXES, check_name, from_middle, round_radius, wall_names
from demheat.scene.crossing import touching
from demheat.scene.frozen import ReadOnly
from demheat.scene.image import Image
from demheat.scene.inputs import LEAST, MOST, finite, moderate, vector
from demheat.scene.parts import HOTTEST, Convection, Flux, MovingCylinder, Radiation, UniformSource, driver
from demheat.scene.shapes import Shape
from demheat.scene.shapes.base import TOUCH
from demheat.scene.shapes.pairs import check_pairs

# Differences of walls' temperatures over the largest. Where a law holds centres at a wall's temperature, results were
# found right to 1e-4 at 3e-9 and halved at 3e-12; from 1e-15 on the DEM gave 0.
RESOLVED = 1e-10
KELVIN = f"a temperature >= 0 K of at most {HOTTEST:g}"


def checked_inclusions(inclusions) -> tuple[Shape, ...]:
    """A sequence of shapes as a tuple, or a ValueError."""
    if not isinstance(inclusions, Sequence):
        raise ValueError(f"Scene.inclusions = {inclusions!r}: must be a sequence of Sphere or Layer, or other Shapes")
    for number, inclusion in enumerate(inclusions):
        if not isinstance(inclusion, Shape):
            raise ValueError(
                f"Scene.inclusions[{number}] = {inclusion!r}: must be a Sphere or a Layer, or another Shape"
            )
    return tuple(inclusions)


def check_domain(scene) -> None:
    """Raise ValueError unless the domain of a Scene is known and its box square across the round axes."""
    check_name("Scene.domain", scene.domain)
    across = [scene.size[axis] for axis in ROUND_AXES[scene.domain]]
    if across and max(across) > min(across):
        raise ValueError(f"Scene.size = {scene.size} of a {scene.domain}: sides across its round axes must be equal")
    if across and scene.gradient is not None:
        raise ValueError(f"Scene.gradient with domain = {scene.domain!r}: only a box can be a periodic cell")


def check_dependence(scene) -> None:
    """Raise ValueError if a conductivity of a periodic Scene depends on temperature."""
    if scene.periodic and scene.varies:
        which = next(n for n, material in enumerate(scene.materials) if material.dependence is not None)
        raise ValueError(
            f"Material.dependence in phase {which} with Scene.gradient: must be None, as temperatures of a "
            "periodic cell have no level; give Scene.walls instead"
        )


def check_perfect(scene) -> None:
    """Raise ValueError if nothing in a Scene has a finite conductivity."""
    if all(material.perfect for material in scene.materials):
        raise ValueError(
            f"Material.conductivity = {scene.matrix.conductivity} in all phases of a Scene: must be finite in one at "
            "least"
        )


def check_image(scene) -> None:
    """Raise ValueError unless the image of a Scene, if it has one, is all of it."""
    image = scene.image
    if image is None:
        return
    if not isinstance(image, Image):
        raise ValueError(f"Scene.image of type {type(image).__name__}: must be an Image or None")
    if scene.inclusions or scene.domain != "box":
        what = "inclusions" if scene.inclusions else f"domain = {scene.domain!r}"
        raise ValueError(f"Scene.{what}: with an image, which is all of a box; must be left out")
    if scene.size != image.size or scene.matrix != image.phases[0]:
        raise ValueError(
            f"Scene.size = {scene.size}, Scene.matrix = {scene.matrix}: must be those of the image, {image.size} and "
            f"{image.phases[0]}; Scene.of_image gives them"
        )


def checked_load(scene) -> dict[str, object]:
    """The one load of a Scene, as {"gradient": tuple} or {"walls": dict}, or a ValueError."""
    transient = scene.initial is not None
    both = scene.gradient is not None and scene.walls is not None
    if both or (scene.gradient is None and scene.walls is None and not transient):
        raise ValueError(
            f"Scene.gradient, Scene.walls: {'both' if both else 'neither'} given; a scene needs exactly one load: a "
            "mean gradient (periodic cell) or at least one wall with a temperature or Flux"
        )
    if scene.gradient is not None:
        gradient = vector("Scene.gradient", scene.gradient)
        if not any(gradient):
            raise ValueError(f"Scene.gradient = {scene.gradient!r}: must not be zero")
        if not moderate(max(map(abs, gradient))):
            raise ValueError(f"Scene.gradient = {scene.gradient!r}: must be from {LEAST:g} to {MOST:g} K/m")
        return {"gradient": gradient}
    walls = {} if scene.walls is None else scene.walls
    _check_walls(walls, wall_names(scene.domain), or_none=transient)
    return {"walls": ReadOnly(walls)}


def _check_walls(walls, valid, *, or_none):
    if not isinstance(walls, Mapping) or not (walls or or_none):
        raise ValueError(f"Scene.walls = {walls!r}: must map at least one of {', '.join(valid)} to a load")
    for name, value in walls.items():
        if name not in valid:
            raise ValueError(f"Scene.walls: unknown wall {name!r}; must be one of {', '.join(valid)}")
        if not isinstance(value, Flux | Convection | Radiation) and not callable(value):
            numbers = f"a finite temperature of at most {MOST:g}, a function of time, Flux, Convection or Radiation"
            finite(f"Scene.walls[{name!r}]", value, numbers, lambda v: abs(v) <= MOST)
    if any(isinstance(value, Radiation) for value in walls.values()):
        for name, value in _held(walls).items():
            finite(f"Scene.walls[{name!r}], with a wall that radiates,", value, KELVIN, _absolute)
    # In time the body itself may differ from walls that are nearly alike.
    if not or_none:
        check_differences(walls)


def _held(walls):
    imposed = {name: driver(value) for name, value in walls.items() if not isinstance(value, Flux)}
    return {name: float(value) for name, value in imposed.items() if not callable(value)}


def check_differences(walls) -> None:
    """Raise ValueError where heat flows in a steady state between temperatures of which rounding leaves little."""
    held = list(_held(walls).values())
    span, largest = max(held, default=0.0) - min(held, default=0.0), max(map(abs, held), default=0.0)
    if 0 < span < max(LEAST, RESOLVED * largest):
        raise ValueError(
            f"Scene.walls = {dict(walls)}: rounding leaves little of a difference of {span:.3g}; temperatures must be "
            f"the same, or differ by {RESOLVED:g} of the largest"
        )


def check_initial(initial, *, kelvin=False) -> None:
    """Raise ValueError unless an initial temperature is None, a finite number or callable."""
    if initial is not None and not callable(initial):
        valid = f"a finite temperature of at most {MOST:g}, or a function of points"
        finite("Scene.initial", initial, valid, lambda v: abs(v) <= MOST)
        if kelvin:
            finite("Scene.initial, with a wall that radiates,", initial, KELVIN, _absolute)


def _absolute(value):
    return 0 <= value <= HOTTEST


def checked_sources(sources) -> tuple[UniformSource | MovingCylinder, ...]:
    """A sequence of heat sources as a tuple, or a ValueError."""
    if not isinstance(sources, Sequence) or not all(isinstance(s, UniformSource | MovingCylinder) for s in sources):
        raise ValueError(f"Scene.sources = {sources!r}: must be a sequence of UniformSource or MovingCylinder")
    return tuple(sources)


def check_geometry(scene) -> None:
    """Raise ValueError unless the inclusions of a Scene fit its box, and are disjoint, touching or nested."""
    size = np.array(scene.size)
    for number, shape in enumerate(scene.inclusions):
        shape.check_fit(f"Scene.inclusions[{number}]", scene.size, periodic=scene.periodic)
        if shape.flat:
            continue
        low, high = shape.bounds()
        limit = size if scene.periodic else np.full(3, np.inf) if shape.overhangs else _widest(low, high, size)
        for axis in np.flatnonzero(np.isfinite(high - low) & (high - low > limit * (1 + TOUCH))):
            raise ValueError(
                f"Scene.inclusions[{number}]: {shape.kind} of diameter {(high - low)[axis]:.6g} is larger than the "
                f"box; must be <= {limit[axis]} m"
            )
        if not scene.periodic and not shape.meets(scene.size):
            raise ValueError(f"Scene.inclusions[{number}]: {shape} lies outside the box {scene.size}")
        if ROUND_AXES[scene.domain] and _beyond_round_wall(shape, scene):
            raise ValueError(f"Scene.inclusions[{number}]: {shape} lies outside the {scene.domain} in {scene.size}")
    check_pairs(scene.inclusions, scene.size, periodic=scene.periodic)


def _widest(low, high, size):
    """How wide a shape may be along each axis: twice as much where a wall leaves half of it or less, at its mirror."""
    middle, slack = (low + high) / 2, TOUCH * size.max()
    return size.max() * np.where((middle <= slack) | (middle >= size - slack), 2, 1)


def check_reached(scene) -> None:
    """Raise ValueError if a clipped source of a Scene never meets the body: it would heat nothing."""
    for number, source in enumerate(scene.sources):
        through = isinstance(source, MovingCylinder) and scene.domain in ("box", "cylinder-" + "xyz"[source.axis])
        if through and source.clip:
            between = touching(source, scene.size, scene.domain)
            if between is None or between[1] < 0:
                raise ValueError(
                    f"Scene.sources[{number}] = {source}: after time 0 never meets the {scene.domain} of size "
                    f"{scene.size} and heats nothing; must cross it, or be left out"
                )


def _beyond_round_wall(shape, scene):
    center, radius = shape.ball()
    return bool(from_middle(center, scene.domain, scene.size) >= round_radius(scene.domain, scene.size) + radius)
