"""Near neighbours and contact networks of a packing, as compressed rows."""

import numpy as np
from scipy import sparse

import demheat.runtime.threads  # noqa: F401 (chooses the threading layer)
from demheat.packing import cells_kernels as kernels
from demheat.packing.base import Packing, wrap
from demheat.packing.gate import check_packing
from demheat.packing.walls import bulk
from demheat.powers import cube_root
from demheat.runtime.blocks import blocks
from demheat.scene.inputs import finite, flag

# Cells hold about this many particles of their level: smaller ones cost rows, larger ones cost candidates.
PER_CELL = 4.0
# Level k holds the radii between 4**-(k+1) and 4**-k of the largest; anything smaller still goes to the last level.
# Factor 2 was 20 % slower at a size ratio of 7 and no faster at 40.
DOUBLINGS, MAX_LEVELS = 2, 12
# Chunks of particles in the first block of a search.
FIRST = 4
# First guess of a gap that holds enough contacts: 7.5 of them were found within 0.07 at phi = 0.64.
FIRST_GAP = 0.12


def neighbours(packing: Packing, *, scale: float = 1.0, skin: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """List all pairs closer than scale (r_i + r_j) + skin, nearest periodic image."""
    check_packing(packing)
    for name, value in (("scale", scale), ("skin", skin)):
        finite(name, value, "a finite number >= 0", lambda v: v >= 0)
    points = np.column_stack((packing.centers, packing.radii))
    indptr, indices = near_rows(points, packing.size, packing.periodic, scale=scale, skin=skin)
    kernels.sort_rows(indptr, indices)
    return indptr, indices


def contacts(
    packing: Packing,
    *,
    coordination: float = 7.5,
    gap: float | None = None,
    margin: float = 4.0,
    additive: bool = False,
) -> tuple[np.ndarray, np.ndarray, float]:
    """Contact network: pairs at most (1 + gap)(r_i + r_j) apart, gap chosen for a mean coordination number.

    Of a neighbour's periodic images only the nearest counts: boxes should be at least twice as thick as pairs reach.

    Parameters
    ----------
    packing : Packing
    coordination : float
        Mean number of contacts of the bulk particles (walls do not count as contacts).
    gap : float, optional
        Use this gap, as a part of r_i + r_j, instead; `coordination` is then ignored.
    margin : float
        Bulk particles are those at least this many mean radii away from every wall, flat or round; 0 counts all
        particles, as the papers do. A periodic packing is bulk throughout.
    additive : bool
        The gap is a part of the mean diameter, the same length for all pairs: r_i + r_j + 2 gap <r> apart.

    Returns
    -------
    indptr : (n + 1,) int64 array
    indices : (nnz,) uint32 array
        Each pair twice, rows ascending.
    gap : float
        Negative if only overlapping pairs are needed.

    Raises
    ------
    ValueError
        If an argument is not as described, no particle is bulk, or there are too few particles for that coordination.

    Examples
    --------
    >>> from demheat.packing import contacts
    >>> from demheat.packing.relax import relax
    >>> indptr, indices, gap = contacts(relax(500, seed=0), coordination=7.5)
    >>> round(len(indices) / 500, 1)
    7.5
    """
    check_packing(packing)
    flag("additive", additive)
    if gap is not None:
        finite("gap", gap, "a finite part of r_i + r_j > -1", lambda v: v > -1)
        return *_closer(packing, 1.0 + gap, additive)[:2], float(gap)
    deep = bulk(packing, margin)
    others = packing.number - 1
    finite("coordination", coordination, f"> 0 and <= {others}, all others", lambda v: 0 < v <= others)
    # Ends of links in the bulk; even, since most pairs have both there and midway to the next must not part them.
    wanted = 2 * max(1, round(coordination * np.count_nonzero(deep) / 2))
    scale = 1.0 + FIRST_GAP
    while True:
        indptr, indices, ratio = _closer(packing, scale, additive)
        counted = ratio[np.repeat(deep, np.diff(indptr))]
        if len(counted) > wanted or len(indices) == packing.number * others:
            break
        scale *= 1.2
    # Midway to the next pair, so that rounding decides nothing; all pairs have no next one.
    last = min(wanted, len(counted) - 1)
    limit = np.partition(counted, (wanted - 1, last))[[wanted - 1, last]].mean()
    kept = ratio <= limit
    new = np.concatenate(([0], np.cumsum(kept)))[indptr]
    return new, indices[kept], float(limit - 1.0)


def as_graph(indptr, indices):
    """The network as a SciPy matrix of ones, for its graph routines."""
    n = len(indptr) - 1
    return sparse.csr_matrix((np.ones(len(indices), np.int8), indices.astype(np.int32), indptr), shape=(n, n))


def _closer(packing, scale, additive):
    """Rows of the pairs whose measured distance (1 at contact) is at most `scale`, and these distances."""
    if not additive:
        indptr, indices = neighbours(packing, scale=scale)
        return indptr, indices, _ratios(packing, indptr, indices)
    diameter = 2.0 * float(np.mean(packing.radii))
    # A negative skin would be refused: an overlap is looked for among all overlapping pairs.
    indptr, indices = neighbours(packing, scale=1.0, skin=max(0.0, scale - 1.0) * diameter)
    sums = np.repeat(packing.radii, np.diff(indptr)) + packing.radii[indices]
    measured = 1.0 + (_ratios(packing, indptr, indices) - 1.0) * sums / diameter
    kept = measured <= scale
    return np.concatenate(([0], np.cumsum(kept)))[indptr], indices[kept], measured[kept]


def _ratios(packing, indptr, indices):
    """Distance over the sum of radii of each listed pair, (nnz,) float array; the same bits from both sides."""
    points = np.column_stack((packing.centers, packing.radii))
    ratios = np.empty(len(indices))
    kernels.row_distances(points, np.where(packing.periodic, packing.size, 0.0), indptr, indices, ratios)
    return ratios


def near_rows(points, size, periodic, *, scale=1.0, skin=0.0, guess=16.0):
    """Unsorted rows of near neighbours; the engine of `neighbours` and of the relaxation."""
    points = wrapped(points, size, periodic)
    reach = kernels.Reach(float(scale), float(skin))
    grid = build_grid(points, size, periodic, reach)
    n = len(points)
    chunks = -(-n // kernels.CHUNK)
    lengths = np.empty(n, dtype=np.int64)
    indptr = np.zeros(n + 1, dtype=np.int64)
    capacity = int(1.2 * guess * kernels.CHUNK) + 64
    while True:
        buffer = np.empty((chunks, capacity + 1), dtype=np.uint32)
        for first, last in blocks(chunks, FIRST):
            kernels.near_rows(points, grid, reach, first, buffer[first:last], lengths)
        longest = int(np.add.reduceat(lengths, np.arange(0, n, kernels.CHUNK)).max())
        if longest <= capacity:
            break
        capacity = longest
    np.cumsum(lengths, out=indptr[1:])
    indices = np.empty(indptr[-1], dtype=np.uint32)
    kernels.compact_rows(buffer, indptr, indices)
    return indptr, indices


def wrapped(points, size, periodic):
    """The same centres and radii with the centres in 0 <= x < size on periodic axes, rows whole in memory."""
    # Columns of a slice come back column by column: kernels would be compiled a second time for such.
    return np.ascontiguousarray(np.column_stack((wrap(points[:, :3], size, periodic), points[:, kernels.RADIUS])))


def build_grid(points, size, periodic, reach) -> kernels.Grid:
    """File points under the cells of one grid per size level."""
    radii = points[:, kernels.RADIUS]
    # Exact, by the exponent of 2: logarithms that processors round otherwise would file spheres otherwise.
    raw = np.minimum((np.frexp(radii.max() / radii)[1].astype(np.int64) - 1) // DOUBLINGS, MAX_LEVELS - 1)
    used, level, count = np.unique(raw, return_inverse=True, return_counts=True)
    largest = np.zeros(len(used))
    np.maximum.at(largest, level, radii)
    side = np.array([cube_root(np.prod(size) * PER_CELL / each) for each in count])
    # A cell need not be smaller than a third of what the smallest search through it spans.
    side = np.maximum(side, (2 * reach.scale * largest + reach.skin) / 3)
    dims = np.maximum(1, np.floor(size / side[:, None])).astype(np.int64)
    first = np.concatenate(([0], np.cumsum(np.prod(dims, axis=1))))
    start = np.empty(first[-1] + 1, dtype=np.int64)
    order = np.empty(len(points), dtype=np.uint32)
    slots = np.empty((len(points), 4))
    cell = size / dims
    grid = kernels.Grid(dims, cell, largest, first[:-1], start, order, slots, np.where(periodic, size, 0.0))
    kernels.fill_cells(points, level, grid)
    return grid
