"""Laws of conductance, as plain objects: what each may be asked for, and which scenes it cannot take.

They are declared here and at work in `demheat.dem.networks`, so that naming a law loads no engine.
"""

from dataclasses import dataclass, fields
from typing import ClassVar

from demheat.scene import Scene
from demheat.scene.inputs import chosen, finite, flag

RULES = ("harmonic", "arithmetic")
MEANS = ("arithmetic", "harmonic", "geometric")
POLICIES = ("nearest", "keep", "drop")
WALL_RULES = ("center", "surface")
# With offsets of a quarter of a gap and points at most 0.8 spacings away, the twins of the other side come nearer to an
# interface than its own beyond 1 / (sqrt(2) 0.8) of its width.
WIDEST = 0.88
ON_FACETS = "only law 'laguerre' with conforming=True and interface='harmonic' has facets on the interfaces"
# Where a conductivity is a tensor, heat crosses a facet by temperatures beside the link, too.
TWO_POINTS = "two particles tell the flux through their facet only where its normal is a principal axis of the tensor"


@dataclass(frozen=True, kw_only=True)
class Laguerre:
    """Transmission surfaces are the facets of the radical tessellation: exact for linear fields, without calibration.

    Parameters
    ----------
    conforming : bool
        Mirror particles across every interface so that facets lie on it.
    interface : {"harmonic", "arithmetic"}
        Rule for links between materials (Haddad et al. 2021, eq. 24).
    gap_spacing : float
        Distance between mirrored particles in a gap, over its width, if that is less than elsewhere. Smaller resolves
        gaps better, at the inverse square of the cost; more than 0.88 lets facets cross interfaces. Layers and coats
        between concentric spheres need no closer ones. Only with `conforming`.

    Raises
    ------
    ValueError
        If an argument is none of these, or a spacing is given without mirrored particles.

    Examples
    --------
    >>> from demheat import Laguerre, gallery, solve
    >>> field = solve(gallery.slab(), law=Laguerre(conforming=False), particles=1000)
    >>> print(f"{field.conductivity:.9f}")  # that of the material, on any packing
    33.000000000
    """

    conforming: bool = True
    interface: str = "harmonic"
    gap_spacing: float = 0.85

    name: ClassVar[str] = "laguerre"
    # Facets bound cells that fill the body; no C_t; wall temperatures act at the wall.
    cells: ClassVar[bool] = True
    factor: ClassVar[float] = 1.0
    holds_centers: ClassVar[bool] = False

    def __post_init__(self):
        flag("conforming", self.conforming)
        chosen("interface", self.interface, RULES)
        finite("gap_spacing", self.gap_spacing, "a number above 0, at most 0.88", lambda v: 0 < v <= WIDEST)
        if not self.conforming and self.gap_spacing != type(self).gap_spacing:
            raise ValueError(
                f"gap_spacing = {self.gap_spacing!r} with conforming = False: there are no mirrored particles; must be "
                "left out"
            )

    @property
    def takes(self) -> tuple[str, ...]:
        """What few laws know, of `Scene.require`: facets on surfaces may resist, and have temperatures of their own."""
        on_facets = self.conforming and self.interface == "harmonic"
        return ("exchange", "image", "resistance", "dependence", "perfect") if on_facets else ("exchange", "image")

    def check(self, scene: Scene) -> None:
        """Raise NotImplementedError if the law cannot do a scene."""
        check_numbers(scene)
        scene.require(ON_FACETS, takes=self.takes)
        if self.conforming and scene.inclusions:
            text = "inclusions there have no conforming packing; pass conforming=False"
            scene.require(text, domain="box", takes=self.takes)


