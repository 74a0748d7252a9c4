"""Radical (Laguerre) tessellation: the transmission surfaces that make a lattice exact for linear fields."""

from contextlib import suppress

import numpy as np

from demheat.network import laguerre_kernels as kernels
from demheat.network.base import Facets
from demheat.network.bins import bin_points
from demheat.network.curved import ROUND_SIDE, round_distances, round_wall, tangents_within
from demheat.network.links_kernels import match_links
from demheat.network.polyhedron_kernels import empty_polyhedron
from demheat.network.repeated_kernels import nothing_known
from demheat.network.sites_kernels import Sites, empty_candidates
from demheat.packing.base import check_domain
from demheat.runtime.progress import stage
from demheat.runtime.threads import shared_out
from demheat.scene import domain_volume

# Rows cut at once, some tenths of a second: bounds the scratch memory and the wait for an interrupt.
BLOCK = 65536
# Chunks of cells that a thread takes at once, some hundredths of a second.
PIECE = 16
# Facets of a chunk of cells that there is room for at first: for each cell, and for a large one of which its squared
# size, weight less the least, is so many squared mean spacings.
ROOM, LARGE = 22, 16
# Half the edge of the box that cells start from, and how far planes of a round wall are looked for at first, in mean
# spacings.
START, REACH = 4.0, 2.5
# Edge of grid cells in mean spacings of the sites in them.
WIDTH = 1.1
# Sites are as large as the root of their weight less the least. Level 0 has those of up to FIRST mean spacings, each
# further level those of up to FACTOR times more.
FIRST, FACTOR, MAX_LEVELS = 1.5, 3.0, 12
# Facets below this fraction of the squared mean spacing are rounding where more than four cells meet in one point.
SLIVER = 1e-11


def laguerre(centers, weights, size, *, periodic=True, domain="box", known=None):
    """Cells of the radical tessellation of weighted points in a box, or in a round body inscribed in it.

    The facet between p and q lies at (d^2 + w_p - w_q)/(2 d) from p; with w = R^2 it is the radical plane of two
    spheres. The facet vectors of every cell sum to zero and the cells fill the body. Cells at a round wall end at
    tangent planes that enclose its exact volume (see `demheat.network.curved`); a cell may meet several of them. Cells
    that are known (see `demheat.network.repeated`) are not cut.
    """
    return tessellated(centers, weights, size, periodic=periodic, domain=domain, known=known)[0]


def tessellated(centers, weights, size, *, periodic=True, domain="box", known=None):
    """The same as `laguerre` with what the search for neighbours cost.

    Should a known cell be another's after all, its neighbours do not see the facets that it has: then all are cut.
    """
    given = centers, weights, size
    if known is not None:
        with suppress(RuntimeError):
            return _tessellated(*given, periodic, domain, known)
    return _tessellated(*given, periodic, domain, nothing_known())


def _tessellated(centers, weights, size, periodic, domain, known):
    centers, weights, size, periodic = _checked(centers, weights, size, periodic)
    check_domain(domain, size, periodic)
    spacing = (domain_volume(domain, size) / len(centers)) ** (1.0 / 3.0)
    wall = round_wall(domain, size, spacing)
    _check_round(centers, wall, domain)
    sites = filed(centers, weights, size, periodic, spacing)
    volumes, number, links, (particle, side, *walls), again = _cut_all(sites, wall, spacing, known)
    del sites
    _check_filled(volumes, domain_volume(domain, size), domain)
    links = _matched(number, links, spacing)
    # Cells so small that all their facets are slivers are as good as hidden.
    volumes[(np.diff(links[0]) == 0) & (np.bincount(particle, minlength=len(volumes)) == 0)] = 0.0
    facets = Facets(*links, particle, np.minimum(side, ROUND_SIDE), *walls, volumes)
    return _with_normals(facets, side, centers, wall), again


def drop_empty_cells(packing, facets):
    """Leave out the points that have no cell."""
    seen = facets.volumes > 0
    if seen.all():
        return packing, facets
    # Hidden points have no number: nobody asks for it.
    number = (np.cumsum(seen) - 1).astype(np.uint32)
    packing = packing._replace(centers=packing.centers[seen], radii=packing.radii[seen])
    return packing, facets._replace(
        indptr=np.append(facets.indptr[:-1][seen], facets.indptr[-1]),  # rows of hidden points are empty
        indices=number[facets.indices],
        wall_particle=number[facets.wall_particle].astype(np.int64),
        volumes=facets.volumes[seen],
    )


def _checked(centers, weights, size, periodic):
    centers = np.ascontiguousarray(centers, dtype=float)
    weights = np.ascontiguousarray(weights, dtype=float)
    size = np.array(size, dtype=float)
    periodic = np.array(np.broadcast_to(periodic, 3), dtype=bool)
    if centers.ndim != 2 or centers.shape[1] != 3 or len(centers) == 0:
        raise ValueError(f"centers: shape {centers.shape}; must be (n, 3) with n > 0")
    if weights.shape != (len(centers),) or not np.all(np.isfinite(weights)):
        raise ValueError(f"weights: shape {weights.shape}; must be ({len(centers)},) finite numbers")
    outside = ~np.all((centers >= 0) & (centers <= size), axis=1)
    if outside.any():
        first = np.flatnonzero(outside)[0]
        raise ValueError(f"centers[{first}] = {centers[first]}: must lie in the box [0, {size}]")
    return centers, weights, size, periodic


