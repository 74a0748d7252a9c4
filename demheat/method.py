"""What a method declares of itself: studies, figures and the suites of tests find it here and nowhere else.

A method is a module with `solve(scene, *, ...) -> Field` or `evolve(scene, times, *, ...)`, its knobs spelled, or one
that knows the effective conductivity alone, `estimate(scene) -> float`. What it is and is worth stands in a tuple
`METHODS` of that module: one entry for each way of fixing its knobs that studies tell apart.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

# What every method is asked for. One that does not claim a thing names it in `exceptions` with the reason.
PROPERTIES = {
    "field": "temperature and flux at any point, not the conductivity alone",
    "errors": "declared errors, against an exact solution",
    "orders": "declared orders of these errors, fitted over refinements",
    "volumes": "the volumes of its samples sum to that of the body",
    "integral": "its samples integrate to its mean flux",
    "samples": "to rounding; without it within the error of the conductivity",
    "maximum": "temperatures stay between those of the walls",
    "patch": "a linear field is exact",
    "laminate": "layers are exact, across and along",
    "potential": "their temperature too; without it within the error of the temperature",
    "rotation": "a turned scene has the turned flux; without it within twice the error of the conductivity",
    "tensor": "the conductivity is a symmetric tensor, between the bounds",
    "pores": "a phase of no conductivity is solved, or refused",
}
# What a scene may ask for. A method that cannot do it names it in `refuses`, with words of the error that it raises.
FEATURES = {
    "gradient": "a mean gradient in a periodic cell",
    "walls": "walls of the box",
    "flux": "an imposed flux, or temperatures on walls that meet",
    "pores": "a phase of no conductivity",
    "layers": "layers",
    "spheres": "spheres",
    "nested": "spheres in spheres",
    "cut": "spheres that a wall cuts",
    "unlike": "spheres apart that are not all alike",
    "several": "more than one sphere",
}
ROLES = ("main", "beside", "witness")

# Reasons that methods of more than one family have.
UNTURNED = {"rotation": "its particles or mesh do not turn with the scene"}
OVERSHOOT = {"maximum": "its matrix has positive couplings between neighbours"}
CUT = {"laminate": "links or voxels that cross an interface do not see where"}


class Resolution(NamedTuple):
    """The knob that refines a method."""

    knob: str  # Keyword of its `solve`
    size: Callable[[float], float]  # callable (value) -> float: Size of an element, up to a factor, in edges of a cube
    words: str  # Of a value, to be formatted, as "{:.0f} particles"
    metric: bool = False  # The knob is a length in metres: its values are declared in edges of the box
    seeded: bool = False  # Its elements lie at random: a `seed` goes with it
    column: str = ""  # Of the rows, where the knob's name is also another's; else the knob


PARTICLES = Resolution("particles", lambda number: number ** (-1 / 3), "{:.0f} particles", seeded=True)
SIZE = Resolution("size", lambda size: size, "h = {:.2g} L", metric=True)
VOXELS = Resolution("voxels", lambda voxels: 1 / voxels, "{:.0f}^3 voxels")
DEGREE = Resolution("order", lambda degree: 1 / degree, "degree {:.0f}", column="degree")


class Errors(NamedTuple):
    """Errors that a method does not pass in the suite, 1.5 times the largest found there.

    Of the conductivity relative; root mean squares of the temperature over the imposed span and of the flux over the
    mean flux, at random points; None of what the method does not have.
    """

    conductivity: float
    temperature: float | None = None
    flux: float | None = None


class Orders(NamedTuple):
    """Orders of these errors in the size of an element, below which a method never falls.

    Fitted over `values` of the resolution, coarse to fine, of a sphere so many times as conducting as its matrix
    (`contrast`), as means over `repeats` places of the sphere and seeds. Errors of random packings, unstructured meshes
    and voxels on a sphere scatter: what is declared is below the theory and below what was found.
    """

    values: tuple
    conductivity: float
    temperature: float
    flux: float
    contrast: float = 10.0
    repeats: int = 1


@dataclass(frozen=True, kw_only=True, eq=False)
class Method:
    """A method as studies and suites know it."""

    name: str  # In rows, as "fem-p1"
    title: str  # In a few words
    label: str = ""  # In full, for tables and legends; the title by default
    # "main", "beside" or "witness": every study of methods takes it; or only those that name it; or it is what others
    # are compared with
    role: str = "main"
    knobs: Mapping = field(default_factory=dict)  # Keywords of its module that it fixes, in the order of rows' keys
    call: str = "solve"  # The function of its module: "solve"; "evolve" or "estimate" if it has no other
    resolution: Resolution | None = None  # None if nothing refines it
    small: float | None = None  # Value of that knob for warm-ups, next to nothing; by default the coarse one
    coarse: float | None = None  # Value of that knob for the suite of what methods owe
    tight: Mapping = field(default_factory=dict)  # Knobs there with which only rounding is left of what is solved
    errors: Errors | None = None  # At the coarse value
    orders: Orders | None = None
    # Exponents of the size of an element whose terms extrapolation takes off; empty where the finest value counts
    terms: tuple = ()
    exceptions: Mapping = field(default_factory=dict)  # Of `PROPERTIES`, what is not claimed and why
    # Of `FEATURES`, what it cannot do, and words of the error that says so
    refuses: Mapping = field(default_factory=dict)
    look: tuple = ("black", "P", ":")  # Colour of `studies.harness.figures`, marker and line
    module: str = ""  # Name of its module, the last part of its path; whoever finds the method puts it in

    def __post_init__(self):
        for what, given, known in (
            ("role", {self.role}, ROLES),
            ("exceptions", set(self.exceptions), PROPERTIES),
            ("refuses", set(self.refuses), FEATURES),
        ):
            if not given <= set(known):
                raise ValueError(f"{what} of method {self.name!r}: {given - set(known)} not among {', '.join(known)}")
        if self.resolution and self.coarse is None:
            raise ValueError(f"coarse of method {self.name!r} = None: must be a value of {self.resolution.knob!r}")
        object.__setattr__(self, "label", self.label or self.title)
        object.__setattr__(self, "small", self.coarse if self.small is None else self.small)

    def at(self, value, edge=1.0):
        """Knobs at a value of the resolution, in a box of an edge, m, the unit of values that are lengths."""
        if self.resolution is None:
            return {}
        return {self.resolution.knob: value * edge if self.resolution.metric else value}
