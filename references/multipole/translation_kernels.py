"""Numba kernel of the translation of multipoles between spheres.

Unnormalised harmonics, R_l^m = r^l P_l^m exp(i m p) / (l+m)! and I_l^m = (l-m)! P_l^m exp(i m p) / r^(l+1) with Condon
and Shortley's sign: translations of these are plain sums without binomials (Epton and Dembart, SIAM J. Sci. Comput. 16
(1995) 865). Entry (l, m >= 0) of a table stands at l (l + 1)/2 + m; -m follows from f_l^-m = (-1)^m conj(f_l^m).
"""

import numpy as np

from references.multipole.lane_kernels import compiled, inner


@compiled
def translate(order, table, sent, made, low, high):
    """What all spheres and their periodic images make at the spheres low, ..., high - 1.

    I_l^m(X + y) = sum over l'm' of (-1)^l' conj(R_l'^m'(y)) I_(l+l')^(m+m')(X).

    order : int; highest degree that spheres send and receive
    table : Translation
    sent : (2, spheres, entries) float array, K length^(l+1); real and imaginary parts of the multipoles
    made : (2, receivers, entries) float array, K length^-l; out: coefficients of R_l'^m'
    low, high : int; rows of `made` to work out
    """
    spheres, width = sent.shape[1], 2 * order
    full = np.zeros((2, width + 1, 2 * width + 1))
    send = np.zeros((2, order + 1, 2 * order + 1))
    for i in range(low, high):
        made[0, i], made[1, i] = 0.0, 0.0
        for j in range(spheres):
            a, b = min(i, j), max(i, j)
            pair = 0 if a == b else 1 + a * spheres - a * (a + 1) // 2 + b - a - 1
            most = min(table.top[pair], width)
            _unfold(full, table.sums[pair].real, table.sums[pair].imag, most, i > j)
            _unfold(send, sent[0, j], sent[1, j], order, False)
            for p in range(min(order, most - 1) + 1):
                sign = -1.0 if p % 2 else 1.0
                for q in range(p + 1):
                    x, y = _correlate(full, send, p, q, min(order, most - p))
                    made[0, i, p * (p + 1) // 2 + q] += sign * x
                    # The coefficient of conj(R) conjugated is that of R, for the sum is real.
                    made[1, i, p * (p + 1) // 2 + q] -= sign * y


@inner
def _unfold(full, re, im, degree, flip):
    """Entries of both signs of m, in the middle of each row; times (-1)^l if `flip`."""
    middle = full.shape[2] // 2
    for n in range(degree + 1):
        sign = -1.0 if flip and n % 2 else 1.0
        for m in range(n + 1):
            x, y = sign * re[n * (n + 1) // 2 + m], sign * im[n * (n + 1) // 2 + m]
            other = -1.0 if m % 2 else 1.0
            full[0, n, middle - m], full[1, n, middle - m] = other * x, -other * y
            full[0, n, middle + m], full[1, n, middle + m] = x, y


@inner
def _correlate(full, send, p, q, most):
    """Sum over l = 1, ..., most and all m of I_(l+p)^(m+q) times the multipole lm."""
    width, order = full.shape[1] - 1, send.shape[1] - 1
    x, y = 0.0, 0.0
    for n in range(1, most + 1):
        there_re, there_im = full[0, n + p, width + q - n : width + q + n + 1], full[1, n + p, width + q - n :]
        here_re, here_im = send[0, n, order - n : order + n + 1], send[1, n, order - n :]
        for k in range(2 * n + 1):
            x += there_re[k] * here_re[k] - there_im[k] * here_im[k]
            y += there_re[k] * here_im[k] + there_im[k] * here_re[k]
    return x, y