@dataclass(frozen=True, kw_only=True)
class _Contacts:
    """What the laws that know contacts only have in common."""

    interface: str = "harmonic"
    coordination: float | None = None
    gap: float | None = None
    sparse: str = "nearest"
    wall: str = "center"

    cells: ClassVar[bool] = False
    conforming: ClassVar[bool] = False
    # Facets on interfaces, where a resistance would be.
    takes: ClassVar[tuple[str, ...]] = ("exchange", "image")

    def __post_init__(self):
        chosen("interface", self.interface, RULES)
        chosen("sparse", self.sparse, POLICIES)
        chosen("wall", self.wall, WALL_RULES)
        if self.coordination is not None:
            _keep(self, "coordination", "a finite number > 0", above=0.0)
        if self.gap is not None:
            _keep(self, "gap", "a finite part of r_i + r_j > -1", above=-1.0)
        if self.gap is not None and self.coordination is not None:
            raise ValueError(
                f"gap = {self.gap!r}, coordination = {self.coordination!r}: one gives the other; pass one of them"
            )
        if self.gap is None and self.coordination is None:
            object.__setattr__(self, "coordination", self.usual)

    @property
    def holds_centers(self) -> bool:
        """Whether centres of particles at a wall with a temperature are held at it, as in the papers."""
        return self.wall == "center"

    def check(self, scene: Scene) -> None:
        """Raise NotImplementedError if the law cannot do a scene."""
        check_numbers(scene)
        scene.require(ON_FACETS, takes=self.takes)
        if self.wall == "surface":
            what = "wall 'surface' knows flat walls and that of a sphere; pass wall='center', or law 'laguerre'"
            scene.require(what, walls="flat or a sphere's", takes=("exchange", "image"))
        else:
            scene.require(
                f"law {self.name!r} with wall 'center' holds the centres of the particles at a wall at its temperature:"
                " where two held walls meet, one particle would join them, and no surface is left to exchange heat; use"
                " wall 'surface'",
                walls="isothermal ones apart",
                takes=("image",),
            )


@dataclass(frozen=True, kw_only=True)
class Calibrated(_Contacts):
    """Transmission surfaces C_t pi R_m^2 between touching particles (Haddad et al. 2021, eqs. 7-9).

    Parameters
    ----------
    interface : {"harmonic", "arithmetic"}
        Rule for links between materials (Haddad et al. 2021, eq. 24).
    coordination : float, optional
        Mean number of contacts of particles away from walls; 7.5, as in the paper, where no gap is given.
    gap : float, optional
        Contacts are within this part of r_i + r_j, instead of as many as `coordination` asks for. For bodies too thin
        to have particles away from walls.
    sparse : {"nearest", "keep", "drop"}
        Particles with fewer than 2 links: join each to its 2 nearest neighbours by surface distance; leave them (those
        that touch nobody are isolated, without heat); or take out, again and again until none is left, particles with
        fewer than 2 links (walls count as one) and all clusters but the largest.
    wall : {"center", "surface"}
        Where a wall temperature acts: in the centres of the particles that touch the wall, a radius inside the body, as
        in the papers; or at the wall, see `demheat.network.calibrated.surface_distances`.
    mean : {"arithmetic", "harmonic", "geometric"}
        R_m of the two radii; the papers' is the arithmetic one.
    additive : bool
        The gap is the same length for all pairs, as in `demheat.packing.neighbours.contacts`.
    factor : float, optional
        C_t. By default the one that gives a body of one material its conductivity, from a homogeneous steady solve:
        between the walls along the scene's load; for a sphere in a cube of the same volume, packed anew.

    Raises
    ------
    ValueError
        If an argument is none of these, or both gap and coordination are given.

    Examples
    --------
    >>> from demheat import Calibrated, gallery, solve
    >>> field = solve(gallery.sphere_in_cube(5.0), law=Calibrated(coordination=7.0, wall="surface"), particles=1000)
    >>> print(f"C_t = {field.stats['calibration']:.1f}")
    C_t = 0.8
    """

    mean: str = "arithmetic"
    additive: bool = False
    factor: float | None = None

    name: ClassVar[str] = "calibrated"
    # Contacts of the papers' own law: Haddad et al. 2021.
    usual: ClassVar[float] = 7.5

    def __post_init__(self):
        super().__post_init__()
        chosen("mean", self.mean, MEANS)
        flag("additive", self.additive)
        if self.factor is not None:
            _keep(self, "factor", "a finite number > 0", above=0.0)


