"""Numba kernels that turn and translate multipoles along z, many at a time: lanes of an array's last axis.

The turns and tables are those of `axes`. A table of one degree or of all stands as rows of lanes, real and imaginary
parts apart; what moves along z stands order by order, row `column(m, order) + l`.
"""

import math

import numba

import demheat.runtime.compiled  # noqa: F401 (where compiled kernels are kept)

OPTIONS = {"cache": True, "nogil": True, "fastmath": {"reassoc", "contract", "arcp", "nsz"}}
compiled = numba.njit(**OPTIONS)
# For what only kernels call: there is no way in from Python, which takes a third of the time to compile.
inner = numba.njit(no_cpython_wrapper=True, no_cfunc_wrapper=True, **OPTIONS)

# Fewer would spend their time on calls, more would not stay in a processor's cache.
LANES = 64


@compiled
def column(m, order):
    """Where the rows of one m begin, less m, in tables of all m from 0 and all l from m to the order.

    m, order : int
    """
    return m * (order + 1) - m * (m + 1) // 2


@compiled
def add_rows(out, part, row, source, of, first, step, table, entry, count):
    """One row of a product: out[part, row] = sum over i < count of table[entry + i] source[of, first + i step].

    Whole arrays and numbers instead of views of them: counting references to views would cost more than the sum.

    out : (2, rows, LANES) float array
    part, row : int
    source : (2, rows, LANES) float array; not out
    of, first, step : int
    table : (n,) float array
    entry, count : int
    """
    i = count % 4
    one, two, three = first, first + step, first + 2 * step
    if i == 0:
        for k in range(LANES):
            out[part, row, k] = 0.0
    elif i == 1:
        a = table[entry]
        for k in range(LANES):
            out[part, row, k] = a * source[of, one, k]
    elif i == 2:
        a, b = table[entry], table[entry + 1]
        for k in range(LANES):
            out[part, row, k] = a * source[of, one, k] + b * source[of, two, k]
    else:
        a, b, c = table[entry], table[entry + 1], table[entry + 2]
        for k in range(LANES):
            out[part, row, k] = a * source[of, one, k] + b * source[of, two, k] + c * source[of, three, k]
    while i < count:
        a, b, c, d = table[entry + i], table[entry + i + 1], table[entry + i + 2], table[entry + i + 3]
        one = first + i * step
        two, three, four = one + step, one + 2 * step, one + 3 * step
        for k in range(LANES):
            out[part, row, k] += (a * source[of, one, k] + b * source[of, two, k]) + (
                c * source[of, three, k] + d * source[of, four, k]
            )
        i += 4


@compiled
def swap_axes(degree, swap, table, out):
    """Exchange y and z in rows m = 0, ..., degree of one degree.

    degree : int
    swap : (n,) float array; that of `axes.Axes`
    table, out : (2, rows, LANES) float arrays
    """
    # (l + 1)^2 numbers for each lower degree.
    entry = degree * (degree + 1) * (2 * degree + 1) // 6
    same, other = degree % 2, 1 - degree % 2
    many = degree // 2 + 1
    few = degree + 1 - many
    for m in range(degree + 1):
        of = (degree + m) % 2
        add_rows(out, 0, m, table, of, same, 2, swap, entry, many)
        add_rows(out, 1, m, table, of, other, 2, swap, entry + many, few)
        entry += many + few


@compiled
def turn_rows(source, first, cosine, sine, sign, out, to, rows):
    """Multiply rows m = 0, ..., rows - 1 by exp(sign i m angle), lane by lane.

    source : (2, n, LANES) float array; may be out
    first : int; row of m = 0 there
    cosine, sine : (order + 1, LANES) float arrays; of m times the angle
    sign : float
    out : (2, n, LANES) float array
    to : int; row of m = 0 there
    rows : int
    """
    for m in range(rows):
        for k in range(LANES):
            x, y, c, s = source[0, first + m, k], source[1, first + m, k], cosine[m, k], sign * sine[m, k]
            out[0, to + m, k] = x * c - y * s
            out[1, to + m, k] = x * s + y * c


@compiled
def point(lane, x, y, z, turns):
    """Cosines and sines of phi and of theta of a direction, in rows 1 of `turns`; z itself for no direction.

    lane : int
    x, y, z : float
    turns : (4, order + 1, LANES) float array; out: cosines and sines of m phi, then those of m theta; here m = 1
    Returns float: length of (x, y, z)
    """
    flat = math.sqrt(x * x + y * y)
    r = math.sqrt(flat * flat + z * z)
    turns[0, 1, lane], turns[1, 1, lane] = (x / flat, y / flat) if flat > 0.0 else (1.0, 0.0)
    turns[2, 1, lane], turns[3, 1, lane] = (z / r, flat / r) if r > 0.0 else (1.0, 0.0)
    return r


@compiled
def multiples(order, turns):
    """Cosines and sines of all multiples of the angles in rows 1.

    order : int
    turns : (4, order + 1, LANES) float array; in and out, as in `point`
    """
    for angle in range(0, 4, 2):
        c, s = turns[angle], turns[angle + 1]
        for k in range(LANES):
            c[0, k], s[0, k] = 1.0, 0.0
        for m in range(2, order + 1):
            for k in range(LANES):
                c[m, k] = c[m - 1, k] * c[1, k] - s[m - 1, k] * s[1, k]
                s[m, k] = c[m - 1, k] * s[1, k] + s[m - 1, k] * c[1, k]


@compiled
def forth(most, order, axes, turns, table, work, out):
    """Turn multipoles, or local coefficients, so that the direction of each lane becomes z.

    most : int; highest degree
    order : int; of the table out
    axes : Axes
    turns : (4, most + 1, LANES) float array; as `multiples` makes it
    table : (2, entries, LANES) float array; degree by degree
    work : (2, 2, most + 1, LANES) float array; overwritten
    out : (2, entries, LANES) float array; order by order, rows as in `column`
    """
    one, two = work[0], work[1]
    for n in range(most + 1):
        turn_rows(table, n * (n + 1) // 2, turns[0], turns[1], 1.0, one, 0, n + 1)
        swap_axes(n, axes.swap, one, two)
        turn_rows(two, 0, turns[2], turns[3], -1.0, two, 0, n + 1)
        swap_axes(n, axes.swap, two, one)
        for m in range(n + 1):
            row = column(m, order) + n
            for k in range(LANES):
                out[0, row, k], out[1, row, k] = one[0, m, k], one[1, m, k]


@compiled
def back(most, order, axes, turns, table, work, out):
    """The reverse of `forth`.

    most : int; highest degree
    order : int; of the table
    axes : Axes
    turns : (4, most + 1, LANES) float array; as `multiples` makes it
    table : (2, entries, LANES) float array; order by order, rows as in `column`
    work : (2, 2, most + 1, LANES) float array; overwritten
    out : (2, entries, LANES) float array; degree by degree
    """
    one, two = work[0], work[1]
    for n in range(most + 1):
        for m in range(n + 1):
            row = column(m, order) + n
            for k in range(LANES):
                one[0, m, k], one[1, m, k] = table[0, row, k], table[1, row, k]
        swap_axes(n, axes.swap, one, two)
        turn_rows(two, 0, turns[2], turns[3], 1.0, two, 0, n + 1)
        swap_axes(n, axes.swap, two, one)
        turn_rows(one, 0, turns[0], turns[1], -1.0, out, n * (n + 1) // 2, n + 1)
