"""Insulated cracks without thickness: discs and rectangles that links do not cross."""

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from demheat.damage.links import cut, pairs
from demheat.network.base import Network, image_shifts, row_numbers
from demheat.packing.base import Packing, make_packing
from demheat.packing.twins.conforming import NEAR_WALL, OFFSET, margin
from demheat.packing.twins.patterns import SPACING
from demheat.scene.inputs import finite, vector
from demheat.scene.shapes.directions import across
from demheat.scene.shapes.patterns import SQUARE

# Side of the square that stands for one twin of an even pattern, in mean radii.
# Particles nearer to a crack than so many mean radii give way.
CLEARED = 0.9
PITCH = SQUARE * SPACING
# Half the width, in mean radii, below which cracks are said to be small: what a disc takes away was 61 % too large at
# 2.0, 20 % at 4.0 and 12 % at 8.1.
SMALL = 2.0
# Touch points nearer to each other than this part of a pitch are one: where cracks meet each other or their images.
APART = 0.6
# Cosine of a right angle, at most.
STRAIGHT = 1e-9


@dataclass(frozen=True)
class Disc:
    """A flat round crack.

    Parameters
    ----------
    center : (3,) sequence of float, m
    radius : float, m
    normal : (3,) sequence of float
        Of any length but 0.

    Examples
    --------
    >>> from demheat import damage
    >>> damage.Disc(center=(0.5, 0.5, 0.5), radius=0.25, normal=(0, 0, 1)).beyond(0.5, 0.0).item()
    0.25
    """

    center: tuple[float, float, float]
    radius: float
    normal: tuple[float, float, float]

    def __post_init__(self):
        object.__setattr__(self, "center", vector("Disc.center", self.center))
        object.__setattr__(self, "radius", finite("Disc.radius", self.radius, "a finite number > 0 m", lambda v: v > 0))
        object.__setattr__(self, "normal", vector("Disc.normal", self.normal))
        if not any(self.normal):
            raise ValueError(f"Disc.normal = {self.normal!r}: must not be 0 along all axes")

    @property
    def reach(self) -> float:
        """Largest distance of its points from the centre, m."""
        return self.radius

    @property
    def width(self) -> float:
        """Half its least extent, m."""
        return self.radius

    @property
    def frame(self) -> np.ndarray:
        """Unit vectors along the crack, two, and across it, the rows of a (3, 3) float array."""
        n = np.array(self.normal) / np.linalg.norm(self.normal)
        return np.array([*across(n), n])

    def beyond(self, u: ArrayLike, v: ArrayLike) -> np.ndarray:
        """Distance from the rim of points of its plane, m, negative inside.

        Parameters
        ----------
        u, v : (n,) float arrays, m
            Along the frame, from the centre.
        """
        return np.hypot(u, v) - self.radius

    def pattern(self, pitch: float) -> np.ndarray:
        """Points in rings, each for the square of a pitch, the last ring outside of the rim: (k, 2) float array, m.

        None on what is smaller than a pitch.

        Parameters
        ----------
        pitch : float, m
        """
        rings = round(self.radius / pitch)
        if rings == 0:
            return np.empty((0, 2))
        step, points = self.radius / rings, []
        for ring in range(rings + 1):
            radius = (ring + 0.5) * step
            count = max(3, round(2 * math.pi * radius / step))
            turn = 2 * math.pi * (np.arange(count) + 0.5 * (ring % 2)) / count
            points.append(radius * np.column_stack([np.cos(turn), np.sin(turn)]))
        return np.concatenate(points)