@dataclass(frozen=True, kw_only=True)
class Platonic(_Contacts):
    """Transmission surfaces and capacities of regular polyhedra, by the number of contacts of each particle.

    Source: Terreros et al. 2013, section 4. Volumes, and with them the heat capacity, sum to the body's only by chance.

    Parameters
    ----------
    interface, gap, wall : str, float, str
        As in `Calibrated`.
    coordination : float, optional
        As in `Calibrated`, but 7.2 where no gap is given: the paper states no number.
    sparse : {"nearest", "keep", "drop"}
        As in `Calibrated`. A particle without any neighbour, whose capacity the paper's table would make infinite,
        takes no part.

    Raises
    ------
    ValueError
        If an argument is none of these, or both gap and coordination are given.

    Examples
    --------
    >>> from demheat import Platonic, gallery, solve
    >>> field = solve(gallery.slab(), law=Platonic(), particles=1000)
    >>> abs(field.conductivity / 33.0 - 1) > 0.01  # it is not conserved
    True
    """

    name: ClassVar[str] = "platonic"
    factor: ClassVar[float] = 1.0
    # The paper does not say how many contacts its packings have. At so many the errors of conductance and capacity, 8 %
    # too much each, were found to cancel in the diffusivity (see `studies.table1_platonic`), which the paper's tests
    # measure.
    usual: ClassVar[float] = 7.2


def check_numbers(scene: Scene) -> None:
    """Raise NotImplementedError if a conductivity is a tensor: no law of two points can do with one."""
    scene.require(TWO_POINTS, takes=("resistance", "exchange", "dependence", "image", "perfect"))


LAWS = {kind.name: kind for kind in (Laguerre, Calibrated, Platonic)}
Law = Laguerre | Calibrated | Platonic


@dataclass(frozen=True, kw_only=True)
class Choices:
    """What `solve` and `evolve` may be asked of a law that is given by its name; None is the law's own default."""

    conforming: bool | None = None
    interface: str | None = None
    gap_spacing: float | None = None
    sparse: str | None = None
    wall: str | None = None
    coordination: float | None = None
    gap: float | None = None

    def law(self, law: str | Law) -> Law:
        """The law of a name; or a law itself, of which nothing else may be asked."""
        given = {name: value for name, value in vars(self).items() if value is not None}
        if isinstance(law, Law):
            if given:
                raise ValueError(f"{', '.join(given)} beside law = {law!r}: must be given to the law itself")
            return law
        if not isinstance(law, str) or law not in LAWS:
            raise ValueError(f"law = {law!r}: must be one of {', '.join(LAWS)}, or a law such as Laguerre()")
        if self.conforming is not None:
            flag("conforming", self.conforming)
        kind = LAWS[law]
        if kind is Laguerre:
            given = {name: value for name, value in given.items() if not _asks_nothing(name, value)}
        elif not self.conforming:
            given.pop("conforming", None)
        _check_own(kind, given)
        return kind(**given)


def _asks_nothing(name, value):
    """Whether a choice that only the contact laws have is their default."""
    return isinstance(value, str) and value == {"sparse": _Contacts.sparse, "wall": _Contacts.wall}.get(name)


def _check_own(kind, given):
    """Refuse choices that a law does not have."""
    odd = {name: value for name, value in given.items() if name not in {field.name for field in fields(kind)}}
    if "conforming" in odd:
        raise ValueError(
            f"conforming = True with law = {kind.name!r}: twins need not touch; must be False, or law 'laguerre'"
        )
    if odd:
        told = ", ".join(f"{name} = {value!r}" for name, value in odd.items())
        others = "laws 'calibrated' and 'platonic' have" if kind is Laguerre else "law 'laguerre' has"
        raise ValueError(f"{told} with law = {kind.name!r}: only the {others} such a choice")


def _keep(law, name, valid, *, above):
    """Check a number of a law, and keep it as a float."""
    object.__setattr__(law, name, finite(name, getattr(law, name), valid, lambda v: v > above))
