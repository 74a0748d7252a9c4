"""Numba kernels of the multipole method at points: whose they are, regular series inside, Ewald's two sums outside.

Harmonics and their tables are those of `translation_kernels`. Spheres and Ewald's splitting come in as the NamedTuples
`translations.Spheres` and `sums.Splitting`.
"""

import math

import numpy as np

from references.multipole.lane_kernels import compiled, inner


@compiled
def owners(points, spheres, owner):
    """Sphere that a point lies in or on, or -1, and its offset from that sphere's nearest image.

    points : (n, 3) float array, length; changed in place where a sphere owns the point: to the offset
    spheres : Spheres
    owner : (n,) int array; out
    """
    centers, radii, size = spheres.centers, spheres.radii, spheres.size
    for k in range(len(points)):
        owner[k] = -1
        for j in range(len(centers)):
            x, y, z = points[k, 0] - centers[j, 0], points[k, 1] - centers[j, 1], points[k, 2] - centers[j, 2]
            x -= size[0] * round(x / size[0])
            y -= size[1] * round(y / size[1])
            z -= size[2] * round(z / size[2])
            if x * x + y * y + z * z <= radii[j] * radii[j]:
                owner[k] = j
                points[k, 0], points[k, 1], points[k, 2] = x, y, z
                break