def _check_round(centers, wall, domain):
    """Raise ValueError for a centre on or beyond a round wall."""
    if not len(wall.normals):
        return
    off = np.linalg.norm((centers - wall.middle) * wall.across, axis=1)
    radius = (wall.middle * wall.across).max()
    if off.max() >= radius:
        which = int(np.argmax(off))
        raise ValueError(
            f"centers[{which}] = {centers[which].tolist()}: {off[which]:.6g} m off the middle of the {domain}; must be "
            f"less than its radius {radius:.6g} (demheat.packing.relax.settle pushes particles off a wall)"
        )


def filed(centers, weights, size, periodic, spacing):
    """The sites in grids, one for each level of weight."""
    large = np.sqrt(weights - weights.min()) / (FIRST * spacing)
    level = np.ceil(np.log(np.maximum(large, 1.0)) / np.log(FACTOR)).astype(np.int8)
    np.minimum(level, MAX_LEVELS - 1, out=level)
    grids, first = [], 0
    for here in np.flatnonzero(np.bincount(level)):
        rows = np.flatnonzero(level == here)
        width = WIDTH * (np.prod(size) / len(rows)) ** (1.0 / 3.0)
        counts = np.maximum(1, size / width).astype(np.int64)
        start, items = bin_points(centers[rows] if len(rows) < len(centers) else centers, size, counts)
        before = sum(len(grid[4]) for grid in grids)
        items = rows.astype(np.uint32)[items]
        grids.append((weights[rows].max(), counts, first, start + before, items))
        first += len(start)
    heaviest, counts, first, start, items = zip(*grids, strict=True)
    items = np.concatenate(items)
    slots = np.empty((len(items), 4))
    slots[:, :3], slots[:, 3] = centers[items], weights[items]
    grids = np.array(heaviest), np.array(counts), np.array(first), np.concatenate(start), items, slots
    return Sites(centers, weights, size, periodic, *grids)


class _Columns:
    """Columns that grow together to a size that is only guessed at first; what is not yet written takes no memory."""

    def __init__(self, kinds):
        self.used, self.columns = 0, [np.empty(0, kind) for kind in kinds]

    def grow(self, count, share):
        """Room for so many more entries, which are that share of all, as slices of the columns."""
        wanted = self.used + count
        for k, column in enumerate(self.columns):
            if wanted > len(column):
                self.columns[k] = np.empty(int(1.05 * wanted / share) + 64, column.dtype)
                self.columns[k][: self.used] = column[: self.used]
        self.used = wanted
        return [column[wanted - count : wanted] for column in self.columns]

    def done(self):
        return [column[: self.used] for column in self.columns]


FACETS = ("neighbour", "image", "area", "distance")  # of a Cut
LINKS = (np.uint32, np.uint8, float, float)  # of these
AREA = 2
WALLS = (np.int64, np.int64, float, float)  # particle, side, area, distance
# Rows whose links a thread matches at a time.
MATCHED = 16384


def _cut_all(sites, wall, spacing, known):
    """Volumes, numbers of links, columns of links and of walls, and the share of cells begun more than once."""
    n = len(sites.points)
    volumes, number, again = np.empty(n), np.empty(n, np.int32), 0
    links, walls = _Columns(LINKS), _Columns(WALLS)
    with stage("cells") as done:
        for start in range(0, n, BLOCK):
            stop = min(n, start + BLOCK)
            block, parts, begun = _cut_block(start, stop, sites, known, wall, spacing)
            volumes[start:stop], number[start:stop] = block.volume, block.links
            again += begun
            _gather(parts, links.grow(int(block.links.sum()), stop / n), lambda used: slice(used[0]))
            particle, *ends = walls.grow(int(block.ends.sum()), stop / n)
            particle[:] = np.repeat(np.arange(start, stop), block.ends)
            _gather(parts, ends, lambda used: slice(-1, -1 - used[1], -1), (FACETS[0], *FACETS[2:]))
            done(stop / n)
    return volumes, number, links.done(), walls.done(), again / n


def _gather(parts, columns, taken, names=FACETS):
    """Bring facets of all chunks, those that are taken of each by what it used, to columns in the order of the rows."""
    places = {chunk: (cut, place) for chunks, cut in parts for place, chunk in enumerate(chunks.tolist())}
    ordered = [(cut, place, taken(cut.used[place])) for _, (cut, place) in sorted(places.items(), key=lambda at: at[0])]
    for name, column in zip(names, columns, strict=True):
        if len(column):
            np.concatenate([getattr(cut, name)[place, of] for cut, place, of in ordered], out=column)


