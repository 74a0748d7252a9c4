"""Compiled loops over contacts: their directions, and which particles they hold."""

from typing import NamedTuple

import numpy as np
from numba import njit, prange

# Unit vectors closer than this to parallel span no plane worth testing; in what remains rounding stays below SLACK.
PARALLEL, SLACK = 1e-6, 1e-9
# Fewer contacts hold nothing.
FEWEST = 4


class Contacts(NamedTuple):
    """Contacts of particles with each other and with walls, as compressed rows."""

    indptr: np.ndarray  # (n + 1,) int64 array
    indices: np.ndarray  # (nnz,) uint32 array
    vectors: np.ndarray  # (nnz, 3) float array: Unit vector of each, from the particle of the row to the other
    wall_indptr: np.ndarray  # (n + 1,) int64 array
    wall_vectors: np.ndarray  # (m, 3) float array: Unit vectors towards walls


@njit(parallel=True, cache=True)
def unit_vectors(centers, box, indptr, indices, out):
    """Unit vectors along listed pairs, nearest image; NaN where two centres coincide.

    centers : (n, 3) float array, m
    box : (3,) float array, m; period of each axis, 0 where it is walled
    indptr : (n + 1,) int64 array
    indices : (nnz,) uint32 array
    out : (nnz, 3) float array, out
    """
    for i in prange(len(indptr) - 1):
        for t in range(indptr[i], indptr[i + 1]):
            j = indices[t]
            d2 = 0.0
            for axis in range(3):
                d = centers[j, axis] - centers[i, axis]
                if box[axis] > 0.0:
                    d -= box[axis] * np.rint(d / box[axis])
                out[t, axis] = d
                d2 += d * d
            factor = 1.0 / np.sqrt(d2) if d2 > 0.0 else np.nan
            for axis in range(3):
                out[t, axis] *= factor


@njit(parallel=True, cache=True)
def held(contacts, half_space, before, now):
    """Which of the particles held `before` are held by the contacts with each other and with walls.

    contacts : Contacts
    half_space : bool; FEWEST contacts are enough if False; they must also lie in no closed half-space if True
    before : (n,) bool array
    now : (n,) bool array, out
    """
    indptr, wall_indptr = contacts.indptr, contacts.wall_indptr
    for i in prange(len(before)):
        now[i] = False
        if before[i]:
            found = np.empty((indptr[i + 1] - indptr[i] + wall_indptr[i + 1] - wall_indptr[i], 3))
            count = 0
            for t in range(indptr[i], indptr[i + 1]):
                if before[contacts.indices[t]]:
                    for axis in range(3):
                        found[count, axis] = contacts.vectors[t, axis]
                    count += 1
            for t in range(wall_indptr[i], wall_indptr[i + 1]):
                for axis in range(3):
                    found[count, axis] = contacts.wall_vectors[t, axis]
                count += 1
            now[i] = count >= FEWEST and (not half_space or _spans(found, count))


@njit(cache=True)
def _spans(vectors, count):
    """Whether the first `count` unit vectors lie in no closed half-space.

    If they lie in one, some half-space that holds them has two independent ones of them in its boundary plane (an
    extreme ray of a pointed cone), or all of them lie in one plane: try the plane of each pair.
    """
    tried = False
    for a in range(count - 1):
        for b in range(a + 1, count):
            x = vectors[a, 1] * vectors[b, 2] - vectors[a, 2] * vectors[b, 1]
            y = vectors[a, 2] * vectors[b, 0] - vectors[a, 0] * vectors[b, 2]
            z = vectors[a, 0] * vectors[b, 1] - vectors[a, 1] * vectors[b, 0]
            norm = np.sqrt(x * x + y * y + z * z)
            if norm < PARALLEL:
                continue
            low = high = 0.0
            for c in range(count):
                if c != a and c != b:
                    s = x * vectors[c, 0] + y * vectors[c, 1] + z * vectors[c, 2]
                    low, high = min(low, s), max(high, s)
            if low >= -SLACK * norm or high <= SLACK * norm:
                return False
            tried = True
    return tried
