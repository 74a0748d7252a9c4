"""What cells of a regular grid make at each other without their near neighbours, and its Fourier transform.

The sums are Ewald's of `sums`. A near image adds -P(L+1/2, eta r^2) I_L^M instead of the complement Q: taking I_L^M
off afterwards would leave nothing but rounding at high degrees.
"""

from itertools import product

import numpy as np
from scipy import fft
from scipy.special import gammainc, gammaincc, gammaln

from references.multipole.sums import add_screened, add_waves, entries, images, splitting, wave_table

# Offsets handled at a time, so that intermediate arrays stay in the cache.
CHUNK = 128


def far_sums(shape, edge, near, degree):
    """Sums of I_L^M(X + R) over all lattice vectors R but those for which X + R is near."""
    size, half = shape * edge, shape // 2 + 1
    cells = np.stack(np.meshgrid(*[np.arange(n) for n in half], indexing="ij"), axis=-1).reshape(-1, 3)
    cut = splitting(size, float(np.linalg.norm(edge)), degree)
    vectors, table = wave_table(degree, size, cut)
    result = np.zeros((len(cells), (degree + 1) * (degree + 2) // 2), dtype=complex)
    for low in range(0, len(cells), CHUNK):
        part = slice(low, low + CHUNK)
        apart, square = images(cells[part] * edge, size, cut.reach)
        steps = np.rint(apart / edge).astype(np.int64)
        kept = (square <= cut.reach**2) & np.any(np.abs(steps) > np.abs(near).max(axis=0), axis=2)
        owner, image = np.nonzero(kept)
        add_screened(result[part], owner, apart[owner, image], degree, lambda n, x: gammaincc(n + 0.5, cut.eta * x))
        add_waves(result[part], cells[part] * edge @ vectors.T, table)
    _take_off(result, near[np.any(near != 0, axis=1)], shape, edge, cut.eta)
    result[:, 0] = 0.0
    return result


def _take_off(result, near, shape, edge, eta):
    wrapped, half = near % shape, shape // 2 + 1
    here = np.all(wrapped < half, axis=1)
    owner = np.ravel_multi_index(tuple(wrapped[here].T), tuple(half))
    degree = int(np.sqrt(2 * result.shape[1])) - 1
    add_screened(result, owner, near[here] * edge, degree, lambda n, x: -gammainc(n + 0.5, eta * x))


def transformed(sums, shape):
    """Fourier transforms over the grid, times i^L: real and imaginary parts of the sums have real ones."""
    half = shape // 2 + 1
    n, m = entries(int(np.sqrt(2 * sums.shape[1])) - 1)
    root = np.exp(0.5 * (gammaln(n - m + 1) + gammaln(n + m + 1)))
    octant = sums.T.reshape(len(n), *half)
    result = np.empty((2, len(n), *half))
    for entry, (degree, order) in enumerate(zip(n, m, strict=True)):
        for part, values in enumerate((octant[entry].real, octant[entry].imag)):
            waves = fft.rfftn(_mirrored(values, shape, mirror_parities(degree, order)[part]))
            result[part, entry] = (1j**degree * waves[tuple(slice(k) for k in half)]).real * root[entry]
    return np.ascontiguousarray(np.moveaxis(result.reshape(2, len(n), -1), 1, 2))


def mirror_parities(degree, order):
    """Signs of the real and of the imaginary part of an entry mirrored along x, y and z."""
    x, z = (-1) ** np.asarray(order), (-1) ** (np.asarray(degree) + order)
    one = np.ones_like(x)
    return np.array([[x, one, z], [-x, -one, z]])


def _mirrored(octant, shape, signs):
    """All offsets from those of one octant."""
    for axis, count in enumerate(shape):
        rest = np.flip(np.take(octant, np.arange(1, count - count // 2), axis=axis), axis=axis)
        octant = np.concatenate([octant, signs[axis] * rest], axis=axis)
    return octant


def reflections():
    """The four waves of half a space, three axes' signs each, that share a row of `transformed`."""
    return np.array([(x, y, 1) for x, y in product((1, -1), repeat=2)])
