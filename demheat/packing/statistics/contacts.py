"""What the contacts of a packing say: coordination, rattlers and isotropy, from compressed rows as `contacts` gives."""

import math
import warnings
from typing import NamedTuple

import numpy as np
from scipy.sparse.csgraph import connected_components

import demheat.runtime.threads  # noqa: F401 (chooses the threading layer)
from demheat.packing.base import Packing
from demheat.packing.gate import check_packing
from demheat.packing.neighbours import as_graph
from demheat.packing.statistics import contacts_kernels as kernels
from demheat.packing.walls import bulk, outward, wall_distance, walls
from demheat.scene.inputs import chosen, finite


class Coordination(NamedTuple):
    """Contact numbers of a packing; walls do not count as contacts."""

    mean: float
    least: int
    histogram: np.ndarray  # (most + 1,) int array: Number of counted particles with 0, 1, 2, ... contacts
    # under_2, under_4: Parts of the counted particles with fewer than 2 and 4 contacts
    under_2: float
    under_4: float
    counted: int  # Particles at least `margin` from walls
    components: int  # Connected components of the whole network; a particle without contacts is one
    largest: float  # Part of all particles that is in the largest component

    @property
    def islands(self) -> int:
        """The name of `components` in 0.2."""
        warnings.warn("islands is now components", DeprecationWarning, stacklevel=2)
        return self.components


class Backbone(NamedTuple):
    """What is left of a contact network when the particles that nothing holds are taken out."""

    rattler: np.ndarray  # (n,) bool array
    # Mean number of contacts with other particles of the backbone; 6 where frictionless spheres without walls are
    # isostatic. NaN if nothing is left
    coordination: float
    # Contacts, those with walls included, over 3 times the particles of the backbone: 1 is isostatic, with or without
    # walls. NaN if nothing is left
    constraints: float
    rounds: int  # Passes until no particle was taken out


class Fabric(NamedTuple):
    """Second and fourth moments of the unit vectors n along the links."""

    tensor: np.ndarray  # (3, 3) float array: <n n>; I/3 if isotropic
    # (3,) float array: <n_x^4>, <n_y^4>, <n_z^4>; 1/5 if isotropic. A cubic crystal shows here only: its tensor is I/3
    fourth: np.ndarray
    links: float  # Number of links, or of equally weighted links with the same sampling error
    # diagonal_error, off_diagonal_error, fourth_error: Standard deviations sqrt(4/45), sqrt(1/15) and sqrt(16/225) over
    # sqrt(links) of independent isotropic links
    diagonal_error: float
    off_diagonal_error: float
    fourth_error: float
    deviation: float  # Largest deviation of the tensor from I/3, in standard deviations
    fourth_deviation: float  # Largest deviation of the fourth moments from 1/5, in standard deviations


class Directions(NamedTuple):
    """Histogram of link directions in the three coordinate planes, for a polar plot."""

    angles: np.ndarray  # (bins,) float array, rad: Middles of the bins, from 0
    # (3, bins) float array: In the plane normal to x (angle from y to z), to y (from z to x) and to z (from x to y); 1
    # if isotropic. Each link counts both ways. NaN where all links are normal to the plane
    density: np.ndarray
    error: np.ndarray  # (3,) float array: Standard deviation of the density of independent isotropic links


def coordination(packing: Packing, indptr: np.ndarray, indices: np.ndarray, *, margin: float = 0.0) -> Coordination:
    """Count the contacts of each particle.

    Parameters
    ----------
    packing : Packing
    indptr : (n + 1,) int array
    indices : (nnz,) int array
        Each pair twice, rows ascending: the first two results of `contacts` or `neighbours`.
    margin : float
        Count only particles at least this many mean radii away from every wall.

    Raises
    ------
    ValueError
        If the rows are not as described, margin is negative, or no particle is that deep.

    Examples
    --------
    >>> from demheat.packing import contacts, statistics
    >>> from demheat.packing.relax import relax
    >>> packing = relax(500, seed=0)
    >>> indptr, indices, gap = contacts(packing)
    >>> round(statistics.coordination(packing, indptr, indices).mean, 1)
    7.5
    """
    indptr, indices = _checked_rows(packing, indptr, indices)
    numbers = np.diff(indptr)[bulk(packing, margin)]
    components, label = connected_components(as_graph(indptr, indices), directed=False)
    return Coordination(
        mean=float(numbers.mean()),
        least=int(numbers.min()),
        histogram=np.bincount(numbers),
        under_2=float(np.mean(numbers < 2)),
        under_4=float(np.mean(numbers < 4)),
        counted=len(numbers),
        components=int(components),
        largest=float(np.bincount(label).max() / packing.number),
    )


