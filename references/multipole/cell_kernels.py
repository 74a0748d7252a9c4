"""Numba kernels of the fast multipole method: spheres in near cells, and between spheres and their own cells.

Spheres are numbered cell by cell, as in `cells.Cells`; their tables are (2, spheres, entries), real and imaginary
parts, as in `translations`, times radius^(l+1) where they are sent and radius^-l where they are made. Lanes are filled
with the spheres of a fixed block, so that no bit depends on how many threads share the blocks.
"""

import math

import numpy as np

from references.multipole.lane_kernels import LANES, add_rows, back, column, compiled, forth, inner, multiples, point

# Spheres whose lanes are filled together.
BLOCK = 8


@compiled
def near(order, cells, axes, sent, made, low, high):
    """What spheres and images in near cells make at the spheres of blocks low, ..., high - 1.

    order : int
    cells : Cells
    axes : Axes; up to the order
    sent : (2, n, entries) float array, K length^(l+1)
    made : (2, receivers, entries) float array, K length^-l; out
    low, high : int
    """
    width = (order + 1) * (order + 2) // 2
    tables, work = np.zeros((2, 2, width, LANES)), np.zeros((2, 2, order + 1, LANES))
    turns, inverse, ratio = np.zeros((4, order + 1, LANES)), np.zeros((order + 2, LANES)), np.zeros((2, LANES))
    sender, receiver = np.zeros(LANES, dtype=np.int64), np.zeros(LANES, dtype=np.int64)
    for k in range(LANES):
        inverse[0, k] = 1.0
    shape, edge = cells.shape, cells.edge
    for block in range(low, high):
        lane = 0
        for row in range(block * BLOCK, min((block + 1) * BLOCK, len(cells.receivers))):
            for entry in range(width):
                made[0, row, entry] = made[1, row, entry] = 0.0
            i = cells.receivers[row]
            home = cells.home[i]
            x, y, z = home // (shape[1] * shape[2]), home // shape[2] % shape[1], home % shape[2]
            for k in range(len(cells.near)):
                a, b, c = cells.near[k, 0], cells.near[k, 1], cells.near[k, 2]
                there = ((x + a) % shape[0] * shape[1] + (y + b) % shape[1]) * shape[2] + (z + c) % shape[2]
                for j in range(cells.start[there], cells.start[there + 1]):
                    if j == i and a == 0 and b == 0 and c == 0:
                        continue
                    dx = cells.places[i, 0] - cells.places[j, 0] - a * edge[0]
                    dy = cells.places[i, 1] - cells.places[j, 1] - b * edge[1]
                    dz = cells.places[i, 2] - cells.places[j, 2] - c * edge[2]
                    r = point(lane, dx, dy, dz, turns)
                    inverse[1, lane], sender[lane], receiver[lane] = 1.0 / r, j, row
                    ratio[0, lane] = cells.radii[j] / max(r - cells.radii[i], 1e-9 * r)
                    ratio[1, lane] = cells.radii[i] / max(r - cells.radii[j], 1e-9 * r)
                    lane += 1
                    if lane == LANES:
                        _exchange(
                            lane,
                            order,
                            cells.negligible,
                            axes,
                            turns,
                            inverse,
                            ratio,
                            sender,
                            receiver,
                            tables,
                            work,
                            sent,
                            made,
                        )
                        lane = 0
        if lane:
            _exchange(
                lane, order, cells.negligible, axes, turns, inverse, ratio, sender, receiver, tables, work, sent, made
            )


