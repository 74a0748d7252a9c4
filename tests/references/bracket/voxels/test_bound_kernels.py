"""Kernels of the energies on voxels beside the sums that they stand for, and of the balance beside its definition."""

from types import SimpleNamespace

import numpy as np
import pytest

from references.bracket.voxels import fluxes, temperatures
from references.bracket.voxels import voxel_kernels as kernels
from references.bracket.voxels.voxel_kernels import Cells
from references.threads import Team

SHAPE, SPACING = (4, 3, 5), np.array([0.3, 0.7, 0.4])
# Means of products of linear shapes over an edge.
PAIRS = np.array([1 / 3, 1 / 6, 1 / 3])
# Sums of a few dozen products of numbers of order 1.
ROUNDING = 1e-13


def some_cells(seed, form):
    """Half of the voxels with a table of their own, symmetric matrices of no special kind."""
    rng = np.random.default_rng(seed)
    row = np.full(SHAPE, -1, np.int32)
    own = rng.permutation(row.size)[: row.size // 2]
    row.flat[own] = np.arange(len(own))
    return Cells(rng.uniform(0.1, 2.0, SHAPE), row, rng.uniform(0.1, 1.0, (len(own), *form)))


def at(values, place, step=(0, 0, 0)):
    return values[tuple((p + s) % n for p, s, n in zip(place, step, SHAPE, strict=True))]


def conduction_by_hand(theta, cells, gradient):
    """Energy, and half its slope, voxel by voxel and edge by edge."""
    energy, work = 0.0, np.zeros(SHAPE)
    corners = list(np.ndindex(2, 2))
    for place in np.ndindex(SHAPE):
        for axis in range(3):
            others = [a for a in range(3) if a != axis]
            row = cells.row[place]
            table = cells.scalar[place] * np.outer(PAIRS, PAIRS) if row < 0 else cells.table[row, axis]
            ends = []
            for corner in corners:
                low = np.zeros(3, int)
                low[others] = corner
                ends.append((low, low + np.eye(3, dtype=int)[axis]))
            slope = [(at(theta, place, b) - at(theta, place, a)) / SPACING[axis] + gradient[axis] for a, b in ends]
            for m, one in enumerate(corners):
                for n, other in enumerate(corners):
                    part = table[one[0] + other[0], one[1] + other[1]] * slope[n]
                    energy += part * slope[m]
                    for end, sign in zip(ends[m], (-1, 1), strict=True):
                        work[tuple((p + s) % c for p, s, c in zip(place, end, SHAPE, strict=True))] += (
                            sign * part / SPACING[axis]
                        )
    return energy, work


@pytest.mark.twin
@pytest.mark.parametrize("threads", [1, 3])
def test_conduct(threads):
    cells, gradient = some_cells(0, (3, 3, 3)), np.array([1.0, -0.5, 2.0])
    theta = np.random.default_rng(1).normal(size=SHAPE)
    work, energies = np.empty(SHAPE), np.empty(SHAPE[0])
    with Team(threads) as team:
        team.run(kernels.conduct, SHAPE[0], theta, work, cells, np.array([1 / SPACING, gradient]), energies)
    energy, wanted = conduction_by_hand(theta, cells, gradient)
    np.testing.assert_allclose(work, wanted, rtol=0, atol=ROUNDING * np.abs(wanted).max())
    assert energies.sum() == pytest.approx(energy, rel=ROUNDING)


@pytest.mark.twin
@pytest.mark.parametrize("threads", [1, 3])
def test_resist(threads):
    cells = some_cells(2, (3, 3))
    flux = np.random.default_rng(3).normal(size=(3, *SHAPE))
    work, wanted = np.empty(flux.shape), np.zeros(flux.shape)
    with Team(threads) as team:
        team.run(kernels.resist, SHAPE[0], flux, work, cells)
    for place in np.ndindex(SHAPE):
        for axis in range(3):
            row = cells.row[place]
            first, both, last = cells.scalar[place] * PAIRS if row < 0 else cells.table[row, axis]
            step = np.eye(3, dtype=int)[axis]
            far = tuple((p + s) % n for p, s, n in zip(place, step, SHAPE, strict=True))
            low, high = flux[axis][place], flux[axis][far]
            wanted[axis][place] += first * low + both * high
            wanted[axis][far] += both * low + last * high
    np.testing.assert_allclose(work, wanted, rtol=0, atol=ROUNDING * np.abs(wanted).max())


def divergence(flux):
    return sum((np.roll(part, -1, axis=a) - part) / SPACING[a] for a, part in enumerate(flux))


@pytest.mark.twin
def test_balance():
    """By the definition: balanced, and what is left of the slope is a gradient, orthogonal to all balanced fluxes."""
    rng = np.random.default_rng(4)
    gradient = np.array([2.0, -1.0, 2.0]) / 3
    inverse, balanced = fluxes._balancing(SHAPE, SPACING, gradient, threads=1)
    slope, other = rng.normal(size=(2, 3, *SHAPE))
    found, beside = inverse(slope), inverse(other)
    for each in (found, balanced(slope)):
        np.testing.assert_allclose(divergence(each), 0, atol=ROUNDING * np.abs(slope).max() / SPACING.min())
    assert found.mean(axis=(1, 2, 3)) @ gradient == pytest.approx(0, abs=ROUNDING)
    np.testing.assert_allclose(balanced(slope).mean(axis=(1, 2, 3)), slope.mean(axis=(1, 2, 3)), rtol=0, atol=ROUNDING)
    uniform = Cells(np.ones(SHAPE), np.full(SHAPE, -1, np.int32), np.empty((0, 3, 3)))
    work = np.empty(slope.shape)
    kernels.resist(found, work, uniform, 0, SHAPE[0])
    assert np.sum((work - slope) * beside) == pytest.approx(0, abs=ROUNDING * slope.size)
    # What is balanced stays.
    np.testing.assert_allclose(balanced(found), found, rtol=0, atol=ROUNDING)


def test_the_temperatures_inverse_is_that_of_a_homogeneous_cell():
    theta = np.random.default_rng(5).normal(size=SHAPE)
    theta -= theta.mean()
    uniform = Cells(np.ones(SHAPE), np.full(SHAPE, -1, np.int32), np.empty((0, 3, 3, 3)))
    work = np.empty(SHAPE)
    kernels.conduct(theta, work, uniform, np.array([1 / SPACING, np.zeros(3)]), np.empty(SHAPE[0]), 0, SHAPE[0])
    inverse = temperatures._homogeneous(SHAPE, SPACING, threads=1)
    np.testing.assert_allclose(inverse(work), theta, rtol=0, atol=ROUNDING * 10)


def test_what_is_left_unbalanced_counts():
    """A flux of no mean that balances the rest of another has at most the root mean square that is told."""
    flux = np.random.default_rng(6).normal(size=(3, *SHAPE))
    _, balanced = fluxes._balancing(SHAPE, SPACING, np.zeros(3), threads=1)
    missing = flux - balanced(flux)
    told, least = fluxes._unbalanced(flux, SPACING), np.sqrt(np.mean(np.sum(missing**2, axis=0)))
    assert least < told
    # The bound is reached by the longest wave of a long cell.
    wave = np.zeros((3, 16, 1, 1))
    wave[0, :, 0, 0] = np.sin(2 * np.pi * np.arange(16) / 16)
    assert fluxes._unbalanced(wave, SPACING) == pytest.approx(np.sqrt(0.5), rel=1e-12)


@pytest.mark.parametrize("more", [1.0, 30.0])
def test_no_flux_has_more_energy_than_is_told(more):
    """Where whole voxels resist most, and where those do that are cut."""
    cells = some_cells(7, (3, 3))
    cells = cells._replace(table=more * cells.table)
    # Those of positive resistivities: the product of shapes is at most the mean of their squares.
    first, both, last = np.moveaxis(cells.table, -1, 0)
    cells = cells._replace(table=np.stack([first, np.minimum(both, np.sqrt(first * last)), last], axis=-1))
    rng, most = np.random.default_rng(8), fluxes._largest(cells)
    for _ in range(20):
        flux, work = rng.normal(size=(3, *SHAPE)), np.empty((3, *SHAPE))
        kernels.resist(flux, work, cells, 0, SHAPE[0])
        assert np.sum(flux * work) < most * np.sum(flux**2)


def test_a_flux_that_is_not_balanced_proves_less(monkeypatch):
    """With the last balancing left out and a rest put in, the bound falls by what is counted, not below the truth."""
    shape, gradient = (8, 1, 1), np.array([1.0, 0.0, 0.0])
    cells = Cells(
        np.where(np.arange(8) < 4, 1.0, 5.0).reshape(shape), np.full(shape, -1, np.int32), np.empty((0, 3, 3))
    )
    whole = fluxes._balancing

    def rough(*arguments):
        inverse, _ = whole(*arguments)
        # More where it is cheap: without what is counted this proves more than the truth.
        cheat = np.where(np.arange(8) < 4, 0.1, -0.1).reshape(1, 8, 1, 1) * gradient.reshape(3, 1, 1, 1)
        return inverse, lambda flux: flux + cheat

    monkeypatch.setattr(fluxes, "_balancing", rough)
    with Team(1) as team:
        flux, _ = fluxes.flux(cells, np.ones(3) / 8, gradient, tolerance=1e-9, most=50, team=team)
        found, unbalanced = fluxes.least(cells, np.ones(3) / 8, [flux], team=team)
    assert found[0, 0] < 1 / 3 < found[0, 0] * (1 + unbalanced)


def test_a_descent_ends_where_nothing_is_left():
    from references.bracket.voxels.descent import descend

    told = SimpleNamespace(shares=[])
    matrix = np.diag([1.0, 2.0, 5.0])
    found = descend(
        lambda x: matrix @ x,
        np.copy,
        np.zeros(3),
        loaded=(-np.ones(3), 10.0),
        tolerance=1e-300,
        most=50,
        done=told.shares.append,
    )
    np.testing.assert_allclose(found.field, [1.0, 0.5, 0.2], rtol=1e-12)
    assert found.iterations <= 4 and all(0 <= share <= 1 for share in told.shares)
