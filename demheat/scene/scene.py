"""What is computed: a box, its materials and inclusions, and one load.

A scene knows nothing of meshes, voxels or particles; every method reads the same one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import PurePath
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from demheat.scene.bodies import domain_volume
from demheat.scene.checks import (
    check_dependence,
    check_domain,
    check_geometry,
    check_image,
    check_initial,
    check_perfect,
    check_reached,
    checked_inclusions,
    checked_load,
    checked_sources,
)
from demheat.scene.dependence import Dependences
from demheat.scene.frozen import read_only, table_of
from demheat.scene.functions import load_at
from demheat.scene.image import Image
from demheat.scene.inputs import LEAST, MOST, moderate, vector
from demheat.scene.material import Material, check_material
from demheat.scene.needs import check_steady, check_transient, refusal, refusals
from demheat.scene.parts import Convection, Flux, MovingCylinder, Radiation, UniformSource, driven, driver
from demheat.scene.shapes import Shape
from demheat.scene.shapes.holders import Holders
from demheat.scene.told import told_of

# Loads of walls that have no temperature of their own.
OPEN = Flux | Convection | Radiation


@dataclass(frozen=True)
class Scene:
    """A box of matrix with inclusions painted in order, under one load; or what is inscribed in the box.

    Give either `gradient` (the box is then a periodic cell) or `walls` (faces not named are insulated). A transient
    needs `initial` besides, and may do without any wall.

    Parameters
    ----------
    size : (3,) sequence of float, m
        The box is [0, size[0]] x [0, size[1]] x [0, size[2]].
    matrix : Material
    inclusions : sequence of Sphere, Layer or another Shape
        Disjoint, touching or fully nested (outer first). In a periodic cell a sphere may cross a face, its image
        comes in on the other side; in a walled box the wall cuts it.
    gradient : (3,) sequence of float, K/m, optional
        Mean temperature gradient of the periodic cell.
    walls : mapping of str to float, callable (time, s) -> float, Flux, Convection or Radiation, optional
        Keys "x-", "x+", "y-", "y+", "z-", "z+", and "round" for a round wall; a number is a temperature in the user's
        scale (K or degrees Celsius), a function one that changes in time, a `Flux` an imposed heat flux density,
        `Convection` and `Radiation` heat exchanged with surroundings; where a wall radiates all is in kelvin.
    initial : float or callable (points) -> temperatures, optional
        Temperature at time 0; a function takes (n, 3) points in metres, a copy, and returns (n,) temperatures.
    sources : sequence of UniformSource or MovingCylinder
        Heat sources, for transients.
    domain : {"box", "cylinder-x", "cylinder-y", "cylinder-z", "sphere"}
        The body inscribed in the box; a cylinder is named by its axis. Round ones are for transients.
    image : Image, optional
        Voxels that fill the box, instead of matrix and inclusions: `Scene.of_image` gives size and matrix.

    Raises
    ------
    ValueError
        If an argument is not as described; the message names it, its value and what would be valid. Lengths,
        conductivities, gradients and fluxes are from 1e-50 to 1e50, or 0 where that makes sense; temperatures of walls
        differ by 1e-10 of the largest, or not at all.

    Examples
    --------
    >>> from demheat import Layer, Material, Scene
    >>> wool = Layer(0, 0.0, 0.1, Material(0.035))
    >>> wall = Scene((0.2, 1.0, 1.0), Material(0.5), [wool], walls={"x-": 20.0, "x+": -5.0})
    >>> wall.volume, wall.conductivities.tolist(), wall.axis
    (0.2, [0.5, 0.035], 0)
    >>> Scene((0.2, 1.0, 1.0), Material(0.5))
    Traceback (most recent call last):
        ...
    ValueError: Scene.gradient, Scene.walls: neither given; ...
    """

    size: Sequence[float]
    matrix: Material
    inclusions: Sequence[Shape] = ()
    gradient: Sequence[float] | None = None
    walls: Mapping[str, float | Callable[[float], float] | Flux | Convection | Radiation] | None = None
    initial: float | Callable[[np.ndarray], np.ndarray] | None = None
    sources: Sequence[UniformSource | MovingCylinder] = ()
    domain: str = "box"
    image: Image | None = None
    # Given by the package's front: a scene knows nothing of those who draw it.
    plot: ClassVar[Callable[..., Any]]

    def __post_init__(self):
        size = vector("Scene.size", self.size)
        if min(size) <= 0:
            raise ValueError(f"Scene.size = {self.size!r}: all three lengths must be > 0 m")
        if not all(map(moderate, size)):
            raise ValueError(f"Scene.size = {self.size!r}: all three lengths must be from {LEAST:g} to {MOST:g} m")
        object.__setattr__(self, "size", size)
        check_material("Scene.matrix", self.matrix)
        object.__setattr__(self, "inclusions", checked_inclusions(self.inclusions))
        check_domain(self)
        check_image(self)
        check_perfect(self)
        for name, value in checked_load(self).items():
            object.__setattr__(self, name, value)
        object.__setattr__(self, "sources", checked_sources(self.sources))
        check_initial(self.initial, kelvin=self.radiates)
        check_geometry(self)
        check_reached(self)
        check_dependence(self)

    @classmethod
    def of_image(
        cls,
        image: Image,
        *,
        gradient: Sequence[float] | None = None,
        walls: Mapping[str, float | Callable[[float], float] | Flux | Convection | Radiation] | None = None,
        initial: float | Callable[[np.ndarray], np.ndarray] | None = None,
        sources: Sequence[UniformSource | MovingCylinder] = (),
    ) -> Scene:
        """The scene of an image.

        Parameters
        ----------
        image : Image
        gradient, walls, initial, sources
            As those of `Scene`.

        Raises
        ------
        ValueError
            As `Scene`.
        """
        if not isinstance(image, Image):
            raise ValueError(f"image of type {type(image).__name__}: must be an Image")
        load = {"gradient": gradient, "walls": walls, "initial": initial, "sources": sources}
        return cls(image.size, image.phases[0], image=image, **load)

    @property
    def periodic(self) -> bool:
        """True for a periodic cell under a mean gradient, False for a box with walls."""
        return self.gradient is not None

    @property
    def period(self) -> np.ndarray | None:
        """Sides of a periodic cell, (3,) float array, m; None for a box with walls."""
        return np.array(self.size) if self.periodic else None

    @property
    def materials(self) -> tuple[Material, ...]:
        """The matrix, then the material of each inclusion; of an image those of its labels: index = phase number."""
        if self.image is not None:
            return self.image.phases
        return (self.matrix, *(inclusion.material for inclusion in self.inclusions))

    @property
    def conductivities(self) -> np.ndarray:
        """Conductivity of each phase, (number of materials,) float array, W/(m K); of none that is a tensor.

        Raises
        ------
        NotImplementedError
            If one differs with direction, see `tensors`.
        """
        if self.anisotropic:
            which = next(n for n, material in enumerate(self.materials) if not material.isotropic)
            raise NotImplementedError(f"Material.conductivity in phase {which} is a tensor: see Scene.tensors")
        return np.array([material.conductivity for material in self.materials])

    @property
    def tensors(self) -> np.ndarray:
        """Conductivity tensor of each phase, (1 + number of inclusions, 3, 3) float array, W/(m K)."""
        return np.array([material.tensor for material in self.materials])

    @property
    def mean_conductivities(self) -> np.ndarray:
        """Mean of each phase's conductivity over all directions, (1 + number of inclusions,) float array, W/(m K).

        For what asks how much a phase conducts, not which way: where it is not 0, what stands out, in which units.
        """
        return np.array([material.mean_conductivity for material in self.materials])

    @cached_property
    def anisotropic(self) -> bool:
        """Whether the conductivity of a phase differs with direction."""
        return not all(material.isotropic for material in self.materials)

    @cached_property
    def varies(self) -> bool:
        """Whether the conductivity of a phase depends on temperature: the equations are then not linear."""
        return any(material.dependence is not None for material in self.materials)

    @cached_property
    def perfect(self) -> bool:
        """Whether a phase is a perfect conductor."""
        return any(material.perfect for material in self.materials)

    @property
    def dependences(self) -> Dependences:
        """How the conductivity of each phase depends on temperature."""
        return Dependences([material.dependence for material in self.materials])

    @property
    def resistances(self) -> np.ndarray:
        """Resistance of the surface of each phase, (number of materials,) float array, m2 K/W; 0 of the matrix.

        Where surfaces lie on each other they are crossed one after the other, see `demheat.scene.resistances`.
        """
        if self.image is not None:
            return np.zeros(len(self.materials))
        return np.array([0.0, *(inclusion.resistance for inclusion in self.inclusions)])

    @property
    def volume(self) -> float:
        """Volume of the body, m3."""
        return domain_volume(self.domain, self.size)

    @property
    def wall_temperatures(self) -> dict[str, float]:
        """The walls held at a temperature; a function where it depends on time (see `at`)."""
        return {name: _plain(v) for name, v in (self.walls or {}).items() if not isinstance(v, OPEN)}

    @property
    def wall_fluxes(self) -> dict[str, float]:
        """The walls with an imposed flux, W/m2 into the body; a function where it depends on time (see `at`)."""
        return {name: v.value for name, v in (self.walls or {}).items() if isinstance(v, Flux)}

    @property
    def wall_exchanges(self) -> dict[str, Convection | Radiation]:
        """The walls that exchange heat with surroundings, whose own temperature is part of the solution."""
        return {name: v for name, v in (self.walls or {}).items() if isinstance(v, Convection | Radiation)}

    @property
    def imposed_temperatures(self) -> dict[str, float]:
        """Temperatures of walls that have one and of the surroundings of others; functions where they change."""
        return {name: _plain(driver(v)) for name, v in (self.walls or {}).items() if not isinstance(v, Flux)}

    @property
    def radiates(self) -> bool:
        """Whether a wall radiates: temperatures are then in kelvin, and the equations are not linear."""
        return any(isinstance(load, Radiation) for load in (self.walls or {}).values())

    @property
    def axis(self) -> int:
        """Axis of a load by one pair of opposite walls.

        Raises
        ------
        ValueError
            If the load is anything else: only such a load defines an effective conductivity.
        """
        names = sorted(self.walls or {})
        if len(names) == 2 and names[0][0] == names[1][0]:
            return "xyz".index(names[0][0])
        raise ValueError(f"Scene.walls = {names}: only two opposite loaded walls define an axis of load")

    def images(self) -> list[tuple[int, Shape]]:
        """Inclusions that meet the box, as (phase number, shape), periodic images included, in painting order."""
        return [
            (phase, image)
            for phase, shape in enumerate(self.inclusions, start=1)
            for image in shape.images(self.size, periodic=self.periodic)
        ]

    def phase_at(self, points: ArrayLike) -> np.ndarray:
        """Phase number (0 = matrix, i + 1 = inclusion i) at points, (n, 3) float array in metres -> (n,) int array."""
        points = np.asarray(points, dtype=float).reshape(-1, 3)
        if self.image is not None:
            return self.image.phase_at(points, periodic=self.periodic)
        phase = np.zeros(len(points), dtype=np.int32)
        if self.inclusions:
            for point, number in self._holders.pairs(points):
                # What is painted last is seen.
                np.maximum.at(phase, point, (number + 1).astype(np.int32))
        return phase

    @cached_property
    def _holders(self):
        return Holders(self.inclusions, self.size, periodic=self.periodic)

    def parents(self) -> np.ndarray:
        """Phase that each inclusion was painted on: (1 + number of inclusions,) int array, entry 0 unused.

        Inclusions are disjoint or nested, so the one that holds a single point of another holds all of it.
        """
        return self._parents

    @cached_property
    def _parents(self):
        points = [shape.point_in(self.size, periodic=self.periodic) for shape in self.inclusions]
        points = np.array(points).reshape(-1, 3)
        parent = np.zeros(len(points) + 1, dtype=np.int64)
        for inner, outer in self._holders.pairs(points):
            before = outer < inner
            np.maximum.at(parent, inner[before] + 1, outer[before] + 1)
        return read_only(parent)

    def only(self, *shapes: type[Shape]) -> bool:
        """Whether all inclusions are of these shapes; True if there is none, but not of an image."""
        return self.image is None and all(isinstance(shape, shapes) for shape in self.inclusions)

    def at(self, time: float) -> Scene:
        """The same scene with the loads of its walls as they are at a time in seconds."""
        if not any(callable(driver(load)) for load in (self.walls or {}).values()):
            return self
        walls = {name: driven(load, load_at(name, load, time)) for name, load in self.walls.items()}
        return replace(self, walls=walls)

    def _repr_html_(self) -> str:
        """A short table for notebooks."""
        return table_of(told_of(self))

    def require(
        self,
        knows: str = "",
        *,
        steady: bool | None = None,
        walls: str | None = None,
        domain: str | None = None,
        shapes: tuple[type[Shape], ...] | Callable[[Shape], bool] | None = None,
        nested: bool = True,
        pores: bool = True,
        takes: tuple[str, ...] = (),
    ) -> None:
        """Raise unless a method can take this scene: the one place where methods refuse scenes.

        Parameters
        ----------
        knows : str
            What the method knows, or what to do instead: behind what is found in a message, and before who takes it.
        steady : bool, optional
            True: a steady state is asked for, with loads that fix one, in a box and without sources. False: a transient
            is, with walls, an initial temperature and heat capacities.
        walls : str, optional
            What walls it can have, a key of `demheat.scene.needs.WALLS`.
        domain : str, optional
            The only body it knows.
        shapes : tuple of types of Shape, or callable Shape -> bool, optional
            Of the inclusions: which it knows.
        nested : bool
            Whether inclusions may lie in others.
        pores : bool
            Whether a conductivity may be 0.
        takes : tuple of {"resistance", "exchange", "anisotropy", "dependence", "image", "perfect"}
            What few methods know and all others refuse: surfaces with a resistance, walls that exchange heat with
            surroundings, conductivities that are tensors, that depend on temperature, or are infinite, images.

        Raises
        ------
        ValueError
            If the scene lacks what any steady state, or any transient, needs.
        NotImplementedError
            For all else; the message says what in the scene it is.
        """
        if steady is not None:
            (check_steady if steady else check_transient)(self)
        can = {"walls": walls, "domain": domain, "shapes": shapes, "nested": nested, "pores": pores}
        for found, others in refusals(self, **can, takes=takes):
            raise NotImplementedError(refusal(found, knows, others))


def check_scene(scene, name="scene") -> None:
    """Raise ValueError unless a value is a Scene."""
    if not isinstance(scene, Scene):
        file = isinstance(scene, str | PurePath) and PurePath(scene).suffix == ".toml"
        read = f"; demheat.io.scenes.read({str(scene)!r}) makes one of a file" if file else ""
        raise ValueError(f"{name} = {scene!r}: must be a Scene{read}")


def _plain(load):
    return load if callable(load) else float(load)
