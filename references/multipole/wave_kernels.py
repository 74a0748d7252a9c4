"""Numba kernel of the convolution of cells' multipoles with what one cell makes at another, wave by wave."""

import numpy as np

from references.multipole.lane_kernels import compiled, inner

# Fields that share one matrix: real and imaginary parts of four waves.
FIELDS = 8


@compiled
def convolve(degree, sums, sent, made, low, high):
    """Translations between cells for waves low, ..., high - 1.

    Made of l'm' is the conjugate of (-1)^l' times the sum over l = 1, ..., degree and all m of I_(l+l')^(m+m') times
    the multipole lm, all by the kernels' harmonics (see `translation_kernels`).

    degree : int; highest degree sent and made
    sums : (2, waves, entries of 2 degree) float array, length^-(L+1); real and imaginary parts of I
    sent : (waves, FIELDS, 2 entries) float array, K length^(l+1); real parts of all multipoles, then imaginary ones;
      those of m = 0, and degree 0, do not matter
    made : (waves, FIELDS, 2 entries) float array, K length^-l; out
    low, high : int
    """
    width, middle = (degree + 1) * (degree + 2) // 2, 2 * degree
    full, rows = np.zeros((2, 2 * degree + 1, 4 * degree + 1)), np.zeros((2, 2 * width))
    for wave in range(low, high):
        for n in range(2 * degree + 1):
            for m in range(n + 1):
                x, y = sums[0, wave, n * (n + 1) // 2 + m], sums[1, wave, n * (n + 1) // 2 + m]
                other = -1.0 if m % 2 else 1.0
                full[0, n, middle - m], full[1, n, middle - m] = other * x, -other * y
                full[0, n, middle + m], full[1, n, middle + m] = x, y
        for p in range(degree + 1):
            sign = -1.0 if p % 2 else 1.0
            for q in range(p + 1):
                _rows(full, p, q, degree, rows)
                entry = p * (p + 1) // 2 + q
                for field in range(0, FIELDS, 4):
                    _products(rows[0], sent[wave, field : field + 4], sign, made[wave, field : field + 4], entry)
                    _products(
                        rows[1], sent[wave, field : field + 4], -sign, made[wave, field : field + 4], width + entry
                    )


@inner
def _rows(full, p, q, degree, rows):
    """One row of the matrix for the real part of what is made, one for the imaginary part."""
    width, middle = rows.shape[1] // 2, 2 * degree
    for n in range(1, degree + 1):
        entry = n * (n + 1) // 2
        above_re, above_im = full[0, n + p, middle + q :], full[1, n + p, middle + q :]
        below_re, below_im = full[0, n + p, middle + q - n :], full[1, n + p, middle + q - n :]
        rows[0, entry], rows[1, entry] = above_re[0], above_im[0]
        for m in range(1, n + 1):
            other = -1.0 if m % 2 else 1.0
            x, y = other * below_re[n - m], other * below_im[n - m]
            rows[0, entry + m], rows[0, width + entry + m] = above_re[m] + x, y - above_im[m]
            rows[1, entry + m], rows[1, width + entry + m] = above_im[m] + y, above_re[m] - x


@inner
def _products(row, sent, sign, made, entry):
    """Four products of one row at once: each of its numbers is read once."""
    a, b, c, d = 0.0, 0.0, 0.0, 0.0
    one, two, three, four = sent[0], sent[1], sent[2], sent[3]
    for k in range(len(row)):
        a += row[k] * one[k]
        b += row[k] * two[k]
        c += row[k] * three[k]
        d += row[k] * four[k]
    made[0, entry], made[1, entry], made[2, entry], made[3, entry] = sign * a, sign * b, sign * c, sign * d