def backbone(
    packing: Packing, indptr: np.ndarray, indices: np.ndarray, *, gap: float = 0.0, rule: str = "count"
) -> Backbone:
    """Take out rattlers, particles that their contacts cannot hold, until none is left.

    Walls hold as contacts do. The result does not depend on the order of removal.
    """
    indptr, indices = _checked_rows(packing, indptr, indices)
    finite("gap", gap, "a finite part of the radius > -1", lambda v: v > -1)
    chosen("rule", rule, ("count", "half-space"))
    vectors = _unit_vectors(packing, indptr, indices)
    touching = kernels.Contacts(indptr, indices, vectors, *_wall_contacts(packing, gap))
    held, before, rounds = np.ones(packing.number, dtype=bool), packing.number + 1, 0
    while held.sum() < before:
        before, now = int(held.sum()), np.empty_like(held)
        kernels.held(touching, rule == "half-space", held, now)
        held, rounds = now, rounds + 1
    pairs = np.count_nonzero(held[indices] & np.repeat(held, np.diff(indptr))) / 2
    at_walls = int(np.diff(touching.wall_indptr)[held].sum())
    left = before if before else math.nan
    return Backbone(~held, float(2 * pairs / left), float((pairs + at_walls) / (3 * left)), rounds)


def fabric(packing: Packing, indptr: np.ndarray, indices: np.ndarray, *, margin: float = 0.0) -> Fabric:
    """Fabric tensor F = <n n> of the links, their fourth moments, and how far both are from isotropy.

    The sampling errors take links as independent; those of one particle are not (they repel each other), so the
    deviations of an isotropic packing are rather smaller than that.

    Parameters
    ----------
    packing : Packing
    indptr, indices : arrays
        As in `coordination`.
    margin : float
        Count only links that start at a particle this many mean radii away from every wall. A link with one such end
        has half the weight of one with two: leaving it out would miss links across the edge of the core.

    Raises
    ------
    ValueError
        If the rows are not as described, two linked centres coincide, margin is negative, or no link is left.

    Examples
    --------
    >>> from demheat.packing import contacts, statistics
    >>> from demheat.packing.relax import relax
    >>> packing = relax(500, seed=0)
    >>> indptr, indices, gap = contacts(packing)
    >>> round(float(statistics.fabric(packing, indptr, indices).tensor.trace()), 9)
    1.0
    """
    vectors, weights = _links(packing, indptr, indices, margin)
    total = weights.sum()
    tensor = np.einsum("k,ki,kj->ij", weights, vectors, vectors) / total
    fourth = np.einsum("k,ki->i", weights, vectors**4) / total
    links = float(total**2 / np.sum(weights**2))
    diagonal, off_diagonal, error = (math.sqrt(variance / links) for variance in (4 / 45, 1 / 15, 16 / 225))
    units = np.where(np.eye(3, dtype=bool), diagonal, off_diagonal)
    deviation = float(np.max(np.abs(tensor - np.eye(3) / 3) / units))
    fourth_deviation = float(np.max(np.abs(fourth - 0.2)) / error)
    return Fabric(tensor, fourth, links, diagonal, off_diagonal, error, deviation, fourth_deviation)


