"""Milton's third-order parameter zeta_2 of a two-phase periodic cell itself, by the periodic Green projector.

The third order of the weak-contrast expansion (Torquato, J. Appl. Phys. 58 (1985) 3790; Milton, Phys. Rev. Lett. 46
(1981) 542) needs one application of the projector on gradients, Gamma = k k^T/k^2: with chi the indicator of the
inclusions, a_3 = <chi |Gamma chi|^2>/3 = phi1 phi2 (phi1 + 2 zeta_2)/9, |.| the Frobenius norm, Gamma(k = 0) = 0.

Voxels that an interface cuts hold their fraction v of inclusion; inside them chi - v varies across the interface, of
normal n, which adds (1 - v) n n to Gamma chi on the inclusions' side: summed over them, 2 v (1 - v) n.(Gamma chi) n +
v (1 - v)^2. Frequencies are those of the rotated scheme of Willot, C. R. Mecanique 343 (2015) 232, tan(pi k/N).
"""

import math
import warnings
from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from typing import NamedTuple

import numpy as np

from demheat.runtime.limits import check_memory
from demheat.scene import Material, Scene, check_scene
from demheat.scene.inputs import flag
from references.fft.transforms import fourier
from references.threads import thread_count
from references.voxels.paint import Voxels, grid_shape, voxelise

# Errors found on cubic arrays (spheres 5 to 60 voxels across, three places each) and on random cells go as a h + c h^3
# with the voxel's size h: two grids alone, or terms h and h^2 through three, leave three times as much and more.
POWERS = (0, 1, 3)
# Coarsest grid of an extrapolation.
FEWEST = 8
# Least bytes that a voxel takes.
BYTES = 30
# Of zeta_2, amplified from that of sums over the voxels.
ROUNDING = 1e-12
# The tangent at the Nyquist frequency: infinite, as far as its square can be told from 1 in floating point.
NYQUIST = 1e9


class Tangents(NamedTuple):
    """Frequencies of the rotated scheme along an axis, tan(pi k/N) over the spacing."""

    # (n,) float array, 1/m: 0 at the Nyquist frequency, so that no product of two axes has a sign there
    frequency: np.ndarray
    square: np.ndarray  # (n,) float array, 1/m2: Huge at the Nyquist frequency


class Zeta2(NamedTuple):
    """The parameter and how it was found."""

    value: float  # zeta_2 of the inclusions, extrapolated to voxels of no size if that was asked
    fraction: float  # Volume fraction of the inclusions on the finest grid
    # `raw`, the value before it is held within 0 to 1; `voxels` (shapes, finest last), `values` and `fractions` on
    # each; `error`, None from one grid, else the part that the term in h^3 had in the extrapolation (true errors found:
    # 0.03 to 1.4 times that); `amplification`, the relative error of zeta_2 over that of a_3
    stats: dict


def zeta2(
    scene: Scene, *, voxels: int | Sequence[int] = 128, extrapolate: bool = True, threads: int | None = 2
) -> Zeta2:
    """Find zeta_2 of a periodic cell; of an anisotropic one, that of the mean conductivity over the three axes.

    Parameters
    ----------
    scene : Scene
        A periodic cell of two conductivities; the second phase is all that does not conduct as the matrix does. Only
        its geometry counts.
    voxels : int or (3,) sequence of int
        Of the finest grid, along the longest side or along each; some 35 bytes for each voxel.
    extrapolate : bool
        Take grids of a quarter, half and all of the voxels along each side, and extrapolate to voxels of no size.
        Random spheres 20 voxels across on the finest grid then leave some 2 %, 40 across some 0.2 %.
    threads : int or None
        None takes one per processor.

    Returns
    -------
    Zeta2

    Warns
    -----
    UserWarning
        If so few voxels leave a value outside 0 to 1, which is then held there; `stats["raw"]` keeps it.

    Raises
    ------
    ValueError
        If the scene does not have two conductivities, both with some volume, or there are too few voxels.
    NotImplementedError
        For a box with walls.

    Examples
    --------
    >>> from demheat import gallery
    >>> from references import zeta
    >>> found = zeta.zeta2(gallery.sphere_in_cube(5.0, periodic=True), voxels=32)
    >>> print(f"{found.value:.3f}")  # exactly 0.00200341
    0.002
    """
    check_scene(scene)
    flag("extrapolate", extrapolate)
    threads = thread_count(threads)
    cell = _two_phases(scene)
    shapes = _shapes(scene, voxels, extrapolate)
    check_memory("voxels", voxels, BYTES * math.prod(shapes[-1]), power=3)
    found = [_on_grid(voxelise(cell, shape, laminate=True), threads) for shape in shapes]
    values, fractions = (list(column) for column in zip(*found, strict=True))
    value, error = _extrapolated(values, shapes) if extrapolate else (values[-1], None)
    stats = {"voxels": shapes, "values": values, "fractions": fractions, "error": error, "raw": value}
    value = _held(value, shapes[-1])
    stats["amplification"] = (1 - fractions[-1] + 2 * value) / (2 * value) if value > 0 else math.inf
    return Zeta2(value, fractions[-1], stats)