def _cut_block(start, stop, sites, known, wall, spacing):
    """Cut a block of rows; what became of them, their facets in parts (chunks and Cut), and how many began anew.

    Chunks that had too little room, or saw too little of a round wall, are cut again.
    """
    n, reach, parts = stop - start, REACH * spacing, []
    # A large cell has as many neighbours as lie on its surface.
    room = int(ROOM * kernels.CHUNK + LARGE * (sites.weights.max() - sites.weights.min()) / spacing**2)
    todo = np.arange(-(-n // kernels.CHUNK))
    rows = [np.zeros(n, kind) for kind in (np.int8, np.uint8, float, np.int32, np.int32)]
    while len(todo):
        cut = _empty_cut(rows, len(todo), room)
        round_wall = (None, None)
        if len(wall.normals):
            round_wall = wall, tangents_within(wall, sites.points[start:stop], reach)
        what = todo, start, sites, known, *round_wall, _limits(sites, wall, spacing, reach), cut
        shared_out(_cut_chunks, len(todo), *what, piece=PIECE)
        blind = _unseen(cut.status, len(wall.normals) and reach < 2 * sites.size.max())
        total = cut.used.sum(axis=1)
        full = total > room
        redone = full | np.isin(todo, blind)
        parts.append((todo[~redone], cut if not redone.any() else _kept(cut, ~redone)))
        todo, room, reach = todo[redone], max(room, int(1.1 * total.max())), 1.35 * reach
    return cut, parts, np.count_nonzero(cut.times > 1)


def _cut_chunks(first, last, *what):
    """Cut chunks in places from first to last, with more scratch memory where a cell needs it."""
    *given, cut = what
    at, end, planes, room = first * kernels.CHUNK, last * kernels.CHUNK, kernels.PLANES, kernels.ROOM
    while at < end:
        at = kernels.cut_cells(at, end, *given, empty_candidates(room), empty_polyhedron(planes), cut)
        planes, room = 4 * planes, 4 * room


def _check_filled(volumes, volume, domain):
    defect = volumes.sum() / volume - 1.0
    if abs(defect) > 1e-9:
        raise RuntimeError(f"laguerre: the cells fill the {domain} with a relative defect of {defect:.2e}")


def _unseen(status, rounded):
    """Chunks with cells that a plane of a round wall not yet looked at may cut; RuntimeError where that cannot be."""
    bad = status != kernels.OK
    if not bad.any():
        return np.empty(0, np.int64)
    unsecured = np.count_nonzero(status == kernels.UNSECURED)
    if np.count_nonzero(bad) > unsecured:
        raise RuntimeError(f"laguerre: {np.count_nonzero(bad) - unsecured} cells could not be cut")
    if not rounded:
        raise RuntimeError(f"laguerre: {unsecured} cells reach across the periodic box; use more points")
    return np.unique(np.flatnonzero(bad) // kernels.CHUNK)


def _limits(sites, wall, spacing, reach):
    return kernels.Limits(
        box=START * spacing,
        widest=2.0 * sites.size.max(),
        eps=1e-11 * spacing,
        coarsest=1e-8 * spacing,
        reach=reach,
        lightest=sites.weights.min(),
        # Tangent planes enclose as much as a round body: their corners stand out of its box.
        flat=~sites.periodic & (wall.across == 0.0),
        sliver=SLIVER * spacing**2,
    )


def _empty_cut(rows, chunks, room):
    return kernels.Cut(*rows, np.empty((chunks, 2), np.int64), *(np.empty((chunks, room), kind) for kind in LINKS))


def _kept(cut, good):
    """The same with the facets of some chunks only."""
    return cut._replace(used=cut.used[good], **{name: getattr(cut, name)[good] for name in FACETS})


def _matched(number, links, spacing):
    """Links that both of their cells see, with one area: pointers, indices, image, area, distance.

    The list of columns is used up: of the largest arrays there are, none is kept twice.
    """
    indptr = np.concatenate([[0], np.cumsum(number, dtype=np.int64)])
    matched = np.empty(len(links[AREA]))
    shared_out(match_links, len(number), indptr, *links[: AREA + 1], matched, piece=MATCHED)
    lost = np.flatnonzero(matched == 0.0)
    if len(lost):
        largest = links[AREA][lost].max()
        if largest > 1e-7 * spacing**2:
            raise RuntimeError(f"laguerre: a facet of {largest:.2e} m2 is seen by one of its two cells only")
        indptr -= np.searchsorted(lost, indptr)
    links[AREA] = matched
    del matched
    for k in range(len(links)) if len(lost) else ():
        links[k] = np.delete(links[k], lost)
    return indptr, *links


def _with_normals(facets, side, centers, wall):
    """Facets with outward normals of the box's sides, 0 to 5, and planes of a round wall, 6 on, and distances to it."""
    flat = np.array([[sign * (axis == k) for k in range(3)] for axis in range(3) for sign in (-1.0, 1.0)])
    normal, distance = np.concatenate([flat, wall.normals])[side], facets.wall_distance.copy()
    curved = side >= ROUND_SIDE
    if curved.any():
        distance[curved] = round_distances(wall, centers[facets.wall_particle[curved]], normal[curved])
    return facets._replace(wall_distance=distance, wall_normal=normal)
