"""Compiled finest level of the multigrid preconditioner: aggregates, their Galerkin matrix, and Gauss-Seidel sweeps.

Sweeps run within fixed blocks of rows and take the rest as it was, so that bits do not depend on the number of threads,
which do rows, or blocks of them, from `first` to `last`. Links may lead beyond the rows, to particles that are
another's: vectors that are read there are longer than the rows.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from demheat.network.links_kernels import IN_PIECES

# Rows swept one after the other. Neighbours in space are near in memory: less than a tenth of the links leave a block.
ROWS = 65536
# A neighbour joins an aggregate over a link of at least this part of the strongest link of both.
STRONG = 0.1


class Aggregates(NamedTuple):
    """Particles joined to aggregates."""

    owner: np.ndarray  # (n,) int32 array: Aggregate of each particle, -1 for those without links
    start: np.ndarray  # (aggregates + 1,) int64 array: Where each aggregate begins among the rows
    rows: np.ndarray  # (particles with links,) uint32 array: The particles of each aggregate, ascending


class Level(NamedTuple):
    """Matrix of the finest level in single precision, without units, arranged for sweeps.

    Links of a row to lower rows of its own block come first, those to higher ones of it last, to other blocks between.
    """

    indptr: np.ndarray  # (n + 1,) int64 array
    indices: np.ndarray  # (m,) uint32 array: Of the links, in their own order
    # (n, 2) unsigned array: How many links of each row are lower ones, and how many come before the higher ones
    ends: np.ndarray
    # (m,) unsigned array: Place of each link in its row of the indices: a byte where a copy of the index would take
    # four
    place: np.ndarray
    values: np.ndarray  # (m,) float32 array: Minus the entries off the diagonal
    inverse: np.ndarray  # (n,) float32 array: 1 / diagonal, 0 where a row has no equation


@njit(**IN_PIECES)
def strongest(first, last, links, top):
    """Find the largest conductance of each row.

    first, last : int; rows
    links : Links
    top : (n,) float array, W/K, out; zero for rows without links
    """
    indptr, _, conductance = links
    for i in range(np.uint64(first), np.uint64(last)):
        most = 0.0
        for e in range(np.uint64(indptr[i]), np.uint64(indptr[i + np.uint64(1)])):
            most = max(most, conductance[e])
        top[i] = most


@njit(cache=True)
def _pick(i, links, top, owner, found, key):
    """The strongest free neighbours of i, strongest first, into found; their number."""
    indptr, indices, conductance = links
    number, room = 0, len(found)
    for e in range(indptr[i], indptr[i + 1]):
        j, c = indices[e], conductance[e]
        if j >= len(owner) or owner[j] >= 0 or c <= 0.0 or j == i or c < STRONG * max(top[i], top[j]):
            continue
        known = False
        for a in range(number):
            known |= found[a] == j
        if known or (number == room and c <= key[room - 1]):
            continue
        number = min(number + 1, room)
        a = number - 1
        while a > 0 and key[a - 1] < c:
            key[a], found[a] = key[a - 1], found[a - 1]
            a -= 1
        key[a], found[a] = c, j
    return number


@njit(cache=True)
def aggregate(links, top, most, owner):
    """Join particles that are strongly linked.

    In order of the rows each free one takes its strongest free neighbours, if they are a third of `most` or more;
    what is left over joins the aggregate of its strongest neighbour. Only rows are joined.

    links : Links
    top : (n,) float array, W/K; of `strongest`
    most : int; particles that are joined at once, at most
    owner : (n,) int32 array, out; aggregate of each particle, -1 for those without links
    Returns int: number of aggregates
    """
    indptr, indices, conductance = links
    found, key = np.empty(most - 1, np.int64), np.empty(most - 1)
    owner[:] = -1
    count = 0
    for i in range(len(owner)):
        if owner[i] >= 0 or top[i] <= 0.0:
            continue
        number = _pick(i, links, top, owner, found, key)
        if 3 * number >= most - 1:
            owner[i] = count
            for a in range(number):
                owner[found[a]] = count
            count += 1
    for i in range(len(owner)):
        if owner[i] >= 0 or top[i] <= 0.0:
            continue
        best, c = np.int64(-1), 0.0
        for e in range(indptr[i], indptr[i + 1]):
            j = indices[e]
            if j < len(owner) and owner[j] >= 0 and conductance[e] > max(c, STRONG * top[i]):
                best, c = owner[j], conductance[e]
        if best < 0:
            best = count
            count += 1
        owner[i] = best
    return count


@njit(cache=True)
def members(owner, count):
    """List the particles of each aggregate.

    owner : (n,) int32 array; of `aggregate`
    count : int; number of aggregates
    Returns Aggregates
    """
    start = np.zeros(count + 1, np.int64)
    for i in range(len(owner)):
        if owner[i] >= 0:
            start[owner[i] + 1] += 1
    start = np.cumsum(start)
    fill, rows = start[:-1].copy(), np.empty(start[-1], np.uint32)
    for i in range(len(owner)):
        if owner[i] >= 0:
            rows[fill[owner[i]]] = i
            fill[owner[i]] += 1
    return Aggregates(owner, start, rows)


@njit(cache=True)
def galerkin(links, diagonal, scale, aggregates):
    """Matrix of the aggregates: sums over each pair of them of scale (diag(diagonal) - conductance).

    links : Links
    diagonal : (n,) float array, W/K
    scale : float, K/W
    aggregates : Aggregates; with the owners also of what is beyond the rows, which have numbers after those of the
      rows' own
    Returns:
    pointers : (aggregates + 1,) int32 array; of compressed rows
    columns : int32 array; the diagonal comes first in each row
    values : float array
    """
    indptr, indices, conductance = links
    owner, start, rows = aggregates
    count = len(start) - 1
    seen = np.full(max(count, owner.max() + 1), -1, np.int64)
    pointers = np.zeros(count + 1, np.int32)
    for c in range(count):
        seen[c] = c
        number = 1
        for s in range(start[c], start[c + 1]):
            for e in range(indptr[rows[s]], indptr[rows[s] + 1]):
                d = owner[indices[e]]
                if d >= 0 and seen[d] != c:
                    seen[d] = c
                    number += 1
        pointers[c + 1] = pointers[c] + number
    columns, values = np.empty(pointers[-1], np.int32), np.zeros(pointers[-1])
    seen[:] = -1
    for c in range(count):
        here = np.int64(pointers[c])
        columns[here], seen[c], free = c, here, here + 1
        for s in range(start[c], start[c + 1]):
            values[here] += scale * diagonal[rows[s]]
            for e in range(indptr[rows[s]], indptr[rows[s] + 1]):
                d = owner[indices[e]]
                if d < 0:
                    continue
                if seen[d] < here:
                    columns[free], seen[d] = d, free
                    free += 1
                values[seen[d]] -= scale * conductance[e]
    return pointers, columns, values


@njit(**IN_PIECES)
def arrange(first, last, links, scale, level):
    """Copy links into the order of a Level.

    first, last : int; blocks
    links : Links
    scale : float, K/W; values are scale times conductance
    level : Level, out; all but its inverse diagonal; its pointers are those of the links
    """
    indptr, indices, conductance = links
    ends, place, values = level.ends, level.place, level.values
    for block in range(first, last):
        head, end = block * ROWS, min(len(ends), (block + 1) * ROWS)
        for i in range(head, end):
            begin = indptr[i]
            low, high = begin, indptr[i + 1]
            for e in range(begin, indptr[i + 1]):
                j = indices[e]
                if head <= j < i:
                    place[low], values[low] = e - begin, scale * conductance[e]
                    low += 1
                elif i < j < end:
                    high -= 1
                    place[high], values[high] = e - begin, scale * conductance[e]
            ends[i, 0], ends[i, 1] = low - begin, high - begin
            for e in range(begin, indptr[i + 1]):
                j = indices[e]
                if not (head <= j < end) or j == i:
                    place[low], values[low] = e - begin, scale * conductance[e]
                    low += 1


@njit(**IN_PIECES)
def forward(first, last, level, r, x):
    """One forward Gauss-Seidel sweep from zero, within blocks.

    first, last : int; blocks
    level : Level
    r : (n,) float32 array; right-hand side
    x : (n,) float32 array, out
    """
    indptr, indices, ends, place, values, inverse = level
    n = len(r)
    for block in range(first, last):
        for i in range(block * ROWS, min(n, (block + 1) * ROWS)):
            flow, begin = r[i], np.uint64(indptr[i])
            for e in range(begin, begin + ends[i, 0]):
                flow += values[e] * x[indices[begin + place[e]]]
            x[i] = flow * inverse[i]


@njit(**IN_PIECES)
def defect(first, last, level, x, d):
    """What is left of the equation after a forward sweep: r - A x, which is what the links that it left out bring.

    first, last : int; rows
    level : Level
    x : (n,) float32 array; of `forward`
    d : (n,) float32 array, out
    """
    indptr, indices, ends, place, values, _ = level
    for i in range(np.uint64(first), np.uint64(last)):
        flow, begin = np.float32(0.0), np.uint64(indptr[i])
        for e in range(begin + ends[i, 0], np.uint64(indptr[i + np.uint64(1)])):
            flow += values[e] * x[indices[begin + place[e]]]
        d[i] = flow


@njit(**IN_PIECES)
def restrict(first, last, aggregates, d, coarse):
    """Add up values over each aggregate.

    first, last : int; aggregates
    aggregates : Aggregates
    d : (n,) float32 array
    coarse : (aggregates,) float array, out
    """
    _, start, rows = aggregates
    for c in range(first, last):
        total = 0.0
        for s in range(start[c], start[c + 1]):
            total += np.float64(d[rows[s]])
        coarse[c] = total


@njit(**IN_PIECES)
def correct(first, last, aggregates, coarse, weight, x):
    """Add the value of its aggregate, times a weight, to each particle's.

    first, last : int; rows
    aggregates : Aggregates
    coarse : (aggregates,) float array
    weight : float
    x : (n,) float32 array, in and out
    """
    owner, _, _ = aggregates
    for i in range(np.uint64(first), np.uint64(last)):
        if owner[i] >= 0:
            x[i] += np.float32(weight * coarse[owner[i]])


@njit(**IN_PIECES)
def backward(first, last, level, r, x, y):
    """One backward Gauss-Seidel sweep, within blocks.

    first, last : int; blocks
    level : Level
    r : (n,) float32 array; right-hand side
    x : (n,) float32 array; where it starts from
    y : (n,) float32 array, out
    """
    indptr, indices, ends, place, values, inverse = level
    n = len(r)
    for block in range(first, last):
        for i in range(min(n, (block + 1) * ROWS) - 1, block * ROWS - 1, -1):
            flow, begin = r[i], np.uint64(indptr[i])
            for e in range(begin, begin + ends[i, 1]):
                flow += values[e] * x[indices[begin + place[e]]]
            for e in range(begin + ends[i, 1], np.uint64(indptr[i + 1])):
                flow += values[e] * y[indices[begin + place[e]]]
            y[i] = flow * inverse[i]
