"""What has to be solved for the conductivity tensor of a body: as few loads as it has unlike axes, on its part."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

from demheat.cheapest.measures import Measures, measures
from demheat.scene import Scene
from demheat.scene.symmetry import alike_axes, mirrors, reduced
from demheat.tensor import axis_loads


@dataclass(frozen=True)
class Loads:
    """Loads that show a body's tensor."""

    # wholes, parts: mapping of int to Scene: The body under a load along each axis that counts, and what its mirror
    # planes leave of it
    wholes: Mapping[int, Scene]
    parts: Mapping[int, Scene]
    alike: tuple[int, int, int]  # (3,) tuple of int: For each axis the one that conducts like it
    diagonal: bool  # Whether symmetry leaves nothing beside the diagonal
    saved: tuple[str, ...]  # tuple of str: What was saved, in words

    @property
    def body(self) -> Scene:
        """The body under one of the loads."""
        return next(iter(self.wholes.values()))

    @property
    def largest(self) -> Scene:
        """The largest of the parts."""
        return max(self.parts.values(), key=lambda each: each.volume)

    @cached_property
    def of_body(self) -> Measures:
        """Measures of the body, which no load changes."""
        return measures(self.body)

    @cached_property
    def of_largest(self) -> Measures:
        """Measures of the largest part."""
        return self.of_body if self.parts is self.wholes else measures(self.largest)

    @property
    def together(self) -> bool:
        """Whether three loads act on one body, so that one set-up does for all."""
        if len(self.parts) < 3:
            return False
        first, *others = ((part.size, part.inclusions, part.periodic) for part in self.parts.values())
        return all(other == first for other in others)


def loads_of(scene: Scene) -> Loads:
    """Loads that show the tensor of a scene's body."""
    wholes = dict(enumerate(axis_loads(scene)))
    if not scene.periodic and len(set(scene.wall_temperatures.values())) < 2:
        raise ValueError(f"Scene.walls = {dict(scene.walls)}: must differ in temperature, or no conductivity follows")
    # Symmetry is known of shapes whose conductivities are numbers.
    if scene.image is not None or scene.anisotropic or scene.varies:
        return Loads(wholes, wholes, (0, 1, 2), not scene.periodic, ())
    planes = [plane is not None for plane in mirrors(scene)]
    diagonal = not scene.periodic or sum(planes) >= 2
    if not diagonal:
        return Loads(wholes, wholes, (0, 1, 2), False, ())
    alike = alike_axes(scene)
    wholes = {axis: wholes[axis] for axis in sorted(set(alike))}
    cut = {axis: reduced(whole) for axis, whole in wholes.items()}
    saved = _words(len(wholes), max(_times(each) for each in cut.values()))
    return Loads(wholes, {axis: _plain(each) for axis, each in cut.items()}, alike, True, saved)


def _times(part):
    return part.factors[0] * part.factors[1] * part.factors[2]


def _plain(part):
    """The part; one that was cut out of a periodic cell with temperatures that any body may have."""
    if part.scene is part.whole or not part.whole.periodic:
        return part.scene
    axis = "xyz"[part.scene.axis]
    return replace(part.scene, walls={axis + "-": 0.0, axis + "+": 1.0})


def _words(count, times):
    found = []
    if count < 3:
        found.append(f"{count} of 3 loads: axes alike")
    if times > 1:
        found.append(f"1/{times} of the body: mirror planes")
    return tuple(found)
