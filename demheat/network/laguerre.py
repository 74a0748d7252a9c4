"""Radical (Laguerre) tessellation: the transmission surfaces that make a lattice exact for linear fields."""

import numpy as np

from demheat.network import laguerre_kernels as kernels
from demheat.network.base import Facets, row_numbers

# Rows cut at once: bounds the scratch memory (about 1.5 kB a row) without costing speed.
BLOCK = 65536
# Planes that may cut a cell: enough for any packing; cells that need more (a large one beside small ones) are redone.
MOST_PLANES = 80
# Facets below this fraction of the squared mean spacing are rounding where more than four cells meet in one point.
SLIVER = 1e-11


def laguerre(centers, weights, size, *, periodic=True):
    """Cells of the radical tessellation of weighted points in a box.

    The facet between p and q lies at (d^2 + w_p - w_q)/(2 d) from p; with w = R^2 it is the radical plane of two
    spheres. The facet vectors of every cell sum to zero and the cells fill the box.

    Parameters
    ----------
    centers : (n, 3) float array, m
        Inside the box.
    weights : (n,) float array, m2
    size : (3,) float array, m
    periodic : bool or (3,) bool array
        Per axis; walls where not.

    Returns
    -------
    Facets
        Its rows are the given points; a hidden point has an empty row and no volume.

    Raises
    ------
    ValueError
        If a point is not finite or outside the box.
    RuntimeError
        If a cell cannot be secured (too few points in a periodic box) or the cells do not fill the box.
    """
    centers, weights, size, periodic = _checked(centers, weights, size, periodic)
    n = len(centers)
    spacing = (np.prod(size) / n) ** (1.0 / 3.0)
    counts = np.maximum(1, (size / (1.35 * spacing)).astype(np.int64))
    start, items = kernels.bin_points(centers, size, counts)
    grid = (centers, weights, size, periodic, counts, start, items)
    parts = [_cut_rows(np.arange(a, min(n, a + BLOCK)), grid, spacing) for a in range(0, n, BLOCK)]
    volumes, number, neighbour, image, area, distance = (np.concatenate(column) for column in zip(*parts, strict=True))
    _check_filled(volumes, size)
    return _compressed(volumes, number, (neighbour, image, area, distance), spacing)


def without_hidden(packing, facets):
    """The packing and its facets without the points that have no cell."""
    seen = facets.volumes > 0
    if seen.all():
        return packing, facets
    number = np.cumsum(seen) - 1
    packing = packing._replace(centers=packing.centers[seen], radii=packing.radii[seen])
    return packing, facets._replace(
        indptr=np.append(facets.indptr[:-1][seen], facets.indptr[-1]),  # rows of hidden points are empty
        indices=number[facets.indices].astype(np.uint32),
        wall_particle=number[facets.wall_particle],
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


def _cut_rows(rows, grid, spacing):
    """Cut some rows, again and wider where a cell was not secured; flat columns of their facets."""
    size, periodic = grid[2], grid[3]
    widest = size[periodic].min() if periodic.any() else 2 * size.max()
    reach, room, most, eps = min(2.5 * spacing, widest), 256, MOST_PLANES, 1e-11 * spacing
    done = []
    while len(rows):
        out = _empty_out(len(rows), most)
        kernels.cut_cells(rows, reach, room, most, eps, *grid, out)
        status = out[0]
        done.append((rows[status == kernels.OK], _columns(out, status == kernels.OK)))
        if reach >= widest and np.any(status == kernels.UNSECURED):
            raise RuntimeError(
                f"laguerre: {np.sum(status == kernels.UNSECURED)} cells reach across the periodic box "
                f"of {len(grid[0])} points; use more points"
            )
        if room > 1 << 17 or eps > 1e-8 * spacing:
            raise RuntimeError(f"laguerre: {np.sum(status != kernels.OK)} cells could not be cut")
        rows = rows[status != kernels.OK]
        reach = min(1.35 * reach, widest)
        room, most = 4 * room, min(3 * most, 2000)
        if np.any(status == kernels.TANGLED):
            eps *= 4
    return _in_order(done)


def _empty_out(n, most):
    shape = (n, most)
    return (
        np.empty(n, np.int8),
        np.empty(n),
        np.zeros(n, np.int64),
        np.empty(shape, np.int64),
        np.empty(shape, np.uint8),
        np.empty(shape),
        np.empty(shape),
    )


def _columns(out, good):
    _, volume, number, neighbour, image, area, distance = out
    used = good[:, None] & (np.arange(area.shape[1]) < number[:, None])
    return volume[good], number[good], neighbour[used], image[used], area[used], distance[used]


def _in_order(done):
    """Merge the passes over one block of rows back into row order."""
    rows = np.concatenate([r for r, _ in done])
    columns = [np.concatenate(c) for c in zip(*(c for _, c in done), strict=True)]
    if len(done) == 1:
        return columns
    order = np.argsort(rows, kind="stable")
    facet_order = np.argsort(np.repeat(rows, columns[1]), kind="stable")
    return [c[order] for c in columns[:2]] + [c[facet_order] for c in columns[2:]]


def _check_filled(volumes, size):
    defect = volumes.sum() / np.prod(size) - 1.0
    if abs(defect) > 1e-9:
        raise RuntimeError(f"laguerre: the cells fill the box with a relative defect of {defect:.2e}")


def _compressed(volumes, number, columns, spacing):
    neighbour, image, area, distance = columns
    row = np.repeat(np.arange(len(number)), number)
    big = area > SLIVER * spacing**2
    wall = big & (neighbour < 0)
    link = big & (neighbour >= 0)
    walls = (row[wall], -1 - neighbour[wall], area[wall], distance[wall])
    indptr = _pointers(row[link], len(number))
    indices, image, area, distance = neighbour[link].astype(np.uint32), image[link], area[link], distance[link]
    matched = np.empty(len(area))
    kernels.match_links(indptr, indices, image, area, matched)
    lost = area[matched == 0.0]
    if len(lost) and lost.max() > 1e-7 * spacing**2:
        raise RuntimeError(f"laguerre: a facet of {lost.max():.2e} m2 is seen by one of its two cells only")
    keep = matched > 0.0
    indptr = _pointers(row_numbers(indptr)[keep], len(number))
    return Facets(indptr, indices[keep], image[keep], matched[keep], distance[keep], *walls, volumes)


def _pointers(rows, n):
    return np.concatenate([[0], np.cumsum(np.bincount(rows, minlength=n))])
