"""What two grains conduct: through their contact, and through the medium in the gap around it.

A contact of radius a conducts what two half-spaces do that meet in a disc (Holm, Electric Contacts, 1967; Batchelor and
O'Brien, Proc. R. Soc. A 355 (1977) 313, with whose problem of two near grains all of this begins),

    C = 4 a / (1/k_1 + 1/k_2),    2 k a between equal grains.

Beside it heat crosses the medium in rings of radius r, out to that of a disc, b. On a unit of area a ring meets the
medium, (h + r^2/(2 R))/k_f with the parabola of 1/R = 1/R_1 + 1/R_2, and the grains, where lines of flow draw together,
in proportion to r:

    G = integral from a to b of 2 pi r dr / (p + q r + s r^2)
      = (2 pi / s) (u ln((b + u)/(a + u)) - v ln((b + v)/(a + v))) / (u - v),

    p = h/k_f,   q = 2 e^gamma (1/k_1 + 1/k_2) + s mu a,   s = 1/(2 R k_f),   u, v = (q +- sqrt(q^2 - 4 p s)) / (2 s).

Both numbers are such that a limit is exact, for good conductors (k_f << k_1, k_2) and discs far wider than what is in
their middle: gamma = 0.5772 for a point contact, whose near field is the Hankel transform of 2 K_0(2 sqrt(.)), and
mu = exp(7 zeta(3)/pi^2) - 1 for a contact much wider than R k_f/k, by the energy of the gap between two truncated
half-spaces. Third, a gap much wider than R (k_f/k)^2 is one between perfect conductors, 2 pi k_f R ln(1 + b^2/(2 R h)).
In between the form is a smooth guess. An isothermal wall is a grain without curvature or resistance, which makes half
of a grain and its mirror image.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from demheat.network.gap_law import POINT, RIM, gap_conductance  # noqa: F401 (pairs and tests know them from here)
from demheat.scene.inputs import LEAST, MOST, finite


@dataclass(frozen=True, kw_only=True)
class Gap:
    """The medium between grains that are near each other or touch.

    Parameters
    ----------
    conductivity : float, W/(m K)
        Of the medium.
    disc : float
        Radius of the disc through which a pair exchanges heat, over the radius of its smaller grain. Half is what two
        discs of a grain have room for if they belong to neighbours that touch each other.
    widest : float
        Gaps that exchange heat, at most, over the radius of the smaller grain.

    Raises
    ------
    ValueError
        If one is not as described.

    Examples
    --------
    >>> from demheat import grains
    >>> grains.Gap(conductivity=0.026)  # air
    Gap(conductivity=0.026, disc=0.5, widest=0.5)
    """

    conductivity: float
    disc: float = 0.5
    widest: float = 0.5

    def __post_init__(self):
        check_conductivity("Gap.conductivity", self.conductivity)
        finite("Gap.disc", self.disc, "a number > 0 of radii, at most 2", lambda v: 0 < v <= 2)
        finite("Gap.widest", self.widest, "a number >= 0 of radii, at most 2", lambda v: 0 <= v <= 2)


@dataclass(frozen=True)
class Overlap:
    """Contact radius: of the circle in which two overlapping spheres cut each other, or a sphere a wall.

    Examples
    --------
    >>> import numpy as np
    >>> from demheat import grains
    >>> grains.Overlap().radius(np.array([1.6, 2.1]), 1.0, 1.0).round(12).tolist()  # 3, 4, 5; apart
    [0.6, 0.0]
    """

    def radius(self, distance: ArrayLike, first: ArrayLike, second: ArrayLike) -> np.ndarray:
        """Contact radius of each pair, (m,) float array, m; 0 where spheres do not overlap.

        Parameters
        ----------
        distance : (m,) float array, m
            Between the centres.
        first, second : (m,) float arrays, m
            Radii.
        """
        along = (distance**2 + first**2 - second**2) / (2.0 * distance)
        return np.sqrt(np.where(distance < first + second, np.maximum(first**2 - along**2, 0.0), 0.0))

    def wall_radius(self, distance, radius):
        """The same with a wall.

        Parameters
        ----------
        distance, radius : (w,) float arrays, m
        """
        return np.sqrt(np.maximum(radius**2 - distance**2, 0.0))


@dataclass(frozen=True)
class Hertz:
    """Contact radius of elastic spheres: a^2 = R delta by their overlap, or a^3 = 3 F R / (4 E*) by their force.

    1/R = 1/R_1 + 1/R_2 and 1/E* = 2 (1 - nu^2)/E (Johnson, Contact Mechanics, 1985, section 4.2). By the overlap, as
    without a Contacts with forces, no modulus is needed; a simulation with a modulus made soft, to spare steps,
    overlaps too much and asks for forces and the true modulus.

    Parameters
    ----------
    young : float, Pa, optional
    poisson : float

    Examples
    --------
    >>> import numpy as np
    >>> from demheat import grains
    >>> grains.Hertz().radius(np.array([1.92, 2.1]), 1.0, 1.0).round(12).tolist()  # a^2 = 0.5 x 0.08; apart
    [0.2, 0.0]
    """

    young: float | None = None
    poisson: float = 0.3

    def __post_init__(self):
        if self.young is not None:
            finite("Hertz.young", self.young, "a finite number > 0 Pa", lambda v: v > 0)
        finite("Hertz.poisson", self.poisson, "from -1 to 0.5", lambda v: -1 < v <= 0.5)

    def radius(self, distance: ArrayLike, first: ArrayLike, second: ArrayLike) -> np.ndarray:
        """Contact radius of each pair by its overlap, (m,) float array, m.

        Parameters
        ----------
        distance, first, second : (m,) float arrays, m
            Between the centres, and radii.
        """
        return np.sqrt(reduced(first, second) * np.maximum(first + second - distance, 0.0))

    def wall_radius(self, distance, radius):
        """The same with a wall.

        Parameters
        ----------
        distance, radius : (w,) float arrays, m
        """
        return np.sqrt(radius * np.maximum(radius - distance, 0.0))

    def pressed(self, force, first, second):
        """Contact radius of each pair by the force that presses it together, (m,) float array, m.

        Parameters
        ----------
        force : (m,) float array, N
            0 or less presses nothing.
        first, second : (m,) float arrays, m
            Radii.

        Raises
        ------
        ValueError
            Without a modulus.
        """
        if self.young is None:
            raise ValueError("Hertz.young = None: contact radii by forces need a modulus, > 0 Pa")
        stiffness = self.young / (2.0 * (1.0 - self.poisson**2))
        return np.cbrt(0.75 * np.maximum(force, 0.0) * reduced(first, second) / stiffness)


@dataclass(frozen=True, kw_only=True)
class Fixed:
    """One contact radius over that of the smaller grain for all pairs that touch.

    Parameters
    ----------
    ratio : float
        Contact radius over the radius of the smaller grain.
    within : float
        What is nearer than so many radii of the smaller grain touches: rounding of a file, or less.

    Examples
    --------
    >>> import numpy as np
    >>> from demheat import grains
    >>> grains.Fixed(ratio=0.1).radius(np.array([2.0, 2.1]), np.array([1.0, 1.0]), np.array([1.0, 1.0])).tolist()
    [0.1, 0.0]
    """

    ratio: float
    within: float = 1e-6

    def __post_init__(self):
        finite("Fixed.ratio", self.ratio, "a number > 0, below 1", lambda v: 0 < v < 1)
        finite("Fixed.within", self.within, "a number >= 0, at most 0.5", lambda v: 0 <= v <= 0.5)

    def radius(self, distance: ArrayLike, first: ArrayLike, second: ArrayLike) -> np.ndarray:
        """Contact radius of each pair, (m,) float array, m; 0 where spheres do not touch.

        Parameters
        ----------
        distance, first, second : (m,) float arrays, m
            Between the centres, and radii.
        """
        least = np.minimum(first, second)
        return np.where(distance <= first + second + self.within * least, self.ratio * least, 0.0)

    def wall_radius(self, distance, radius):
        """The same with a wall.

        Parameters
        ----------
        distance, radius : (w,) float arrays, m
        """
        return np.where(distance <= (1.0 + self.within) * radius, self.ratio * radius, 0.0)


def reduced(first, second):
    """Radius R of 1/R = 1/R_1 + 1/R_2, m; infinite radii are walls."""
    return 1.0 / (1.0 / np.asarray(first) + 1.0 / np.asarray(second))


def resistivity(first, second):
    """1/k_1 + 1/k_2, m K/W; infinite conductivities are walls."""
    return 1.0 / np.asarray(first) + 1.0 / np.asarray(second)


def contact_conductance(radius, resistivity):
    """Conductance of contacts, 4 a / (1/k_1 + 1/k_2)."""
    return 4.0 * radius / resistivity


def check_conductivity(name, value) -> float:
    """A conductivity > 0 as a float, or a ValueError."""
    valid = f"a finite number > 0 W/(m K), from {LEAST:g} to {MOST:g}"
    return finite(name, value, valid, lambda v: LEAST <= v <= MOST)