def directions(
    packing: Packing, indptr: np.ndarray, indices: np.ndarray, *, bins: int = 72, margin: float = 0.0
) -> Directions:
    """Histogram of the directions of the links, projected on the three coordinate planes."""
    if not isinstance(bins, int | np.integer) or isinstance(bins, bool) or bins < 4 or bins % 2:
        raise ValueError(f"bins = {bins!r}: must be an even integer >= 4")
    vectors, weights = _links(packing, indptr, indices, margin)
    half, density, error = bins // 2, np.empty((3, bins)), np.empty(3)
    for axis in range(3):
        u, v = vectors[:, (axis + 1) % 3], vectors[:, (axis + 2) % 3]
        # Links along the axis have no angle in its plane; in a crystal they miss it by rounding only.
        seen = np.hypot(u, v) > 1e-9
        bin_of = np.rint(np.arctan2(v, u)[seen] / (2 * np.pi) * bins).astype(np.int64) % half
        counts, squares = (np.bincount(bin_of, weights=weights[seen] ** p, minlength=half) for p in (1, 2))
        with np.errstate(invalid="ignore", divide="ignore"):
            density[axis] = np.tile(counts / counts.sum() * half, 2)
            error[axis] = np.sqrt((half - 1) * squares.sum()) / counts.sum()
    return Directions(2 * np.pi / bins * np.arange(bins), density, error)


def _checked_rows(packing, indptr, indices):
    """Cast compressed rows, or raise ValueError unless they list each pair of distinct particles twice, ascending."""
    check_packing(packing)
    indptr, indices, n = np.asarray(indptr), np.asarray(indices), packing.number
    if indptr.shape != (n + 1,) or indptr.dtype.kind not in "iu" or indptr[0] != 0 or np.any(indptr[1:] < indptr[:-1]):
        raise ValueError(f"indptr of shape {indptr.shape}: must be {n + 1} integers that rise from 0")
    if indices.shape != (indptr[-1],) or indices.dtype.kind not in "iu":
        raise ValueError(f"indices of shape {indices.shape}: must be {indptr[-1]} integers, as many as indptr says")
    if len(indices) and (indices.min() < 0 or indices.max() >= n):
        raise ValueError(f"indices from {indices.min()} to {indices.max()}: must be >= 0 and < {n}, one per particle")
    indptr, indices = indptr.astype(np.int64), indices.astype(np.uint32)
    rows = np.repeat(np.arange(n), np.diff(indptr))
    here, there = rows * n + indices, indices * np.int64(n) + rows
    if np.any(here[1:] <= here[:-1]) or np.any(rows == indices) or not np.array_equal(here, np.sort(there)):
        raise ValueError("indices: each pair must be listed twice, in the rows of both particles, rows ascending")
    return indptr, indices


def _unit_vectors(packing, indptr, indices):
    """Unit vector along each link, from the particle of the row to the nearest image of the other, (nnz, 3) array."""
    vectors = np.empty((len(indices), 3))
    kernels.unit_vectors(packing.centers, np.where(packing.periodic, packing.size, 0.0), indptr, indices, vectors)
    wrong = np.isnan(vectors[:, 0])
    if wrong.any():
        first = int(np.argmax(wrong))
        row = int(np.searchsorted(indptr, first, side="right")) - 1
        raise ValueError(f"packing.centers: {row} and {indices[first]} coincide, their link has no direction")
    return vectors


def _links(packing, indptr, indices, margin):
    """Unit vector of each link, once, and its weight: the number of its ends that are in the bulk."""
    indptr, indices = _checked_rows(packing, indptr, indices)
    deep, rows = bulk(packing, margin), np.repeat(np.arange(packing.number), np.diff(indptr))
    weights = deep[rows] + deep[indices].astype(float)
    kept = (rows < indices) & (weights > 0)
    if not kept.any():
        raise ValueError(f"indices: no links among the particles {margin} mean radii from walls; must be at least one")
    return _unit_vectors(packing, indptr, indices)[kept], weights[kept]


def _wall_contacts(packing, gap):
    """Contacts with walls as compressed rows of unit vectors towards the wall: (n + 1,) int and (m, 3) float arrays."""
    who, vectors = [np.empty(0, dtype=np.int64)], [np.empty((0, 3))]
    for wall in walls(packing):
        near = np.flatnonzero(wall_distance(packing, wall) <= (1.0 + gap) * packing.radii)
        normals = outward(packing, wall)[near]
        # A sphere in the middle that touches the round wall fills the domain: no direction is special, none is counted.
        special = ~np.isnan(normals[:, 0])
        who.append(near[special])
        vectors.append(normals[special])
    rows = np.concatenate(who)
    order = np.argsort(rows, kind="stable")
    indptr = np.concatenate(([0], np.cumsum(np.bincount(rows, minlength=packing.number))))
    return indptr, np.ascontiguousarray(np.concatenate(vectors)[order])
