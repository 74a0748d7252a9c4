"""Only here: pairs that kernels count twice or not, chords that they join wrongly, beside brute force."""

from itertools import product

import numpy as np
import pytest
from crystals import distances, random_packing
from numpy.testing import assert_allclose, assert_array_equal

from demheat.packing.base import make_packing
from demheat.packing.cells_kernels import Reach
from demheat.packing.neighbours import build_grid
from demheat.packing.statistics import correlations_kernels as kernels

pytestmark = pytest.mark.twin


@pytest.mark.parametrize("scaled", [False, True])
@pytest.mark.parametrize(
    ("periodic", "number", "longest"),
    [(True, 50, 0.3), ((True, False, True), 50, 0.3), (True, 700, 0.49)],
)
def test_pair_counts(scaled, periodic, number, longest):
    # In the last case 340 neighbours: more than a buffer first holds.
    packing, rng, bins = random_packing(3, number, periodic=periodic), np.random.default_rng(0), 12
    points = np.column_stack((packing.centers, packing.radii))
    reach = Reach(longest / 0.15, 0.0) if scaled else Reach(0.0, longest)  # radii of at most 0.075
    grid = build_grid(points, packing.size, packing.periodic, reach)
    origins = np.sort(rng.permutation(number)[: max(10, number // 40)])
    is_origin = np.isin(np.arange(number), origins)
    counts = np.empty((kernels.TASKS, 2, bins), dtype=np.int64)
    kernels.pair_counts(points, grid, origins, is_origin, reach, counts)
    unit = reach.skin + reach.scale * (packing.radii + packing.radii[:, None])
    ratio = (distances(packing) / unit)[origins]
    for kind, partners in ((kernels.SINGLE, ~is_origin), (kernels.DOUBLE, is_origin)):
        assert_array_equal(counts[:, kind].sum(axis=0), np.histogram(ratio[:, partners], bins, (0, 1))[0])


def union(packing, start, along, length):
    """Spans of the union of chords, by brute force over periodic images: the slow twin."""
    spans = []
    for shift in product(*(range(-2, 3) if p else (0,) for p in packing.periodic)):
        offsets = packing.centers + np.array(shift) * packing.size - start
        middle = offsets @ along
        half2 = packing.radii**2 - (offsets**2).sum(axis=1) + middle**2
        for m, h in zip(middle[half2 > 0], np.sqrt(half2[half2 > 0]), strict=True):
            if m + h > 0 and m - h < length:
                spans.append((max(m - h, 0.0), min(m + h, length)))
    joined = []
    for low, high in sorted(spans):
        if joined and low <= joined[-1][1]:
            joined[-1][1] = max(high, joined[-1][1])
        else:
            joined.append([low, high])
    return joined


def check_line(packing, start, along, steps):
    """Compare one line of length .9 with its slow twin; returns the number of spans."""
    points, lags = np.column_stack((packing.centers, packing.radii)), np.linspace(0.0, 0.45, 10)
    grid = build_grid(points, packing.size, packing.periodic, Reach(1.0, 0.9 / steps / 2))
    sums = np.empty((kernels.TASKS, 2, 11))
    kernels.line_correlations(points, grid, kernels.Lines(start[None], along, lags, steps), sums)
    spans = union(packing, start, along, 0.9)
    shared = [sum(max(0.0, min(b, d - r, 0.45) - max(a, c - r)) for a, b in spans for c, d in spans) for r in lags]
    ends = sum(b < 0.45 for _, b in spans)
    # Rounding of lengths, 1e-16, over chords that may be short.
    assert_allclose(sums[:, 0].sum(axis=0), [*np.array(shared) / 0.45, -ends / 0.45], rtol=1e-11, atol=1e-12)
    assert_allclose(sums[:, 1].sum(axis=0), sums[:, 0].sum(axis=0) ** 2, rtol=1e-12)
    return len(spans)


@pytest.mark.parametrize("periodic", [True, False, (False, True, True)])
def test_line_correlations(periodic):
    packing = random_packing(5, 150, periodic=periodic, radius=0.1)  # many overlaps
    rng, cut = np.random.default_rng(6), 0
    for _ in range(20):
        along = rng.standard_normal(3)
        cut += check_line(packing, rng.random(3), along / np.linalg.norm(along), 7)
    assert cut > 20


def test_a_line_may_run_into_a_crowd():
    """One sphere first, then more at once than the buffers of a line hold: they grow and keep the first."""
    crowd = np.array([0.25, 0.45, 0.45]) + [0.2, 0.1, 0.1] * np.random.default_rng(0).random((1000, 3))
    packing = make_packing(np.vstack(([[0.1, 0.5, 0.5]], crowd)), np.full(1001, 0.006), (1, 1, 1), True, {})
    assert check_line(packing, np.array([0.0, 0.5, 0.5]), np.array([1.0, 0.0, 0.0]), 5) > 3
