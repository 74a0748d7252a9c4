"""Domains cut out of larger packings, and large packings by repeating a periodic one."""

import math
import warnings
from collections.abc import Callable, Sequence

import numpy as np

from demheat.packing.base import Packing, check_box, check_domain, make_packing
from demheat.packing.gate import check_packing
from demheat.powers import cube_root
from demheat.runtime.limits import check_memory
from demheat.scene.bodies import ROUND_AXES, check_name, from_middle, round_radius
from demheat.scene.inputs import chosen, vector
from demheat.scene.shapes.morton import morton_order

KEEP = ("inside", "center")
# Radii that reach beyond the domain by less than this part of its size lie inside: rounding of a packing's own walls.
ROUNDING = 1e-12
# Beyond so many particles a packing is replicas of so many at most: a few CPU-seconds to make one of them, instead of
# 90 for each million.
UNREPEATED, REPLICA, LEAST_REPLICA = 2_000_000, 250_000, 1000
# Least bytes that a particle takes.
BYTES = 32
# Least distance of a centre to a wall, and depth down to which particles are drawn off it, in mean radii. Found on the
# centred sphere, 3e4 particles, contrasts 0.01, 5, 100: -.002, -.002, -.006 % in replicas, -.006, -.006, -.016 %
# relaxed between walls; at (0.5, 4) it is -.004, -.004, -.010 %.
DRAWN = (1.0, 6.0)


def __getattr__(name):
    if name == "tile":
        warnings.warn("tile is now replicate", DeprecationWarning, stacklevel=2)
        return replicate
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def cut(
    packing: Packing,
    domain: str = "box",
    *,
    size: Sequence[float] | None = None,
    center: Sequence[float] | None = None,
    keep: str = "inside",
) -> Packing:
    """Cut a domain out of a larger packing.

    The cut is rough: spheres lie at all distances from it, as in a sawn specimen, so that its outer layer is less dense
    than that of a packing made between hard walls (`relax` and `lsa` make these in every domain), and few spheres touch
    it.

    Parameters
    ----------
    packing : Packing
        A box.
    domain : {"box", "cylinder-x", "cylinder-y", "cylinder-z", "sphere"}
    size : (3,) sequence of float, m, optional
        Box in which the domain is inscribed, at most the packing's; default the largest one: the packing's box, its
        sides across round axes shortened to the least of them.
    center : (3,) sequence of float, m, optional
        Of that box, in the packing's coordinates; default the middle. It may cross periodic faces.
    keep : {"inside", "center"}
        Keep the spheres that lie wholly inside, or those whose centre does.

    Returns
    -------
    Packing
        With its own box at the origin. An axis that is not round and keeps its full length keeps its walls or its
        period; ends elsewhere are cut.

    Raises
    ------
    ValueError
        If an argument is not as described, the domain reaches beyond a wall, or no sphere is left.

    Examples
    --------
    >>> from demheat.packing.domain import cut
    >>> from demheat.packing.relax import relax
    >>> cut(relax(1000, seed=0), "sphere").domain
    'sphere'
    """
    _check_box_packing(packing)
    check_name("domain", domain)
    chosen("keep", keep, KEEP)
    axes = list(ROUND_AXES[domain])
    sides, full = _checked_size(packing, size, axes)
    whole = full & ~np.isin(np.arange(3), axes)
    periodic = packing.periodic & whole
    check_domain(domain, sides, periodic)
    corner = _checked_center(packing, center, sides) - sides / 2
    # Whole axes keep their origin, walls and period; elsewhere each sphere is met at its image nearest to the middle.
    corner[whole] = 0.0
    local = packing.centers - corner
    turns = np.floor((local - sides / 2) / packing.size + 0.5)
    local -= np.where(packing.periodic & ~whole, turns * packing.size, 0.0)
    kept = _reach_inside(local, packing.radii if keep == "inside" else 0.0, domain, sides, ~whole)
    if not kept.any():
        raise ValueError(f"size = {sides.tolist()}: no sphere of the packing is left in this {domain}; must be larger")
    provenance = {"algorithm": "cut", "keep": keep, "corner": corner.tolist(), "of": packing.provenance}
    return make_packing(local[kept], packing.radii[kept], sides, periodic, provenance, domain=domain)


def replicate(packing: Packing, repeats: Sequence[int], *, keep: Callable | None = None) -> Packing:
    """Repeat a packing along its periodic axes.

    The larger packing is a legitimate periodic one, but holds no more information than one replica: a homogeneous
    periodic network has the very same conductivity, and scatter between packings does not fall with their number.

    Parameters
    ----------
    packing : Packing
    repeats : (3,) sequence of int
        Replicas along each axis; 1 where there are walls.
    keep : callable (n, 3) float array, m -> (n,) bool array, optional
        Which centres are kept: of the rest no memory is taken.

    Returns
    -------
    Packing
        Replica after replica, each in the order of the given packing, so that neighbours in space stay near in memory.
        provenance["repeats"] says how often it was repeated, "of" how the replica was made.

    Raises
    ------
    ValueError
        If a number is not an integer >= 1, or an axis with walls is to be repeated.

    Examples
    --------
    >>> from demheat.packing.domain import replicate
    >>> from demheat.packing.relax import relax
    >>> replicate(relax(200, seed=0), (2, 1, 1)).number
    400
    """
    check_packing(packing)
    counts = np.array(repeats)
    if counts.shape != (3,) or counts.dtype.kind not in "iu" or np.any(counts < 1):
        raise ValueError(f"repeats = {repeats!r}: must be three integers >= 1")
    if np.any((counts > 1) & ~packing.periodic):
        raise ValueError(
            f"repeats = {repeats!r} of a packing with periodic = {packing.periodic.tolist()}: must be 1 along axes "
            "with walls"
        )
    if keep is None:
        check_memory("repeats", counts.tolist(), BYTES * packing.number * math.prod(counts.tolist()), power=3)
    cells = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1).reshape(-1, 3)
    cells = cells[morton_order(cells + 0.5, counts.astype(float))]
    n, size = packing.number, packing.size * counts
    if keep is None:
        centers, radii = np.empty((len(cells) * n, 3)), np.tile(packing.radii, len(cells))
        for k, cell in enumerate(cells):
            np.add(packing.centers, cell * packing.size, out=centers[k * n : (k + 1) * n])
    else:
        centers, radii = _kept(packing, cells, keep)
    # Rounding may put the last replica's last centre on the far face, which is the first.
    beyond = packing.periodic & (centers >= size)
    centers[beyond] = 0.0
    provenance = {
        "algorithm": "replicate",
        "repeats": counts.tolist(),
        "number": packing.number * len(cells),
        "of": packing.provenance,
    }
    return packing._replace(centers=centers, radii=radii, size=size, provenance=provenance)


