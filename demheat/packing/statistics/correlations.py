"""Pair correlations of a packing: g(r) of the centres and the two-point probability S2(r) of the sphere phase."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

import demheat.runtime.threads  # noqa: F401 (chooses the threading layer)
from demheat.packing.base import Packing
from demheat.packing.cells_kernels import Reach
from demheat.packing.gate import check_packing
from demheat.packing.neighbours import build_grid, wrapped
from demheat.packing.statistics import correlations_kernels as kernels
from demheat.packing.statistics.regions import core_volume, inscribed_box, spheres_in_box
from demheat.packing.walls import check_margin, wall_distances
from demheat.runtime.blocks import blocks
from demheat.runtime.progress import stage
from demheat.scene.inputs import finite, flag, reals, whole

# The axes and the four body diagonals of a cube: the directions farthest from them.
ALONG = ((1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1), (-1, 1, 1), (1, -1, 1), (1, 1, -1))

# Lines summed at once, some tenths of a second. Fixed, so that sums are.
BLOCK = 4096
# Part of the seed of the lines: random points drawn with the same seed must not be where lines start.
STREAM = 2


class RadialDistribution(NamedTuple):
    """Density of centres around a centre, over the mean density."""

    # (bins,) float array: Middles of the bins: distance over mean diameter, or over the sum of the two radii where
    # `scaled`
    r: np.ndarray
    g: np.ndarray  # (bins,) float array: 1 without correlation
    # (bins,) float array: Poisson standard deviation, from the number of pairs counted; 0 where there are none. That of
    # the density itself (1 / sqrt(origins) with walls) is not in it
    error: np.ndarray
    origins: int  # Centres that were looked from
    density: float  # 1/m^3: What g was divided by


class TwoPoint(NamedTuple):
    """Probability S2(r) that both ends of a segment lie in spheres, by direction. Lengths in mean diameters."""

    r: np.ndarray  # (m,) float array: Distance over mean diameter, from 0
    along: np.ndarray  # (k, 3) float array: Unit vectors
    s2: np.ndarray  # (k, m) float array
    # (k, m) float array: Standard errors of s2, from the scatter of the lines. Neighbouring distances share their lines
    error: np.ndarray
    # slope, slope_error: (k,) float arrays: dS2/dr at r = 0, from the ends of chords counted, and its standard error
    slope: np.ndarray
    slope_error: np.ndarray
    phi: float  # Exact packing fraction of the region sampled (overlaps twice): what S2(0) is without overlaps
    # -surface/4 per volume, from the exact surface of the spheres in that region: what the slope is in every direction
    # without overlaps; on average over directions this holds for any shapes (Debye, Anderson and Brumberger, J. Appl.
    # Phys. 28 (1957) 679)
    exact_slope: float


def radial_distribution(
    packing: Packing, *, r_max: float = 4.0, bins: int = 200, scaled: bool = False
) -> RadialDistribution:
    """Radial distribution function g(r) of the centres.

    In a periodic packing all centres are origins and the density is (n - 1)/V, so that g of random points is 1 at any
    number. With walls only the centres farther than the longest distance counted from all walls are origins, so that
    every shell is whole, and the density is theirs: origins over the volume where origins can lie.
    """
    check_packing(packing)
    _check_count("bins", bins, 1)
    flag("scaled", scaled)
    if packing.number < 2:
        raise ValueError(f"packing of {packing.number} particle: must have at least 2")
    radii = packing.radii
    unit = 2 * float(np.max(radii) if scaled else np.mean(radii))
    _check_r_max(packing, r_max, unit)
    is_origin = wall_distances(packing) > r_max * unit
    origins = np.flatnonzero(is_origin)
    if not len(origins):
        raise ValueError(f"r_max = {r_max!r}: no centre lies that far, {r_max * unit:.6g} m, from all walls")
    walled = not np.all(packing.periodic)
    density = len(origins) / core_volume(packing, r_max * unit) if walled else (len(radii) - 1) / packing.volume
    points = wrapped(np.column_stack((packing.centers, radii)), packing.size, packing.periodic)
    reach = Reach(float(r_max), 0.0) if scaled else Reach(0.0, r_max * unit)
    grid = build_grid(points, packing.size, packing.periodic, reach)
    counts, total = np.empty((kernels.TASKS, 2, bins), np.int64), np.zeros((2, bins), np.int64)
    for first, last in blocks(len(origins), kernels.TASKS):
        kernels.pair_counts(points, grid, origins[first:last], is_origin, reach, counts)
        total += counts.sum(axis=0)
    single, double = total
    edges = np.linspace(0.0, r_max, bins + 1)
    cubes = _mean_cubed_sums(radii)[origins].sum() if scaled else len(origins) * unit**3
    expected = density * cubes * 4 / 3 * np.pi * np.diff(edges**3)
    # Pairs of origins are met twice: independent counts are half of them, each of weight 2.
    error = np.sqrt(single + 2 * double) / expected
    return RadialDistribution((edges[1:] + edges[:-1]) / 2, (single + double) / expected, error, len(origins), density)


def two_point(
    packing: Packing,
    *,
    along: Sequence[Sequence[float]] = ALONG,
    r_max: float = 4.0,
    points: int = 101,
    lines: int = 20_000,
    margin: float = 0.0,
    seed: int = 0,
) -> TwoPoint:
    """Two-point probability S2(r) of the union of the spheres, along given directions.

    Random lines are cut exactly by the spheres; along each, the overlap of the spans inside with themselves shifted by
    r is exact, so the mean over lines has no bias at any r and a known standard error. No voxels: those round the
    start slope away. A line is twice r_max long and its first half holds the origins, so all r have the same weight.

    Overlapping spheres count once (union of the chords): S2(0) is then less than `phi` and the slope less steep than
    `exact_slope`. For the voids S2 is 1 - 2 S2(0) + S2(r).
    """
    check_packing(packing)
    mean = 2 * float(np.mean(packing.radii))
    depth = check_margin(packing, margin)
    along = _unit_directions(along)
    _check_r_max(packing, r_max, mean)
    for name, value, least in (("points", points, 2), ("lines", lines, 2), ("seed", seed, 0)):
        _check_count(name, value, least)
    low, high = inscribed_box(packing, depth)
    _check_lines(packing, along, high - low, r_max, mean)
    lags = np.linspace(0.0, r_max * mean, points)
    values, errors = _line_means(packing, along, lags, (low, high), lines, np.random.default_rng((seed, STREAM)))
    bounds = np.where(packing.periodic, [[-np.inf], [np.inf]], [low, high])
    volumes, surfaces = spheres_in_box(packing.centers, packing.radii, *bounds)
    volume = float(np.prod(high - low))
    return TwoPoint(
        r=lags / mean,
        along=along,
        s2=values[:, :-1],
        error=errors[:, :-1],
        slope=values[:, -1] * mean,
        slope_error=errors[:, -1] * mean,
        phi=math.fsum(volumes) / volume,
        exact_slope=-math.fsum(surfaces) / 4 / volume * mean,
    )


def _line_means(packing, along, lags, bounds, lines, rng):
    """Means over random lines, and their standard errors, of S2 at each lag and (last column) of its start slope."""
    cloud = wrapped(np.column_stack((packing.centers, packing.radii)), packing.size, packing.periodic)
    length = 2 * lags[-1]
    # One search per mean diameter.
    steps = math.ceil(length / (2 * np.mean(packing.radii)))
    grid = build_grid(cloud, packing.size, packing.periodic, Reach(1.0, length / steps / 2))
    values, errors = np.empty((2, len(along), len(lags) + 1))
    with stage("correlations") as done:
        for k, direction in enumerate(along):
            # Both ends keep inside the walls.
            span = np.where(packing.periodic, 0.0, length * direction)
            first, last = bounds[0] - np.minimum(span, 0.0), bounds[1] - np.maximum(span, 0.0)
            starts = first + rng.random((lines, 3)) * (last - first)
            sums, total = np.empty((kernels.TASKS, 2, len(lags) + 1)), np.zeros((2, len(lags) + 1))
            for begin in range(0, lines, BLOCK):
                part = kernels.Lines(starts[begin : begin + BLOCK], direction, lags, steps)
                kernels.line_correlations(cloud, grid, part, sums)
                total += sums.sum(axis=0)
                done((k + begin / lines) / len(along))
            values[k], square = total / lines
            errors[k] = np.sqrt(np.maximum(square - values[k] ** 2, 0.0) / (lines - 1))
    return values, errors


def _mean_cubed_sums(radii):
    """Mean of (r_i + r_j)^3 over all j but i, (n,) float array, m^3."""
    one, two, three = (np.sum(radii**p) for p in (1, 2, 3))
    n = len(radii)
    return (n * radii**3 + 3 * radii**2 * one + 3 * radii * two + three - 8 * radii**3) / (n - 1)


def _unit_directions(along):
    """Cast directions to unit vectors, (k, 3) float array."""
    vectors = reals("along", along, "a (k, 3) list of finite directions")
    if vectors.ndim != 2 or vectors.shape[1] != 3 or not len(vectors) or not np.all(np.isfinite(vectors)):
        raise ValueError(f"along = {along!r}: must be a (k, 3) list of finite directions")
    lengths = np.linalg.norm(vectors, axis=1)
    if np.any(lengths == 0):
        raise ValueError(f"along = {along!r}: must have no zero vectors")
    return vectors / lengths[:, None]


def _check_count(name, value, least):
    whole(name, value, f"an integer >= {least}", lambda v: v >= least)


def _check_r_max(packing, r_max, unit):
    """Raise ValueError unless r_max is > 0 and, in metres, at most half of each period."""
    largest = float(np.min(np.where(packing.periodic, packing.size, np.inf))) / 2 / unit
    limit = f" and <= {largest:.6g}, half of the shortest period" if math.isfinite(largest) else ""
    finite("r_max", r_max, f"a finite number > 0{limit}", lambda v: 0 < v <= largest)


def _check_lines(packing, along, sides, r_max, mean):
    """Raise ValueError unless lines of twice r_max fit between walls and spheres meet only their nearest images."""
    short = float(np.min(np.where(packing.periodic, packing.size, np.inf)))
    if short < 4 * packing.radii.max():
        raise ValueError(
            f"packing.size = {packing.size.tolist()}: periods must be >= twice the largest diameter = "
            f"{4 * packing.radii.max():.6g} m"
        )
    with np.errstate(divide="ignore"):
        largest = float(np.min(np.where(packing.periodic, np.inf, sides / np.abs(along)))) / 2 / mean
    if r_max > largest:
        raise ValueError(f"r_max = {r_max!r}: must be <= {largest:.6g}, half of the longest line between the walls")
