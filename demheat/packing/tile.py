"""Packings that cost nothing: a small periodic tile, made once, repeated and scaled to a box.

Tiles come with the package (`demheat.packing.tile_recipe` made them) and know nothing of a scene, as the points of a
quadrature rule know nothing of what they integrate. Their particles are equal, each in the centroid of its cell.
"""

import hashlib
import math
from collections.abc import Callable
from functools import cache, lru_cache
from itertools import product
from pathlib import Path
from typing import NamedTuple

import numpy as np

from demheat.packing.base import Packing, check_box
from demheat.powers import cube_root
from demheat.scene.shapes.morton import morton_order

FILE = Path(__file__).with_name("tile.npy")
CHECKSUM = "3433fdf7fd2266cb23508c20928baf91ce7840b25baf042e1f35d2e84a0eed01"
# Tiles have from 50 particles to 769, each RATIO times as many as the one before; steps are from 100.
RATIO, STEPS = 1.06, range(-12, 36)
# Coordinates are kept as whole numbers of so many parts of the edge: a thousandth of the least distance.
PARTS = 1 << 16
# Of the spheres over the body, as of packings that are relaxed: lengths in mean radii mean the same in both.
PHI = 0.64
# In periodic boxes tiles are stretched along one axis over another by this factor at most, and the number of particles
# is met to within OFF. A stretch of 1.25 adds 3e-5 to a conductivity, one of 1.67 8e-5 (one sphere of contrast 10,
# 27 000 particles).
STRETCH, OFF = 1.3, 0.05
# Between walls: centres nearer to one than LAYER mean radii are put FIRST from it, so that cells there are no slivers.
# Found on the centred sphere, 8000 and 27 000 particles, contrasts .01, 10, 100: from 1.7 to .8 an error of .0005,
# .0013, .0022 %; to 1.0 .0006, .0015, .0027; drawn in over six radii .0028, .0061, .0102.
LAYER, FIRST = 1.7, 0.8
# Mean radii: no place in a tile is farther from a particle.
FARTHEST = 1.6


class Choice(NamedTuple):
    """A tile, how often it is repeated along each axis, and its edges there, m."""

    number: int
    counts: tuple[int, int, int]
    edges: tuple[float, float, float]


class Places(NamedTuple):
    """Which point of which tile the particles of a packing are."""

    points: np.ndarray  # (t, 3) m, of the tile at the box's corner
    edges: np.ndarray  # (3,) m, of a tile
    counts: np.ndarray  # (3,) of tiles along each axis
    place: np.ndarray  # (n,) t times the number of the tile, along the last axis first, plus the point's; -1 if moved


def numbers() -> list[int]:
    """How many particles the tiles have."""
    return [round(100 * RATIO**step) for step in STEPS]


def fits(number: int, size, periodic: bool) -> bool:
    """Whether tiles make a packing of about so many particles in a box."""
    return _chosen(number, size, periodic) is not None


def tiled(number: int, *, size, periodic: bool = True, seed: int = 0, keep: Callable | None = None) -> Packing:
    """A packing of tiles, of about so many particles, turned and shifted by the seed.

    `keep` says which centres are kept, (n, 3) float array, m -> (n,) bool array: of the rest no memory is taken.
    """
    size, _ = check_box(size, periodic)
    choice = _chosen(number, size, periodic)
    if choice is None:
        raise ValueError(f"number = {number!r} in a box of {size.tolist()}: no tile fits it")
    radius, parts, made = _radius(choice), [], 0
    for _, centers, _ in _laid(choice, size, periodic, seed):
        made += len(centers)
        parts.append(centers if keep is None else centers[keep(centers)])
    centers = _within(np.concatenate(parts), size, periodic)
    provenance = {"algorithm": "tile", "seed": int(seed), "tile": choice.number, "repeats": list(choice.counts)}
    provenance |= {"asked": int(number), "stretch": max(choice.edges) / min(choice.edges)}
    provenance |= {"number": made, "phi": PHI}
    return Packing(centers, np.full(len(centers), radius), size, np.full(3, periodic), provenance)


def choice_of(packing: Packing) -> Choice | None:
    """The tile and repeats that a packing says that it is made of; None if it says nothing, or has other radii."""
    asked, seed = (packing.provenance.get(name) for name in ("asked", "seed"))
    if packing.provenance.get("algorithm") != "tile" or not (isinstance(asked, int) and isinstance(seed, int)):
        return None
    choice = _chosen(asked, packing.size, bool(packing.periodic.all())) if asked > 0 and seed >= 0 else None
    return None if choice is None or np.any(packing.radii != _radius(choice)) else choice


