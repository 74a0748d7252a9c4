"""Radical (Laguerre) tessellation: the transmission surfaces that make a lattice exact for linear fields."""

import numpy as np

from demheat.network import laguerre_kernels as kernels
from demheat.network.base import Facets
from demheat.network.bins_kernels import bin_points
from demheat.network.curved import ROUND_SIDE, round_distances, round_wall, tangents_within
from demheat.network.links_kernels import match_links
from demheat.packing.base import check_domain
from demheat.scene import domain_volume

# Rows cut at once: bounds the scratch memory (about 1.5 kB a row) without costing speed.
BLOCK = 65536
# Planes that may cut a cell: enough for any packing; cells that need more (a large one beside small ones) are redone.
MOST_PLANES = 80
# Candidates that a cell may meet at first, and at last: bounds the scratch memory of a thread (about 10 MB).
ROOM, MOST_ROOM = 256, 1 << 18
# Facets below this fraction of the squared mean spacing are rounding where more than four cells meet in one point.
SLIVER = 1e-11


def laguerre(centers, weights, size, *, periodic=True, domain="box"):
    """Cells of the radical tessellation of weighted points in a box, or in a round body inscribed in it.

    The facet between p and q lies at (d^2 + w_p - w_q)/(2 d) from p; with w = R^2 it is the radical plane of two
    spheres. The facet vectors of every cell sum to zero and the cells fill the body. Cells at a round wall end at
    tangent planes that enclose its exact volume (see `demheat.network.curved`); a cell may meet several of them.

    Parameters
    ----------
    centers : (n, 3) float array, m
        Inside the box.
    weights : (n,) float array, m2
    size : (3,) float array, m
    periodic : bool or (3,) bool array
        Per axis; walls where not. Axes across which the domain is round are not periodic.
    domain : {"box", "cylinder-x", "cylinder-y", "cylinder-z", "sphere"}

    Returns
    -------
    Facets
        Its rows are the given points; a hidden point has an empty row and no volume. A round wall is side 6.

    Raises
    ------
    ValueError
        If a point is not finite or outside the domain.
    RuntimeError
        If a cell cannot be secured (too few points in a periodic box) or the cells do not fill the domain.
    """
    centers, weights, size, periodic = _checked(centers, weights, size, periodic)
    check_domain(domain, size, periodic)
    n = len(centers)
    spacing = (domain_volume(domain, size) / n) ** (1.0 / 3.0)
    wall = round_wall(domain, size, spacing)
    _check_round(centers, wall, domain)
    counts = np.maximum(1, (size / (1.35 * spacing)).astype(np.int64))
    grid = counts, *bin_points(centers, size, counts)
    sites = kernels.Sites(centers, weights, weights.max(), size, periodic, *grid)
    volumes, number, *columns = _joined(_cut_block(start, sites, wall, spacing) for start in range(0, n, BLOCK))
    _check_filled(volumes, domain_volume(domain, size), domain)
    indices, image, area, distance, row, side, wall_area, wall_distance = columns
    links = _matched(number, indices, image, area, distance, spacing)
    facets = Facets(*links, row, np.minimum(side, ROUND_SIDE), wall_area, wall_distance, volumes)
    return _with_normals(facets, side, centers, wall)


def drop_empty_cells(packing, facets):
    """Leave out the points that have no cell.

    Parameters
    ----------
    packing : Packing
    facets : Facets
        Of this packing.

    Returns
    -------
    packing : Packing
    facets : Facets
    """
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
    off = np.linalg.norm((centers - wall.middle) * wall.across, axis=1)
    radius = (wall.middle * wall.across).max()
    if len(wall.normals) and off.max() >= radius:
        which = int(np.argmax(off))
        raise ValueError(
            f"centers[{which}] = {centers[which].tolist()}: {off[which]:.6g} m off the middle of the {domain}; must be "
            f"less than its radius {radius:.6g} (demheat.packing.relax.settle pushes particles off a wall)"
        )


def _cut_block(start, sites, wall, spacing):
    """Facets of a block of rows, links and walls apart.

    Volumes and numbers of links by row; indices, image, area and distance of links; row, side (planes of a round wall
    from 6 on), area and distance of walls.
    """
    rows = np.arange(start, min(len(sites.points), start + BLOCK))
    volumes, number, neighbour, image, area, distance = _cut_rows(rows, sites, wall, spacing)
    row, big = np.repeat(np.arange(len(rows)), number), area > SLIVER * spacing**2
    link, end = big & (neighbour >= 0), big & (neighbour < 0)
    links = (neighbour[link].astype(np.uint32), image[link], area[link], distance[link])
    walls = (start + row[end], -1 - neighbour[end], area[end], distance[end])
    return volumes, np.bincount(row[link], minlength=len(rows)), *links, *walls