def _kept(packing, cells, keep):
    """Centres and radii of replicas in some cells, those that are kept."""
    centers, radii = [np.empty((0, 3))], [np.empty(0)]
    for cell in cells:
        moved = packing.centers + cell * packing.size
        good = keep(moved)
        centers.append(moved[good])
        radii.append(packing.radii[good])
    return np.concatenate(centers), np.concatenate(radii)


def replica_counts(number: int, size: Sequence[float], replicas: int | None = None) -> np.ndarray:
    """How often a packing of so many particles repeats a smaller one along each axis, (3,) int array."""
    if not isinstance(number, int | np.integer) or isinstance(number, bool) or number < 1:
        raise ValueError(f"number = {number!r}: must be an integer >= 1")
    sides, _ = check_box(size, True)
    if replicas is None:
        edge = cube_root(sides.prod() * REPLICA / number) if number > UNREPEATED else sides.max()
        return np.ceil(sides / edge - ROUNDING).astype(int)
    if not isinstance(replicas, int | np.integer) or isinstance(replicas, bool) or replicas < 1:
        raise ValueError(f"replicas = {replicas!r}: must be an integer >= 1, or None")
    counts = np.round(replicas * sides / sides.min())
    needed = LEAST_REPLICA * counts.prod()
    if replicas > 1 and number < needed:
        made = " x ".join(f"{count:.0f}" for count in counts)
        raise ValueError(
            f"replicas = {replicas}: makes {made} replicas of at least {LEAST_REPLICA} particles, which need "
            f"{needed:.0f} of them; must be fewer for {number}"
        )
    return counts.astype(int)


def walled(packing: Packing, mean: float | None = None) -> Packing:
    """The packing with walls in place of its periods, its outer particles drawn off them.

    Coordinates within `DRAWN[1]` mean radii of a face are squeezed towards the inside so that no centre is nearer to it
    than `DRAWN[0]`: cells at the wall are no slivers. Particles there overlap, and some reach beyond the walls: this
    serves tessellations, not laws of contacts.
    """
    check_packing(packing)
    centers, mean = packing.centers.copy(), packing.radii.mean() if mean is None else mean
    for k in np.flatnonzero(packing.periodic):
        least, depth = np.array(DRAWN) * min(mean, 0.5 * packing.size[k] / DRAWN[1])
        x = centers[:, k]
        off = np.minimum(x, packing.size[k] - x)
        moved = np.where(off < depth, least * (1.0 - off / depth), 0.0)
        x += np.where(2.0 * x < packing.size[k], moved, -moved)
    return packing._replace(
        centers=centers, periodic=np.zeros(3, dtype=bool), provenance=packing.provenance | {"walls": "drawn in"}
    )


def _check_box_packing(packing):
    check_packing(packing)
    if packing.domain != "box":
        raise ValueError(f"packing in a {packing.domain}: must be in a box to be cut")


def _checked_size(packing, size, axes):
    """Sides of the box to cut, and which of them are the packing's own."""
    if size is None:
        sides = packing.size.copy()
        if axes:
            sides[axes] = sides[axes].min()
    else:
        sides, _ = check_box(size, False)
    if np.any(sides > packing.size * (1 + ROUNDING)):
        raise ValueError(f"size = {sides.tolist()}: must not exceed the packing's box, {packing.size.tolist()}")
    return sides, sides >= packing.size * (1 - ROUNDING)


def _checked_center(packing, center, sides):
    middle = packing.size / 2 if center is None else np.array(vector("center", center))
    least, room = sides / 2, ROUNDING * packing.size
    beyond = ~packing.periodic & ((middle < least - room) | (middle > packing.size - least + room))
    if beyond.any():
        raise ValueError(
            f"center = {middle.tolist()} of a domain of size {sides.tolist()}: reaches beyond the walls of the "
            f"packing, 0 to {packing.size.tolist()}"
        )
    return middle


def _reach_inside(local, reach, domain, sides, is_cut):
    """Which spheres, that reach so far around their centre, lie in the domain; its flat walls are cut on some axes."""
    inside = np.ones(len(local), dtype=bool)
    for k in set(np.flatnonzero(is_cut)) - set(ROUND_AXES[domain]):
        inside &= (local[:, k] >= reach) & (local[:, k] <= sides[k] - reach)
    if ROUND_AXES[domain]:
        # A hair less than the radius: coordinates moved to the box's corner are rounded.
        inside &= from_middle(local, domain, sides) + reach <= round_radius(domain, sides) * (1 - ROUNDING)
    return inside