@dataclass(frozen=True)
class Rectangle:
    """A flat rectangular crack; endless along an axis if it reaches from face to face of the box.

    Parameters
    ----------
    center : (3,) sequence of float, m
    along, across : (3,) sequence of float, m
        From the centre to the middles of two sides, at right angles.

    Examples
    --------
    >>> from demheat import damage
    >>> damage.Rectangle(center=(0.5, 0.5, 0.5), along=(0.5, 0, 0), across=(0, 0.2, 0)).sides.tolist()
    [0.5, 0.2]
    """

    center: tuple[float, float, float]
    along: tuple[float, float, float]
    across: tuple[float, float, float]

    def __post_init__(self):
        for name in ("center", "along", "across"):
            object.__setattr__(self, name, vector(f"Rectangle.{name}", getattr(self, name)))
        u, v = np.array(self.along), np.array(self.across)
        if not (u.any() and v.any() and abs(u @ v) <= STRAIGHT * np.linalg.norm(u) * np.linalg.norm(v)):
            raise ValueError(
                f"Rectangle.along = {self.along}, across = {self.across}: must be two vectors at right angles, not 0"
            )

    @property
    def sides(self) -> np.ndarray:
        """Half its sides, (2,) float array, m."""
        return np.linalg.norm([self.along, self.across], axis=1)

    @property
    def reach(self) -> float:
        """Largest distance of its points from the centre, m."""
        return float(np.linalg.norm(self.sides))

    @property
    def width(self) -> float:
        """Half its least extent, m."""
        return float(self.sides.min())

    @property
    def frame(self) -> np.ndarray:
        """Unit vectors along the crack, two, and across it, the rows of a (3, 3) float array."""
        u, v = (np.array(each) / np.linalg.norm(each) for each in (self.along, self.across))
        return np.array([u, v, np.cross(u, v)])

    def beyond(self, u: ArrayLike, v: ArrayLike) -> np.ndarray:
        """Distance from the rim of points of its plane, m, negative inside.

        Parameters
        ----------
        u, v : (n,) float arrays, m
            Along the frame, from the centre.
        """
        out = np.column_stack([np.abs(u), np.abs(v)]) - self.sides
        return np.where(np.any(out > 0, axis=1), np.linalg.norm(np.maximum(out, 0), axis=1), out.max(axis=1))

    def pattern(self, pitch: float) -> np.ndarray:
        """Points on a grid, each for the square of a pitch, one row outside of each side; see `Disc.pattern`."""
        rows = [round(2 * side / pitch) for side in self.sides]
        if 0 in rows:
            return np.empty((0, 2))
        lines = [
            side * ((2 * np.arange(-1, count + 1) + 1) / count - 1)
            for side, count in zip(self.sides, rows, strict=True)
        ]
        return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2)


def check_cracks(cracks: Sequence[Disc | Rectangle]) -> tuple:
    """Cracks as a tuple, or a ValueError."""
    found = tuple(cracks) if isinstance(cracks, list | tuple) else None
    if found is None or not all(isinstance(each, Disc | Rectangle) for each in found):
        raise ValueError(f"cracks = {cracks!r}: must be a sequence of Disc and Rectangle")
    return found


def warn_of_small(packing: Packing, cracks) -> None:
    """Say which cracks are small for the particles of a packing."""
    radius = float(packing.radii.mean())
    small = [number for number, crack in enumerate(cracks) if crack.width < SMALL * radius]
    if small:
        warnings.warn(
            f"cracks {small[:8]} are small for particles of diameter {2 * radius:.3g} m (the smallest is "
            f"{2 * min(crack.width for crack in cracks):.3g} m wide): what they take away is off by half or more; use "
            "more particles",
            stacklevel=3,
        )


def seamed(packing: Packing, cracks) -> Packing:
    """A packing with particles mirrored in the planes of cracks, so that facets lie on them and end at their rims.

    As at interfaces (`demheat.packing.twins.conforming`): pairs half a mean radius from the plane, and no other
    particle so near or so heavy that a facet of it reaches it. The outermost pairs lie outside of the rim.
    """
    radius = float(packing.radii.mean())
    pitch, found, near = PITCH * radius, [np.empty((0, 2, 3))], np.full(packing.number, np.inf)
    for crack in cracks:
        frame = crack.frame
        points = np.array(crack.center) + crack.pattern(pitch) @ frame[:2]
        found.append(points[:, None] + OFFSET * radius * np.array([[-1.0], [1.0]]) * frame[2])
        for _, rest in _images(packing, crack, packing.centers):
            u, v, w = (rest @ frame.T).T
            # The last row lies half a pitch outside of the rim.
            np.minimum(near, np.hypot(w, np.maximum(crack.beyond(u, v) - pitch, 0.0)), out=near)
    twins = _fitting(packing, np.concatenate(found), radius).reshape(-1, 3)
    keep = near > CLEARED * radius
    most = near**2 - margin(radius)
    kept = np.minimum(packing.radii**2, most)[keep]
    raised = np.concatenate([kept, np.full(len(twins), radius**2)])
    raised += max(0.0, 0.01 * radius**2 - kept.min(initial=np.inf))
    provenance = {**packing.provenance, "seam": len(twins)}
    centers = np.concatenate([packing.centers[keep], twins])
    return make_packing(centers, np.sqrt(raised), packing.size, packing.periodic, provenance)