def _joined(parts):
    """Columns of all blocks; those of the blocks are let go one after the other."""
    columns = [list(column) for column in zip(*parts, strict=True)]
    joined = []
    while columns:
        joined.append(np.concatenate(columns.pop(0)))
    return joined


def _cut_rows(rows, sites, wall, spacing):
    """Cut some rows, again and wider where a cell was not secured; flat columns of their facets."""
    size, periodic = sites.size, sites.periodic
    widest = size[periodic].min() if periodic.any() else 2 * size.max()
    limits = kernels.Limits(min(2.5 * spacing, widest), ROOM, MOST_PLANES, 1e-11 * spacing)
    done = []
    while len(rows):
        out = _empty_cut(len(rows), limits.most)
        near = tangents_within(wall, sites.points[rows], limits.reach)
        kernels.cut_cells(rows, sites, wall, near, limits, out)
        good = out.status == kernels.OK
        done.append((rows[good], _columns(out, good)))
        _check_cut(out.status, sites, spacing, limits, widest)
        rows, limits = rows[~good], _wider(limits, widest, np.any(out.status == kernels.TANGLED))
    return _in_order(done)


def _wider(limits, widest, tangled):
    """Limits for the next pass over what is left."""
    return kernels.Limits(
        min(1.35 * limits.reach, widest),
        min(4 * limits.room, MOST_ROOM),
        min(3 * limits.most, 2000),
        4 * limits.eps if tangled else limits.eps,
    )


def _check_cut(status, sites, spacing, limits, widest):
    """Raise RuntimeError where another pass would not help."""
    unsecured, overfull = np.sum(status == kernels.UNSECURED), np.any(status == kernels.OVERFLOW)
    if limits.reach >= widest and unsecured:
        raise RuntimeError(
            f"laguerre: {unsecured} cells reach across the periodic box of {len(sites.points)} points; use more points"
        )
    left = np.sum(status != kernels.OK)
    if (limits.room == MOST_ROOM and overfull) or (limits.eps > 1e-8 * spacing and left):
        raise RuntimeError(f"laguerre: {left} cells could not be cut")


def _empty_cut(n, most):
    shape = (n, most)
    return kernels.Cut(
        status=np.empty(n, np.int8),
        volume=np.empty(n),
        number=np.zeros(n, np.int64),
        neighbour=np.empty(shape, np.int64),
        image=np.empty(shape, np.uint8),
        area=np.empty(shape),
        distance=np.empty(shape),
    )


def _columns(out, good):
    """Volumes and numbers of facets of the good rows; neighbours, images, areas and distances of their facets."""
    used = good[:, None] & (np.arange(out.area.shape[1]) < out.number[:, None])
    return (
        out.volume[good],
        out.number[good],
        *(part[used] for part in (out.neighbour, out.image, out.area, out.distance)),
    )


def _in_order(done):
    """Merge the passes over one block of rows back into row order."""
    rows = np.concatenate([r for r, _ in done])
    volume, number, *facets = (np.concatenate(c) for c in zip(*(c for _, c in done), strict=True))
    if len(done) == 1:
        return volume, number, *facets
    order = np.argsort(rows, kind="stable")
    facet_order = np.argsort(np.repeat(rows, number), kind="stable")
    return volume[order], number[order], *(column[facet_order] for column in facets)


def _check_filled(volumes, volume, domain):
    defect = volumes.sum() / volume - 1.0
    if abs(defect) > 1e-9:
        raise RuntimeError(f"laguerre: the cells fill the {domain} with a relative defect of {defect:.2e}")


def _matched(number, indices, image, area, distance, spacing):
    """Links that both of their cells see, with one area: pointers, indices, image, area, distance."""
    indptr = np.concatenate([[0], np.cumsum(number)])
    matched = np.empty(len(area))
    match_links(indptr, indices, image, area, matched)
    keep = matched > 0.0
    if keep.all():
        return indptr, indices, image, matched, distance
    lost = area[~keep].max()
    if lost > 1e-7 * spacing**2:
        raise RuntimeError(f"laguerre: a facet of {lost:.2e} m2 is seen by one of its two cells only")
    indptr = np.concatenate([[0], np.cumsum(keep)])[indptr]
    return indptr, indices[keep], image[keep], matched[keep], distance[keep]


def _with_normals(facets, side, centers, wall):
    """Facets with outward normals of the box's sides, 0 to 5, and planes of a round wall, 6 on, and distances to it."""
    flat = np.array([[sign * (axis == k) for k in range(3)] for axis in range(3) for sign in (-1.0, 1.0)])
    normal, distance = np.concatenate([flat, wall.normals])[side], facets.wall_distance.copy()
    curved = side >= ROUND_SIDE
    if curved.any():
        distance[curved] = round_distances(wall, centers[facets.wall_particle[curved]], normal[curved])
    return facets._replace(wall_distance=distance, wall_normal=normal)
