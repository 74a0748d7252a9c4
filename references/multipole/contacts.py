"""Spheres that nearly touch, or do: what two of them make at each other by all degrees, among the few of the whole.

Bonnecaze and Brady, Proc. R. Soc. A 430 (1990) 285, add to dipoles of all spheres what two of them do beyond that. Here
pairs within reach of each other are exact alone (`two_spheres`), for any field that comes to them from elsewhere, in
degrees up to an order; all others exchange a few degrees. What is left falls by a factor with each degree of the order,
however narrow the gaps: sources near one contact of a sphere are no nearer to the next one than the contacts are.
"""

import math

import numpy as np

from demheat.runtime.progress import stage
from references.multipole.arrangement import Pairs, near
from references.multipole.exchange import exchange
from references.multipole.sums import entries
from references.multipole.translations import complex_table, received
from references.multipole.turns import turned
from references.multipole.two_spheres import Two, direct, exchanged

# Of the radii's mean: pairs with wider gaps are left to the few degrees of the whole, 1e-6 of what they do.
WIDEST, FEW = 0.5, 16
# Part of the order up to which what comes to a pair from elsewhere is known: of a third to seven tenths, on cubic
# arrays down to gaps of 1e-3, two fifths left the least in most.
PART = 0.4
# Orders that are tried, and bytes of tables at most.
ORDERS, MOST_BYTES = (16, 24, 32, 40, 48, 56, 64, 72), 2e9
# Digits by which two pairs count as alike.
ALIKE = 12


def near_pairs(spheres) -> Pairs:
    """Pairs whose gap is less than `WIDEST`."""
    radii = spheres.radii
    here, there, way = near(spheres, np.full(spheres.count, (2 + WIDEST) * float(radii.max())))
    kept = np.linalg.norm(way, axis=1) < (2 + WIDEST) * 0.5 * (radii[here] + radii[there])
    return Pairs(here[kept], there[kept], way[kept])


class Contacts:
    """What spheres make at each other: near pairs by all degrees, the others by few."""

    def __init__(self, spheres, order, precision):
        self.pairs, self.order, self.few = near_pairs(spheres), order, min(order, FEW)
        self.table = exchange(spheres, self.few, precision)
        self.precision = self.table.precision
        x, y, z = self.pairs.way.T
        self.angles = np.stack([np.arctan2(np.hypot(x, y), z), np.arctan2(y, x)], axis=1)
        kinds, self.kind = _kinds(spheres, self.pairs)
        reach, self.tables = math.ceil(PART * order), []
        with stage("pairs of spheres") as done:
            for m in range(max(reach, self.few) + 1):
                self.tables.append(np.stack([self._table(two, m, reach) for two in kinds]))
                done((m + 1) / (max(reach, self.few) + 1))

    def _table(self, two, m, reach):
        """By all degrees, less by the few of the whole."""
        count = self.order + 1 - m
        table = exchanged(two, self.order, m, reach) if m <= reach else np.zeros((count, 2 * count))
        few = np.arange(m, self.few + 1.0)
        table[: len(few), count : count + len(few)] -= direct(two, few, m)
        return table

    def received(self, spheres, table, source, threads=1):
        """As `translations.received` has it; the table is this."""
        assert table is self
        total = self._of_pairs(source, spheres.count)
        few = (self.few + 1) * (self.few + 2) // 2
        total[:, :, :few] += received(spheres, self.table, np.ascontiguousarray(source[:, :, :few]), threads)
        return total

    def _of_pairs(self, source, count):
        here, there, _ = self.pairs
        n, m = entries(self.order)
        table = complex_table(source)
        # Either z points to the other.
        one, two = turned(table[here], self.angles), turned(table[there], self.angles) * (-1.0) ** (n + m)
        result = np.zeros_like(one)
        for k, tables in enumerate(self.tables):
            own = np.flatnonzero(m == k)
            both = np.concatenate([one[:, own], two[:, own]], axis=1)
            result[:, own] = np.einsum("kij,kj->ki", tables[self.kind], both)
        result = turned(result, self.angles, back=True)
        total = np.zeros((2, count, source.shape[2]))
        np.add.at(total[0], here, result.real)
        np.add.at(total[1], here, result.imag)
        return total


def _kinds(spheres, pairs):
    """Unlike pairs, and which of them each pair is."""
    columns = [np.linalg.norm(pairs.way, axis=1)]
    for each in (spheres.radii, spheres.contrasts, spheres.resistances):
        columns += [each[pairs.here], each[pairs.there]]
    rows = np.stack(columns, axis=1)
    _, first, kind = np.unique(np.round(rows, ALIKE), axis=0, return_index=True, return_inverse=True)
    return [Two(row[0], *(tuple(row[k : k + 2]) for k in (1, 3, 5))) for row in rows[first].tolist()], kind.ravel()


def highest_order(spheres) -> int:
    """Highest order whose tables fit into memory, 0 if none does or no pair is near."""
    pairs = near_pairs(spheres)
    if not len(pairs.here):
        return 0
    kinds = len(_kinds(spheres, pairs)[0])
    fits = [order for order in ORDERS if 16 * kinds * sum((order - m) ** 2 for m in range(order)) <= MOST_BYTES]
    return max(fits, default=0)
