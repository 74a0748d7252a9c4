"""What every method returns: temperatures, fluxes and the effective conductivity, without saying how.

Pores are phases of conductivity 0. In a steady state the flux in a pore is 0 and its temperature NaN, as the problem
does not fix it, whatever the method. A body of conducting material that no heat can pass, cut off by pores, carries
exactly none and has one temperature: that of the wall it reaches, NaN where it reaches no wall with a temperature. In a
periodic cell each such body's temperature less that of the mean gradient has zero mean over the body, as levels there
are free. If all bodies are cut off from the load, the effective conductivity is exactly 0. In time pores do have a
temperature, the initial one and what sources put into them.

Perfect conductors are phases of infinite conductivity. All of such a body has one temperature, that of the wall it
reaches, else the one at which it takes up as much heat as it gives; the flux in it is the limit for good conductors.
Where perfect conductors join two temperatures the effective conductivity is infinite: a ValueError says so.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np

from demheat.gate import check_answer
from demheat.scene import Scene
from demheat.scene.bodies import inside
from demheat.scene.frozen import ReadOnly, read_only, table_of
from demheat.scene.inputs import axis_number, check_rows, finite, points_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from demheat.error import Estimate
    from demheat.extrapolation import Extrapolated

# Of the box: points computed to lie on a wall may be so far beyond it.
ON_WALL = 1e-9


class Samples(NamedTuple):
    """A method's own values at its own points (particles, quadrature points, voxels).

    Attributes
    ----------
    points : (n, 3) float array, m
    volumes : (n,) float array, m3
        Sum to the volume of the body as the method has it: those of the Platonic law, which carry the heat, do not fill
        it.
    temperature : (n,) float array, K or degrees Celsius
        Of a steady state NaN in pores and where no temperature is fixed, see the module; `numpy.nanmean` leaves these
        out.
    phase : (n,) int array
        Phase number as the method saw it.
    flux : (n, 3) float array, W/m2
        Along Fourier's direction (down the gradient). 0 in pores; of a voxel that an interface cuts the mean over it.

    Examples
    --------
    >>> from demheat import gallery, solve
    >>> own = solve(gallery.sphere_in_cube(5.0), particles=1000).samples
    >>> print(f"{own.volumes.sum():.6f} m3")  # that of the body
    0.001000 m3
    >>> own.points.shape == own.flux.shape
    True
    """

    points: np.ndarray
    volumes: np.ndarray
    temperature: np.ndarray
    phase: np.ndarray
    flux: np.ndarray

    def columns(self) -> dict[str, np.ndarray]:
        """All of it as columns of (n,) numbers: `pandas.DataFrame(field.samples.columns())`, and other tables."""
        one = {"volume": self.volumes, "temperature": self.temperature, "phase": self.phase}
        places = {axis: self.points[:, number] for number, axis in enumerate("xyz")}
        return places | one | {f"flux_{axis}": self.flux[:, number] for number, axis in enumerate("xyz")}


@dataclass(frozen=True, repr=False)
class Field:
    """A solution of one scene by one method.

    What is costly is made only when asked for: `samples`, `temperature_at`, `flux_at`.

    Parameters
    ----------
    scene : Scene
    mean_flux : (3,) float array, W/m2
        Volume-averaged flux density, computed the method's own way.
    fractions : (1 + number of inclusions,) float array
        Volume fraction of each phase as the method saw it.
    sampler : callable () -> Samples
    temperature_at : callable (n, 3) float array, m -> (n,) float array, K
        Of a steady state NaN in pores and where no temperature is fixed, see the module.
    flux_at : callable (n, 3) float array, m -> (n, 3) float array, W/m2
        0 in pores of a steady state. Both take one (3,) point too, and raise ValueError if the points are anything
        else, not finite, or outside a body with walls.
    wall_temperature : mapping of str to float, K
        Area-averaged temperature of each loaded wall; empty in a periodic cell.
    wall_heat : mapping of str to float, W
        Heat that enters the body through each loaded wall; empty in a periodic cell.
    stats : mapping
        `unknowns`, `iterations`, `residual` (relative, recomputed after the solve) and what else the method knows.
    time : float, s, optional
    through : callable (axis, position) -> float, W, optional
        See `heat_through`.
    estimator : callable (Field) -> Estimate, optional
        See `error`.
    elements : callable () -> ((n, 3) float array, m, (m, 4 or 10) int array), optional
        Nodes and tetrahedra of finite elements, in VTK's order, for `write`.
    slack : (2,) tuple of float
        By how much, relatively, the conductivity may be below and above its bounds (`demheat.gate`), as averages of the
        method are known to be off, or as it knows of more than the scene tells, such as cracks.
    extrapolator : callable (Field) -> Extrapolated, optional
        See `extrapolated`.

    Raises
    ------
    RuntimeError
        If no body with these fractions of its materials has the steady field's conductivity, or the body has others:
        see `demheat.gate`.

    Examples
    --------
    >>> from demheat import gallery
    >>> from references import fft
    >>> field = fft.solve(gallery.sphere_in_cube(5.0), voxels=16)
    >>> print(f"{field.conductivity:.2f} W/(m K) along the load, {field.wall_heat['y+']:.2f} W in by the warm wall")
    42.67 W/(m K) along the load, 42.67 W in by the warm wall
    >>> field.temperature_at([[0.05, 0.05, 0.05]]).round(6)
    array([30.])
    >>> field.samples.flux.shape
    (4096, 3)
    """

    scene: Scene
    mean_flux: np.ndarray
    fractions: np.ndarray
    sampler: Callable[[], Samples]
    temperature_at: Callable[[ArrayLike], np.ndarray]
    flux_at: Callable[[ArrayLike], np.ndarray]
    wall_temperature: Mapping[str, float] = field(default_factory=dict)
    wall_heat: Mapping[str, float] = field(default_factory=dict)
    stats: Mapping[str, Any] = field(default_factory=dict)
    time: float | None = None
    through: Callable[[int, float], float] | None = None
    estimator: Callable[[Field], Estimate] | None = None
    elements: Callable[[], tuple[np.ndarray, np.ndarray]] | None = None
    slack: tuple[float, float] = (0.0, 0.0)
    extrapolator: Callable[[Field], Extrapolated] | None = None
    # Given by the package's front: a field knows nothing of those who store and draw it.
    write: ClassVar[Callable[..., None]]
    plot: ClassVar[Callable[..., Any]]
    to_dataframe: ClassVar[Callable[..., Any]]
    to_xarray: ClassVar[Callable[..., Any]]
    to_pyvista: ClassVar[Callable[..., Any]]

    def __post_init__(self):
        # What is handed out cannot be changed: what is worked out later would be wrong without a word.
        for name in ("mean_flux", "fractions"):
            object.__setattr__(self, name, read_only(np.array(getattr(self, name))))
        for name in ("wall_temperature", "wall_heat", "stats"):
            object.__setattr__(self, name, ReadOnly(getattr(self, name)))
        # What is made when first asked for, and kept, is made once: by one thread, the others wait.
        lock = threading.RLock()
        object.__setattr__(self, "sampler", _in_turn(self.sampler, lock))
        for name, in_pores in (("temperature_at", np.nan), ("flux_at", 0.0)):
            evaluate = _in_turn(getattr(self, name), lock)
            if self._has_pores:
                evaluate = _outside_pores(evaluate, self.scene, in_pores)
            object.__setattr__(self, name, _guarded(evaluate, self.scene))
        check_answer(self)

    @property
    def _has_pores(self):
        """Whether there are places without a temperature: in time pores have one."""
        return self.time is None and self.scene.mean_conductivities.min() == 0

    @cached_property
    def samples(self) -> Samples:
        """The method's own values at its own points, in arrays that cannot be written to."""
        own = Samples(*map(read_only, self.sampler()))
        if not self._has_pores:
            return own
        solid = self.scene.mean_conductivities[own.phase] > 0
        return own._replace(temperature=read_only(np.where(solid, own.temperature, np.nan)))

    @cached_property
    def error(self) -> Estimate:
        """How far conductivity and temperature may be off: an interval, and what was done to know it.

        What solves on elements solves the scene again on coarser ones, which costs about half of a large solve, and as
        much as a small one or more; an image, or a block out of its middle, on voxels that are split.

        Raises
        ------
        NotImplementedError
            If the method does not know its error.
        RuntimeError
            If no coarser run can be made.
        """
        if self.estimator is None:
            raise NotImplementedError("Field.error: this method does not know its error")
        return self.estimator(self)

    @cached_property
    def extrapolated(self) -> Extrapolated:
        """What the conductivity closes in on as elements get smaller, with an interval, by Richardson's extrapolation.

        Of two coarser runs, which cost a fraction of the solve; errors at points are not made smaller. See
        `demheat.extrapolation`.

        Raises
        ------
        NotImplementedError
            If nothing is known of how the method closes in, in time, for an image, or where the scene has parts that
            coarser runs do not tell of.
        RuntimeError
            If a coarser run cannot be made.
        """
        if self.scene.image is not None or self.time is not None or self.extrapolator is None:
            raise NotImplementedError(
                "Field.extrapolated: nothing is known of how this closes in; steady fields of the DEM's cells with "
                "twins, of finite elements and of the FFT have it, of scenes that are no images"
            )
        return self.extrapolator(self)

    def heat_through(self, axis: int, position: float) -> float:
        """Heat that crosses a section of the body, W, by the method's own balance.

        For the DEM the section is made of the facets between cells with centres on either side of a plane: in a steady
        state every one of them carries the same heat, to the solver's residual. It is as rough as the cells, so that a
        section along the load, which plane symmetry would leave without heat, carries a little.

        Parameters
        ----------
        axis : {0, 1, 2}
            Direction in which heat counts as positive.
        position : float, m
            Of the plane.

        Raises
        ------
        ValueError
            If the axis is none of these, or the plane misses the body.
        NotImplementedError
            If the method has no surfaces that balance heat.
        """
        axis = axis_number(axis)
        length = self.scene.size[axis]
        finite("position", position, f"between 0 and {length} m", lambda v: 0 <= v <= length)
        if self.through is None:
            raise NotImplementedError("heat_through: only the DEM has surfaces that balance heat")
        return self.through(axis, float(position))

    @property
    def conductivity(self) -> float:
        """Effective conductivity along the load, W/(m K).

        In a periodic cell -<q>.g/g.g; between two opposite walls mean flux times length over the difference of the
        walls' mean temperatures.

        Raises
        ------
        ValueError
            If the scene's walls are not one opposite pair, or have no temperature difference.
        """
        if self.scene.periodic:
            gradient = np.array(self.scene.gradient)
            # The sum takes the sign off a zero.
            return float(-self.mean_flux @ gradient / (gradient @ gradient)) + 0.0
        axis = self.scene.axis
        low, high = (self.wall_temperature["xyz"[axis] + side] for side in "-+")
        if high == low:
            raise ValueError("Field.conductivity: the two walls have the same temperature, no conductivity follows")
        return float(-self.mean_flux[axis] * self.scene.size[axis] / (high - low)) + 0.0

    def __repr__(self):
        return f"Field({', '.join(f'{name}: {value}' for name, value in self._told().items())})"

    def _repr_html_(self):
        """A short table for notebooks."""
        return table_of(self._told())

    def _told(self):
        """What is most asked of a field, in words."""
        told = {}
        try:
            told["conductivity"] = f"{self.conductivity:.6g} W/(m K)"
        except (ValueError, KeyError):
            told["mean flux"] = f"({', '.join(f'{each:.4g}' for each in self.mean_flux)}) W/m2"
        # Not made for this: it may cost as much as the solution.
        if "error" in self.__dict__:
            told["expected"] = f"{self.error.lower:.6g} to {self.error.upper:.6g} W/(m K)"
        if self.time is not None:
            told["time"] = f"{self.time:.6g} s"
        return told | {name: f"{self.stats[name]}" for name in ("unknowns",) if name in self.stats}

    def __reduce__(self):
        """What can be stored: all numbers, and the samples; solutions between them are made of the method's own parts.

        A stored field has no temperature or flux at other points, and no error that was not asked for before.
        """
        names = ("scene", "mean_flux", "fractions", "wall_temperature", "wall_heat", "stats", "time", "slack")
        kept = {name: self.__dict__[name] for name in ("error", "extrapolated") if name in self.__dict__}
        return _restored, ({name: getattr(self, name) for name in names}, self.samples, kept)

    def __copy__(self):
        """Itself, as it cannot be changed."""
        return self

    def __deepcopy__(self, memo):
        """Itself, as it cannot be changed."""
        return self