def cracked(network: Network, cracks: Sequence[Disc | Rectangle]) -> Network:
    """A network without the links that cross cracks, in a periodic cell images of cracks included.

    Parameters
    ----------
    network : Network
    cracks : sequence of Disc and Rectangle

    Returns
    -------
    Network
        That is not `whole`, see `demheat.damage.without_links`.

    Raises
    ------
    ValueError
        If the cracks are not such a sequence.

    Examples
    --------
    >>> from demheat import Laguerre, damage, gallery
    >>> from demheat.dem.networks import network_of
    >>> from demheat.packing.relax import relax
    >>> network = network_of(gallery.slab(size=(1.0, 1.0, 1.0), periodic=True), relax(500, seed=0), Laguerre())
    >>> crack = damage.Disc(center=(0.5, 0.5, 0.5), radius=0.3, normal=(0, 0, 1))
    >>> print(damage.cracked(network, [crack]).conductance.sum() < network.conductance.sum())
    True
    """
    cracks = check_cracks(cracks)
    both = pairs(network)
    start = network.centers[row_numbers(network.indptr)[both[0]]]
    stop = network.centers[network.indices[both[0]]] + image_shifts(network.image[both[0]], network.size)
    half = 0.5 * (stop - start)
    gone, longest = np.zeros(len(start), bool), float(np.linalg.norm(half, axis=1).max(initial=0.0))
    for crack in cracks:
        for here, middle in _images(network, crack, start + half, longest):
            gone[here] |= _crosses(crack, middle, half[here])
    return cut(network, both, gone)


def _crosses(crack, middle, half):
    """Whether segments from middle - half to middle + half, relative to the centre, meet a crack."""
    u, v, w = (crack.frame @ middle.T)[:, :]
    du, dv, dw = crack.frame @ half.T
    part = np.divide(-w, dw, out=np.full_like(w, np.inf), where=dw != 0)
    # Ends in the plane belong to its upper side: then one of two links through a point is cut, not both.
    through = (w - dw < 0) != (w + dw < 0)
    part = np.where(through, part, 0.0)
    return through & (crack.beyond(u + part * du, v + part * dv) <= 0)


def _images(body, crack, points, more=np.inf):
    """For each image of a crack the points within its reach and more: their numbers, and offsets from its centre."""
    shifts = product((-1, 0, 1), repeat=3) if np.all(body.periodic) else [(0, 0, 0)]
    tree = cKDTree(points) if np.isfinite(more) else None
    for shift in shifts:
        center = np.array(crack.center) + np.array(shift) * body.size
        here = np.arange(len(points)) if tree is None else np.array(tree.query_ball_point(center, crack.reach + more))
        if len(here):
            here = here.astype(np.int64)
            yield here, points[here] - center


def _fitting(packing, twins, radius):
    """The pairs that lie in the box, of a periodic cell all, and apart from those before them, (k, 2, 3) array."""
    if packing.periodic.all():
        twins = twins % packing.size
        middle, box = _middles(twins, packing.size) % packing.size, packing.size
    else:
        margin = NEAR_WALL * OFFSET * radius
        twins = twins[np.all((twins > margin) & (twins < packing.size - margin), axis=(1, 2))]
        middle, box = twins.mean(axis=1), None
    keep = np.ones(len(twins), bool)
    close = cKDTree(middle, boxsize=box).query_pairs(APART * PITCH * radius, output_type="ndarray")
    for first, later in close[np.lexsort(close.T[::-1])]:
        keep[later] &= not keep[first]
    return twins[keep]


def _middles(twins, size):
    """Touch points of pairs that faces of a periodic cell may part."""
    apart = twins[:, 1] - twins[:, 0]
    return twins[:, 0] + 0.5 * (apart - size * np.round(apart / size))