@compiled
def regular(table, x, y, z, order):
    """R_l^m of one point.

    table : (entries,) complex array, length^l; out
    x, y, z : float, length
    order : int; highest degree
    """
    square = x * x + y * y + z * z
    table[0] = 1.0
    for m in range(order + 1):
        if m > 0:
            table[m * (m + 1) // 2 + m] = -(x + 1j * y) / (2.0 * m) * table[(m - 1) * m // 2 + m - 1]
        for n in range(m + 1, order + 1):
            up = (2 * n - 1) * z * table[(n - 1) * n // 2 + m]
            if n > m + 1:
                up -= square * table[(n - 2) * (n - 1) // 2 + m]
            table[n * (n + 1) // 2 + m] = up / ((n - m) * (n + m))


@compiled
def irregular(table, x, y, z, order):
    """I_l^m of one point.

    table : (entries,) complex array, length^-(l+1); out
    x, y, z : float, length; not all zero
    order : int; highest degree
    """
    square = x * x + y * y + z * z
    table[0] = 1.0 / math.sqrt(square)
    for m in range(order + 1):
        if m > 0:
            table[m * (m + 1) // 2 + m] = -(2.0 * m - 1) * (x + 1j * y) / square * table[(m - 1) * m // 2 + m - 1]
        for n in range(m + 1, order + 1):
            up = (2 * n - 1) * z * table[(n - 1) * n // 2 + m]
            if n > m + 1:
                up -= ((n - 1) ** 2 - m * m) * table[(n - 2) * (n - 1) // 2 + m]
            table[n * (n + 1) // 2 + m] = up / square


@compiled
def inside(offsets, owner, coefficients, order, out):
    """Temperature and slope of the regular series of the sphere that owns each point.

    d/dz R_l^m = R_(l-1)^m and (d/dx + i d/dy) R_l^m = R_(l-1)^(m+1).

    offsets : (n, 3) float array, length; from the centres of these spheres
    owner : (n,) int array
    coefficients : (spheres, entries) complex array, K length^-l
    order : int; highest degree
    out : (n, 4) float array, K and K/length; out: temperature, then its slope
    """
    table = np.zeros((order + 1) * (order + 2) // 2, dtype=np.complex128)
    for k in range(len(offsets)):
        regular(table, offsets[k, 0], offsets[k, 1], offsets[k, 2], order)
        c = coefficients[owner[k]]
        value, across, along = 0.0, 0.0 + 0.0j, 0.0
        for n in range(order + 1):
            for m in range(n + 1):
                factor = c[n * (n + 1) // 2 + m]
                twice = 1.0 if m == 0 else 2.0
                value += twice * (factor * table[n * (n + 1) // 2 + m]).real
                below = (n - 1) * n // 2
                if m <= n - 1:
                    along += twice * (factor * table[below + m]).real
                if m + 1 <= n - 1:
                    across += factor * table[below + m + 1]
                if m > 0:
                    across -= (factor * table[below + m - 1]).conjugate()
        out[k, 0], out[k, 1], out[k, 2], out[k, 3] = value, across.real, across.imag, along


@compiled
def screens(square, eta, screened):
    """Q(l+1/2, eta r^2) for l = 0, 1, ..., and twice its derivative by r^2.

    square : float, length^2; r^2
    eta : float, length^-2
    screened : (2, degrees) float array, 1 and length^-2; out
    """
    x = eta * square
    q, term = math.erfc(math.sqrt(x)), math.sqrt(x) * math.exp(-x) / (0.5 * math.sqrt(math.pi))
    for n in range(screened.shape[1]):
        # term is x^(n+1/2) exp(-x) / Gamma(n+3/2); dQ(a, x)/dx = -x^(a-1) exp(-x) / Gamma(a).
        screened[0, n] = q
        screened[1, n] = -2.0 * eta * term * (n + 0.5) / x
        q += term
        term *= x / (n + 1.5)


@compiled
def near(points, spheres, multipoles, order, split, out):
    """Add what spheres and images within reach make at points outside, each multipole screened.

    d/dz I_l^m = -I_(l+1)^m and (d/dx + i d/dy) I_l^m = I_(l+1)^(m+1).

    points : (n, 3) float array, length
    spheres : Spheres
    multipoles : (spheres, entries) complex array, K length^(l+1)
    order : int; highest degree
    split : Splitting
    out : (n, 4) float array, K and K/length; temperature, then its slope
    """
    centers, size, reach = spheres.centers, spheres.size, split.reach
    table = np.zeros((order + 2) * (order + 3) // 2, dtype=np.complex128)
    screened = np.zeros((2, order + 1))
    nx, ny, nz = int(reach / size[0] + 0.5), int(reach / size[1] + 0.5), int(reach / size[2] + 0.5)
    for k in range(len(points)):
        for j in range(len(centers)):
            x0, y0, z0 = points[k, 0] - centers[j, 0], points[k, 1] - centers[j, 1], points[k, 2] - centers[j, 2]
            x0 -= size[0] * round(x0 / size[0])
            y0 -= size[1] * round(y0 / size[1])
            z0 -= size[2] * round(z0 / size[2])
            for a in range(-nx, nx + 1):
                for b in range(-ny, ny + 1):
                    for c in range(-nz, nz + 1):
                        x, y, z = x0 + a * size[0], y0 + b * size[1], z0 + c * size[2]
                        square = x * x + y * y + z * z
                        if square <= reach * reach:
                            irregular(table, x, y, z, order + 1)
                            screens(square, split.eta, screened)
                            _add_screened(multipoles[j], table, screened, (x, y, z), out[k])


@inner
def _add_screened(multipoles, table, screened, offset, out):
    value, across, along, radial = 0.0, 0.0 + 0.0j, 0.0, 0.0
    for n in range(1, screened.shape[1]):
        here, above = n * (n + 1) // 2, (n + 1) * (n + 2) // 2
        v, d, s = 0.0, 0.0 + 0.0j, 0.0
        for m in range(n + 1):
            factor = multipoles[here + m]
            twice = 1.0 if m == 0 else 2.0
            v += twice * (factor * table[here + m]).real
            s -= twice * (factor * table[above + m]).real
            d += factor * table[above + m + 1]
            if m > 0:
                d -= (factor * table[above + m - 1]).conjugate()
        value += screened[0, n] * v
        across += screened[0, n] * d
        along += screened[0, n] * s
        radial += screened[1, n] * v
    x, y, z = offset
    out[0] += value
    out[1] += across.real + radial * x
    out[2] += across.imag + radial * y
    out[3] += along + radial * z


@compiled
def owners_by_cells(places, home, cells, owner):
    """Sphere that a point lies in or on, or -1, and its offset from that sphere's nearest image.

    places : (n, 3) float array, length; from the middle of the point's cell; changed in place where a sphere owns the
      point: to the offset
    home : (n,) int array; the points' cells
    cells : Cells
    owner : (n,) int array; out: by the cells' numbers
    """
    for k in range(len(places)):
        owner[k] = -1
        for step in range(len(cells.near)):
            there = _cell_at(home[k], cells.near[step], cells.shape)
            for j in range(cells.start[there], cells.start[there + 1]):
                x, y, z = _from_sphere(places[k], cells, step, j)
                if x * x + y * y + z * z <= cells.radii[j] ** 2:
                    owner[k] = j
                    break
            if owner[k] >= 0:
                places[k, 0], places[k, 1], places[k, 2] = x, y, z
                break


@compiled
def near_by_cells(places, home, cells, multipoles, order, out):
    """Add what spheres and images in near cells make at points outside.

    places : (n, 3) float array, length; from the middle of the point's cell
    home : (n,) int array; the points' cells
    cells : Cells
    multipoles : (spheres, entries) complex array, K length^(l+1); by the cells' numbers
    order : int; highest degree
    out : (n, 4) float array, K and K/length; temperature, then its slope
    """
    table = np.zeros((order + 2) * (order + 3) // 2, dtype=np.complex128)
    bare, negligible = np.zeros((2, order + 1)), math.log(cells.negligible)
    bare[0] = 1.0
    for k in range(len(places)):
        for step in range(len(cells.near)):
            there = _cell_at(home[k], cells.near[step], cells.shape)
            for j in range(cells.start[there], cells.start[there + 1]):
                x, y, z = _from_sphere(places[k], cells, step, j)
                ratio = math.log(cells.radii[j] ** 2 / (x * x + y * y + z * z)) / 2
                most = order
                if ratio * order < negligible:
                    most = max(1, int(math.ceil(negligible / ratio)))
                irregular(table, x, y, z, most + 1)
                _add_screened(multipoles[j], table, bare[:, : most + 1], (x, y, z), out[k])


@inner
def _cell_at(home, step, shape):
    x, y, z = home // (shape[1] * shape[2]), home // shape[2] % shape[1], home % shape[2]
    x, y, z = (x + step[0]) % shape[0], (y + step[1]) % shape[1], (z + step[2]) % shape[2]
    return (x * shape[1] + y) * shape[2] + z


@inner
def _from_sphere(place, cells, step, j):
    x = place[0] - cells.places[j, 0] - cells.near[step, 0] * cells.edge[0]
    y = place[1] - cells.places[j, 1] - cells.near[step, 1] * cells.edge[1]
    z = place[2] - cells.places[j, 2] - cells.near[step, 2] * cells.edge[2]
    return x, y, z


@compiled
def far(points, size, split, amplitudes, out):
    """Add 2 Re(F exp(i K.x)) over half of the reciprocal vectors, and its slope.

    points : (n, 3) float array, length
    size : (3,) float array, length; of the cell
    split : Splitting
    amplitudes : (waves,) complex array, K; F
    out : (n, 4) float array, K and K/length; temperature, then its slope
    """
    waves = split.waves
    most = np.abs(waves).max() if len(waves) else 0
    turns = np.zeros((3, 2 * most + 1), dtype=np.complex128)
    for k in range(len(points)):
        for axis in range(3):
            for n in range(-most, most + 1):
                angle = 2.0 * math.pi * n * points[k, axis] / size[axis]
                turns[axis, n + most] = complex(math.cos(angle), math.sin(angle))
        value, dx, dy, dz = 0.0, 0.0, 0.0, 0.0
        for w in range(len(waves)):
            a, b, c = waves[w, 0], waves[w, 1], waves[w, 2]
            term = amplitudes[w] * turns[0, a + most] * turns[1, b + most] * turns[2, c + most]
            value += 2.0 * term.real
            dx -= 2.0 * a * term.imag
            dy -= 2.0 * b * term.imag
            dz -= 2.0 * c * term.imag
        out[k, 0] += value
        out[k, 1] += 2.0 * math.pi / size[0] * dx
        out[k, 2] += 2.0 * math.pi / size[1] * dy
        out[k, 3] += 2.0 * math.pi / size[2] * dz