class _Stored:
    """What stands for a function of a field that was stored."""

    def __init__(self, name):
        self.name = name

    def __call__(self, *_):
        raise NotImplementedError(
            f"Field.{self.name}: a stored field has its samples and conductivity, and nothing between; solve again"
        )


def _restored(numbers, samples, kept):
    """The field that was stored."""
    functions = {name: _Stored(name) for name in ("temperature_at", "flux_at")}
    functions |= {
        "through": _Stored("heat_through"),
        "estimator": _Stored("error"),
        "extrapolator": _Stored("extrapolated"),
    }
    field = Field(**numbers, **functions, sampler=lambda: samples)
    field.__dict__.update(kept)
    return field


def check_field(field, name="field") -> None:
    """Raise ValueError unless a value is a Field, or has its scene and its temperature as one does."""
    if not isinstance(getattr(field, "scene", None), Scene) or not hasattr(field, "temperature_at"):
        raise ValueError(f"{name} = {field!r}: must be a Field, as methods return it")


def _in_turn(evaluate, lock):
    def at(*points):
        with lock:
            return evaluate(*points)

    return at


def _guarded(evaluate, scene):
    """The same function of points behind one check of them."""

    def at(points):
        points = points_of("points", points)
        if not scene.periodic:
            _check_inside(points, scene)
        return evaluate(points)

    return at


def _outside_pores(evaluate, scene, in_pores):
    """The same function of points, with one value in all pores."""

    def at(points):
        solid = scene.mean_conductivities[scene.phase_at(points)] > 0
        found = evaluate(points[solid])
        values = np.full((len(points), *found.shape[1:]), in_pores)
        values[solid] = found
        return values

    return at


def _check_inside(points, scene):
    within = inside(points, scene.domain, scene.size, slack=ON_WALL)
    check_rows("points", points, within, f"lies outside the {scene.domain} with walls, 0 to {scene.size}")