def places_of(packing: Packing) -> Places | None:
    """Where the particles of a packing stand in tiles; None if it is not what `tiled` makes, to the bit."""
    choice, periodic = choice_of(packing), bool(packing.periodic.all())
    if choice is None:
        return None
    seed = packing.provenance["seed"]
    parts, place = [], []
    for cell, centers, which in _laid(choice, packing.size, periodic, seed):
        first = choice.number * int(np.ravel_multi_index(cell, choice.counts))
        parts.append(centers)
        place.append(np.where(which < 0, -1, which + first).astype(np.int32))
    if not np.array_equal(_within(np.concatenate(parts), packing.size, periodic), packing.centers):
        return None
    edges = np.array(choice.edges)
    return Places(_turned(_tile(choice.number), seed) * edges, edges, np.array(choice.counts), np.concatenate(place))


def _laid(choice, size, periodic, seed):
    """Tile by tile its place among them, its centres, and which of its points these are: -1 where they were moved."""
    points = _turned(_tile(choice.number), seed)
    cells = np.stack(np.meshgrid(*map(np.arange, choice.counts), indexing="ij"), axis=-1).reshape(-1, 3)
    for cell in cells[morton_order(cells + 0.5, np.array(choice.counts, dtype=float))]:
        centers, which = (points + cell) * choice.edges, np.arange(choice.number)
        if not periodic:
            which = np.flatnonzero(np.all(centers <= size, axis=1))
            laid, centers = centers[which], _layered(centers[which], size, _radius(choice))
            which = np.where(np.any(centers != laid, axis=1), -1, which)
        yield cell, centers, which


def _radius(choice):
    return cube_root(0.75 / math.pi * PHI * math.prod(choice.edges) / choice.number)


def _within(centers, size, periodic):
    """Rounding may put the last one on the far face of a period, which is the first."""
    return np.minimum(centers, np.nextafter(size, 0.0)) if periodic else centers


def _chosen(number, size, periodic):
    return (_periodic if periodic else _walled)(number, tuple(float(side) for side in size))


@lru_cache
def _periodic(number, size):
    """The tile and repeats that meet a number in a periodic box with the least stretch; None if none does."""
    best, least = None, math.inf
    for tile in numbers():
        edge = cube_root(tile * math.prod(size) / number)
        low = [max(1, math.floor(side / edge)) for side in size]
        for more in product((0, 1), repeat=3):
            counts = [one + another for one, another in zip(low, more, strict=True)]
            edges = [side / count for side, count in zip(size, counts, strict=True)]
            stretch, off = max(edges) / min(edges), abs(tile * math.prod(counts) / number - 1.0)
            # As much as larger tiles are alike less often: of two that fit as well.
            cost = math.log(stretch) / math.log(STRETCH) + off / OFF - 0.3 * math.log(tile)
            if stretch <= STRETCH and off <= OFF and cost < least:
                best, least = Choice(tile, tuple(counts), tuple(edges)), cost
    return best


@lru_cache
def _walled(number, size):
    """The largest tile that a walled box of so many particles is cut from, at any place; None for very few."""
    tile = max((tile for tile in numbers() if tile <= number), default=None)
    if tile is None:
        return None
    edge = cube_root(tile * math.prod(size) / number)
    return Choice(tile, tuple(math.ceil(side / edge) for side in size), (edge,) * 3)


def _turned(points, seed):
    """The tile's points turned and mirrored as a cube may be, and shifted, as a seed says."""
    rng = np.random.default_rng([seed, 643])
    turned = (rng.choice([-1.0, 1.0], 3) * points[:, rng.permutation(3)] + rng.random(3)) % 1.0
    return np.ascontiguousarray(turned)  # columns in another order are columns in memory: compiled for by themselves


def _layered(centers, size, radius):
    """Centres with those beside walls in one layer."""
    off = np.minimum(centers, size - centers)
    near = off < LAYER * radius
    first = np.minimum(FIRST * radius, 0.5 * size)
    return np.where(near, np.where(2.0 * centers < size, first, size - first), centers)


@cache
def _tile(number):
    """Points of a tile in the unit cube, along a curve that fills it, (number, 3) float array."""
    starts = np.concatenate([[0], np.cumsum(numbers())])
    which = numbers().index(number)
    points = _tiles()[starts[which] : starts[which + 1]] / PARTS
    return points[morton_order(points, np.ones(3))]


@cache
def _tiles():
    """All tiles as they are stored, one after the other, (n, 3) uint16 array."""
    try:
        found = np.load(FILE, allow_pickle=False)
    except (OSError, EOFError, ValueError) as error:
        raise RuntimeError(
            f"{FILE.name}: the tiles of the package cannot be read ({error}); install it again"
        ) from None
    if hashlib.sha256(found.tobytes()).hexdigest() != CHECKSUM:
        raise RuntimeError(f"{FILE.name}: not the tiles that came with the package; install it again")
    return found
