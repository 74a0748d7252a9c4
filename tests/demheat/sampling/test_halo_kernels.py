"""Only here: kernels of halos beside a look at every sample."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import demheat.runtime.threads  # noqa: F401 (chooses the threading layer)
from demheat.network.bins import bin_points
from demheat.sampling import halo_kernels as kernels

pytestmark = pytest.mark.twin

SIZE, DIMS = np.array([1.0, 1.3, 0.8]), np.array([4, 5, 3])


def filed(n, periodic, phases):
    """Random samples in cells; centre, phase, volume and values of each besides."""
    rng = np.random.default_rng(0)
    points, volumes, values = rng.random((n, 3)) * SIZE, rng.uniform(0.5, 2.0, n), rng.standard_normal((n, 3))
    phase = rng.integers(0, 3, n).astype(float) if phases else np.zeros(n)
    start, order = bin_points(points, SIZE, DIMS)
    slots = np.column_stack([points, phase, volumes, volumes[:, None] * values])[order].T.copy()
    totals = kernels.cell_totals(start, slots)
    cells = kernels.Cells(DIMS, SIZE / DIMS, np.where(periodic, SIZE, 0.0), start, slots, totals, phases)
    return cells, points, phase, volumes, values


def test_totals_of_cells():
    cells, points, _, volumes, values = filed(150, True, False)
    place = np.floor(points / SIZE * DIMS).astype(int)
    for c, at in enumerate(np.ndindex(*DIMS)):
        here = np.all(place == at, axis=1)
        right = [volumes[here].sum(), *(volumes[here] @ values[here])]
        assert_allclose(cells.totals[c], right, rtol=0, atol=1e-14)  # rounding of sums of some few numbers


@pytest.mark.parametrize("phases", [False, True])
@pytest.mark.parametrize("radius", [0.12, 0.39])
@pytest.mark.parametrize("periodic", [(True, True, True), (False, True, False)])
def test_means_over_balls(periodic, radius, phases):
    cells, points, phase, volumes, values = filed(150, periodic, phases)
    rng = np.random.default_rng(1)
    at = rng.random((20, 3)) * SIZE
    begin, order = bin_points(at, SIZE, DIMS)
    at, wanted = at[order], rng.integers(0, 3, 20).astype(float) if phases else np.zeros(20)
    out, right = np.empty((20, 3)), np.full((20, 3), np.nan)
    kernels.ball_means(at, begin, wanted, radius, cells, out)
    for i in range(20):
        away = points - at[i]
        away -= np.where(periodic, SIZE * np.round(away / SIZE), 0.0)
        near = (np.linalg.norm(away, axis=1) <= radius) & (phase == wanted[i])
        if near.any():
            right[i] = volumes[near] @ values[near] / volumes[near].sum()
    # Rounding of sums of up to 150 numbers of order one.
    assert_allclose(out, right, rtol=0, atol=1e-13)
    assert np.isnan(right).any() == (radius < 0.2) and np.isfinite(right).any()