def _held(raw, shape):
    """The value within 0 to 1, with a warning if it had to be moved by more than rounding."""
    value = min(max(raw, 0.0), 1.0)
    if abs(raw - value) > ROUNDING:
        warnings.warn(f"zeta_2 = {raw:.3g} on {shape} voxels is held at {value:g}: use more voxels", stacklevel=3)
    return value


def _two_phases(scene):
    """The scene with the indicator of its second phase as conductivity."""
    scene.require("zeta_2 by the periodic Green projector is that of a periodic cell (Scene.gradient)", walls="none")
    matrix = scene.matrix.conductivity
    others = sorted({inclusion.material.conductivity for inclusion in scene.inclusions} - {matrix})
    if len(others) != 1:
        raise ValueError(
            f"Scene.inclusions conduct {others} W/(m K) in a matrix of {matrix}: must be one other conductivity, as "
            "zeta_2 is that of two phases"
        )
    painted = [replace(i, material=Material(float(i.material.conductivity != matrix))) for i in scene.inclusions]
    return replace(scene, matrix=Material(0.0), inclusions=painted)


def _shapes(scene, voxels, extrapolate):
    """Shapes of the grids, finest last."""
    finest = grid_shape(scene, voxels)
    if not extrapolate:
        return [finest]
    shapes = [tuple(max(1, round(n / 2**level)) for n in finest) for level in reversed(range(len(POWERS)))]
    if min(shapes[0]) < FEWEST:
        least = FEWEST * 2 ** (len(POWERS) - 1)
        raise ValueError(f"voxels = {voxels!r}: a grid of {finest}; must have >= {least} each way to extrapolate")
    return shapes


def _extrapolated(values, shapes):
    """Value for voxels of no size, and its difference to that of first order from the two finest grids."""
    sizes = np.array([np.prod(shape, dtype=float) ** (-1 / 3) for shape in shapes])
    sizes /= sizes[-1]
    limit = np.linalg.solve(sizes[:, None] ** np.array(POWERS), values)[0]
    first = np.linalg.solve(sizes[1:, None] ** np.array(POWERS[:2]), values[1:])[0]
    return float(limit), float(abs(limit - first))


def _on_grid(grid: Voxels, threads):
    """zeta_2 and the inclusions' fraction on one grid, whose conductivity is the inclusions' indicator."""
    v = grid.conductivity[grid.phase]
    # A laminate of 1 and 0 conducts v (I - n n).
    v.ravel()[grid.cut] = grid.tensor[:, :3].sum(axis=1) / 2
    f = float(v.mean())
    if not 0 < f < 1:
        raise ValueError(f"Scene.inclusions fill {f} of the cell: both phases must have some volume")
    third = (_whole(v, grid, threads) + _within(v.ravel()[grid.cut])) / (3 * v.size)
    return (9 * third / (f * (1 - f)) - (1 - f)) / 2, f


def _within(v):
    """Sum of v (1 - v)^2 over the cut voxels."""
    return float(np.sum(v * (1 - v) ** 2))


def _whole(v, grid, threads):
    """Sum of v |Gamma v|^2 + 2 v (1 - v) n.(Gamma v) n over the voxels."""
    work = fourier(1, v.shape, np.float64, threads)
    values, modes = work.real[0, ..., : v.shape[2]], work.modes[0]
    values[:] = v
    work.forward()
    spectrum = modes * work.scale
    x, y, z = axes = _axes(v.shape, grid.spacing)
    square = x.square + y.square + z.square
    square[0, 0, 0] = 1.0  # k = 0, where all products of frequencies are 0.
    spectrum /= square
    cut = np.unravel_index(grid.cut, v.shape)
    outside = 2 * (1 - v[cut])
    total = 0.0
    for place, (i, j) in enumerate([(0, 0), (1, 1), (2, 2), *reversed(list(combinations(range(3), 2)))]):
        product = axes[i].square if i == j else axes[i].frequency * axes[j].frequency
        np.multiply(spectrum, product, out=modes)
        work.backward()
        pair = 1 if i == j else 2
        total += pair * np.einsum("ijk,ijk,ijk->", v, values, values)
        # v n n = v I - K of the laminate.
        normal = (v[cut] if i == j else 0.0) - grid.tensor[:, place]
        total += pair * np.sum(outside * normal * values[cut])
    return float(total)


def _axes(shape, spacing):
    """Tangents of each axis, shaped to be multiplied with one another; half of them along the last axis."""
    found = []
    for axis, (n, h) in enumerate(zip(shape, spacing, strict=True)):
        kept = n // 2 + 1 if axis == 2 else n
        form = [-1 if axis == other else 1 for other in range(3)]
        found.append(Tangents(*(values[:kept].reshape(form) for values in tangents(n, h))))
    return found


def tangents(n: int, spacing: float) -> Tangents:
    """Frequencies of the rotated scheme along an axis, as `numpy.fft.fftfreq` orders them."""
    k = np.fft.fftfreq(n)
    nyquist = k == -0.5
    t = np.tan(np.pi * np.where(nyquist, 0.0, k))
    return Tangents(t / spacing, np.where(nyquist, NYQUIST**2, t * t) / spacing**2)