@inner
def _exchange(lanes, order, negligible, axes, turns, inverse, ratio, sender, receiver, tables, work, sent, made):
    """Translate the multipoles of the senders in lanes and add what arrives to the receivers."""
    sends, receives = 0.0, 0.0
    for k in range(lanes):
        sends, receives = max(sends, ratio[0, k]), max(receives, ratio[1, k])
    most, arrives = _degree(sends, negligible, order), _degree(receives, negligible, order)
    one, two = tables[0], tables[1]
    multiples(max(most, arrives), turns)
    for k in range(lanes):
        for entry in range((most + 1) * (most + 2) // 2):
            one[0, entry, k], one[1, entry, k] = sent[0, sender[k], entry], sent[1, sender[k], entry]
    forth(most, order, axes, turns, one, work, two)
    _raise(inverse, max(most, arrives) + 1)
    for m in range(most + 1):
        for n in range(max(m, 1), most + 1):
            _scale(two, column(m, order) + n, inverse, n + 1)
    size = len(axes.shift)
    for m in range(arrives + 1):
        first, top = max(m, 1), column(m, order)
        for n in range(m, arrives + 1):
            weights = (m * size + n) * size + first
            for part in range(2):
                add_rows(one, part, top + n, two, part, top + first, 1, axes.along, weights, max(0, most - first + 1))
            _scale(one, top + n, inverse, n)
    back(arrives, order, axes, turns, one, work, two)
    begin = 0
    while begin < lanes:
        end = begin + 1
        while end < lanes and receiver[end] == receiver[begin]:
            end += 1
        for part in range(2):
            for entry in range((arrives + 1) * (arrives + 2) // 2):
                total = 0.0
                for k in range(begin, end):
                    total += two[part, entry, k]
                made[part, receiver[begin], entry] += total
        begin = end


@inner
def _raise(powers, most):
    """Powers 2, ..., most of row 1."""
    for n in range(2, most + 1):
        for k in range(LANES):
            powers[n, k] = powers[n - 1, k] * powers[1, k]


@inner
def _scale(table, row, powers, power):
    for part in range(2):
        for k in range(LANES):
            table[part, row, k] *= powers[power, k]


@inner
def _degree(ratio, negligible, order):
    """Degree beyond which ratio^l is negligible, or the order."""
    if ratio >= 1.0 - 1e-9 or math.log(negligible) <= order * math.log(ratio):
        return order
    return max(1, int(math.ceil(math.log(negligible) / math.log(ratio))))


@compiled
def gather(order, degree, cells, axes, sent, made, low, high):
    """Multipoles of spheres about the middles of their cells, for lanes low, ..., high - 1 of spheres.

    order, degree : int; of the spheres' multipoles and of the cells', the latter higher or equal
    cells : Cells
    axes : Axes; up to the degree
    sent : (2, n, entries) float array, K length^(l+1)
    made : (2, n, entries) float array, K length^(L+1); out
    low, high : int
    """
    tables, turns, work, powers = _shift_room(degree)
    one, two = tables[0], tables[1]
    for block in range(low, high):
        lanes = min(LANES, len(cells.places) - block * LANES)
        for k in range(lanes):
            _shift(k, cells.places, block * LANES + k, turns, powers)
        _multiply(turns, powers)
        for k in range(lanes):
            for entry in range((order + 1) * (order + 2) // 2):
                for part in range(2):
                    one[part, entry, k] = sent[part, block * LANES + k, entry]
        forth(order, degree, axes, turns, one, work, two)
        for m in range(degree + 1):
            top = column(m, degree)
            for n in range(m, degree + 1):
                for part in range(2):
                    _clear(one, part, top + n)
                    for of in range(max(m, 1), min(order, n) + 1):
                        _add_shifted(one, part, top + n, two, top + of, powers, n - of, axes.shift[m, n, of])
        back(degree, degree, axes, turns, one, work, two)
        for k in range(lanes):
            for part in range(2):
                for entry in range(made.shape[2]):
                    made[part, block * LANES + k, entry] = two[part, entry, k]


@compiled
def spread(order, degree, cells, axes, local, made, low, high):
    """Add what cells' local coefficients are at their spheres, for lanes low, ..., high - 1 of receivers.

    order, degree : int; of the spheres' local coefficients and of the cells', the latter higher or equal
    cells : Cells
    axes : Axes; up to the degree
    local : (2, cells, entries) float array, K length^-L
    made : (2, receivers, entries) float array, K length^-l; in and out
    low, high : int
    """
    tables, turns, work, powers = _shift_room(degree)
    one, two = tables[0], tables[1]
    for block in range(low, high):
        lanes = min(LANES, len(cells.receivers) - block * LANES)
        for k in range(lanes):
            _shift(k, cells.places, cells.receivers[block * LANES + k], turns, powers)
        _multiply(turns, powers)
        for k in range(lanes):
            home = cells.home[cells.receivers[block * LANES + k]]
            for part in range(2):
                for entry in range(local.shape[2]):
                    one[part, entry, k] = local[part, home, entry]
        forth(degree, degree, axes, turns, one, work, two)
        for m in range(order + 1):
            top = column(m, degree)
            for n in range(m, order + 1):
                for part in range(2):
                    _clear(one, part, top + n)
                    for of in range(n, degree + 1):
                        _add_shifted(one, part, top + n, two, top + of, powers, of - n, axes.shift[m, of, n])
        back(order, degree, axes, turns, one, work, two)
        for k in range(lanes):
            for part in range(2):
                for entry in range((order + 1) * (order + 2) // 2):
                    made[part, block * LANES + k, entry] += two[part, entry, k]


@inner
def _shift_room(degree):
    width = (degree + 1) * (degree + 2) // 2
    tables, work = np.zeros((2, 2, width, LANES)), np.zeros((2, 2, degree + 1, LANES))
    return tables, np.zeros((4, degree + 1, LANES)), work, np.zeros((degree + 1, LANES))


@inner
def _clear(table, part, row):
    for k in range(LANES):
        table[part, row, k] = 0.0


@inner
def _shift(lane, places, sphere, turns, powers):
    """Direction of a sphere from the middle of its cell, and its distance."""
    powers[0, lane] = 1.0
    powers[1, lane] = point(lane, places[sphere, 0], places[sphere, 1], places[sphere, 2], turns)


@inner
def _multiply(turns, powers):
    _raise(powers, len(powers) - 1)
    multiples(len(powers) - 1, turns)


@inner
def _add_shifted(out, part, row, source, of, powers, power, weight):
    for k in range(LANES):
        out[part, row, k] += weight * powers[power, k] * source[part, of, k]
