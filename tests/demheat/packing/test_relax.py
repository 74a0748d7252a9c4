"""Only here: relaxed packings with order in them, overlaps other than reported, walls that give way."""

import importlib
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from demheat.packing.base import make_packing
from demheat.packing.neighbours import contacts, neighbours
from demheat.packing.radii import Bidisperse
from demheat.packing.relax import relax, settle

module = importlib.import_module("demheat.packing.relax")
# A grid of 16^3 is what they begin from.
NUMBER = 4096


@pytest.fixture(scope="module")
def packing():
    return relax(NUMBER, seed=2)


def pair_overlaps(packing):
    """Overlap of each overlapping pair (once), m, by distances that the relaxation had no part in."""
    indptr, indices = neighbours(packing)
    rows = np.repeat(np.arange(packing.number), np.diff(indptr))
    offsets = packing.centers[indices] - packing.centers[rows]
    offsets -= np.where(packing.periodic, packing.size * np.rint(offsets / packing.size), 0.0)
    overlaps = packing.radii[rows] + packing.radii[indices] - np.linalg.norm(offsets, axis=1)
    return overlaps[rows < indices]


def test_phi_is_exact_and_overlaps_are_as_reported(packing):
    assert packing.number == NUMBER and packing.centers.min() >= 0 and np.all(packing.centers < packing.size)
    assert_allclose(packing.phi, 0.64, rtol=1e-13)  # rounding of a sum of 4096 cubes
    reached, overlaps = packing.provenance, pair_overlaps(packing)
    assert reached["converged"] and reached["mean_overlap"] <= 0.002
    # Rounding of positions, relative to overlaps of 1e-3.
    assert_allclose(overlaps.mean() / (2 * packing.radii.mean()), reached["mean_overlap"], rtol=1e-9)
    assert_allclose(overlaps.max() / (2 * packing.radii.mean()), reached["max_overlap"], rtol=1e-9)
    # At 0.64 there must be overlapping pairs, several per particle: spheres that vanished would have none.
    assert len(overlaps) > NUMBER


@pytest.mark.parametrize("domain, periodic", [("cylinder-y", (False, True, False)), ("sphere", False)])
def test_round_domains(domain, periodic):
    packing = relax(2000, size=(1, 1, 1), phi=0.5, periodic=periodic, domain=domain, overlap=1e-4)
    assert packing.number == 2000 and packing.domain == domain and packing.provenance["converged"]
    assert_allclose(packing.phi, 0.5, rtol=1e-13)  # rounding of a sum of 2000 cubes
    axes = [0, 2] if domain == "cylinder-y" else [0, 1, 2]
    out = np.linalg.norm(packing.centers[:, axes] - 0.5, axis=1) + packing.radii - 0.5
    # The wall's overlaps are among those whose mean is asked to be 1e-4 of the diameter; the worst is some ten of it.
    assert -0.1 * packing.radii.mean() < out.max() < 0.02 * packing.radii.mean()


def test_packing_is_isotropic(packing):
    """Second and fourth moments of the branch vectors within sampling error, no Bragg peak of the starting grid."""
    indptr, indices, _ = contacts(packing, coordination=7.5)
    rows = np.repeat(np.arange(NUMBER), np.diff(indptr))
    normals = packing.centers[indices] - packing.centers[rows]
    normals -= np.rint(normals)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    links = len(indices) / 2
    fabric = normals.T @ normals / len(normals)
    # Limits are 4 standard deviations of independent links: variance 4/45 of n_x^2, 1/15 of n_x n_y, 16/225 of n_x^4.
    assert_allclose(np.diag(fabric), 1 / 3, atol=4 * np.sqrt(4 / 45 / links))
    assert_allclose(fabric[np.triu_indices(3, 1)], 0.0, atol=4 * np.sqrt(1 / 15 / links))
    assert_allclose((normals**4).mean(axis=0), 1 / 5, atol=4 * np.sqrt(16 / 225 / links))
    # Structure factor at the wave vectors of the 16^3 grid: exponential of mean below 1 without order, so above 12
    # once in 1e5; a jitter of 0.15 spacings left 100 to 300 at twice this number, in proportion to it.
    peaks = np.abs(np.exp(2j * np.pi * 16 * packing.centers).sum(axis=0)) ** 2 / NUMBER
    assert peaks.max() < 12


@pytest.mark.parametrize("periodic", [False, (True, False, True)])
def test_walls_hold(periodic):
    packing = relax(1500, phi=0.58, periodic=periodic, size=(0.02, 0.01, 0.01), seed=4)
    assert packing.provenance["converged"]
    depth = np.minimum(packing.centers, packing.size - packing.centers) / packing.radii[:, None]
    # A particle may sink into a wall as deep as it overlaps others, here a few percent at most of the mean diameter.
    tolerance = 2 * packing.provenance["max_overlap"] * packing.radii.mean() / packing.radii.min()
    assert depth[:, ~packing.periodic].min() >= 1 - tolerance
    assert packing.provenance["max_overlap"] < 0.04
    # The periodic axes have no such layer.
    if packing.periodic.any():
        assert depth[:, packing.periodic].min() < 0.2


def test_more_than_fits_is_said():
    packing = relax(300, phi=0.74, seed=0, steps=60)
    assert not packing.provenance["converged"] and packing.provenance["iterations"] == 60
    assert packing.provenance["mean_overlap"] > 0.01


@pytest.mark.parametrize("number", [1, 7, 997])
def test_any_number_is_exact(number):
    packing = relax(number, phi=0.01, size=(1.0, 2.0, 3.0), allow_few=True, steps=20)
    assert packing.number == number


def test_seeds_differ_and_repeat():
    first, again, other = (relax(200, seed=seed, steps=20) for seed in (0, 0, 1))
    assert_array_equal(first.centers, again.centers)
    assert not np.array_equal(first.radii, other.radii)


def test_lists_are_renewed_in_time(monkeypatch):
    """A list in every step gives the same packing as lists with a skin, up to the order of summation."""
    usual = relax(500, steps=40)
    monkeypatch.setattr(module, "SKIN", 1e-12)
    fresh = relax(500, steps=40)
    assert fresh.provenance["lists"] > 40 > usual.provenance["lists"]
    # Rounding grows tenfold in about 10 steps of colliding spheres.
    assert_allclose(fresh.centers, usual.centers, rtol=0, atol=1e-9)


def test_settle_moves_only_free_particles():
    packing = relax(1000, steps=5)
    fixed = packing.centers[:, 0] < 0.3
    settled = settle(packing, fixed=fixed, steps=150)
    assert_array_equal(settled.centers[fixed], packing.centers[fixed])
    assert_array_equal(settled.radii, packing.radii)
    # A few free ones touch nothing and stay.
    assert np.any(settled.centers != packing.centers, axis=1)[~fixed].mean() > 0.95
    mobile = settled.provenance["settled"]
    # From 5 steps (about 15 %) to far less; the fixed ones keep their overlaps.
    assert mobile["mean_overlap"] < 0.3 * packing.provenance["mean_overlap"]
    assert settle(packing, fixed=np.ones(1000, dtype=bool)).provenance["settled"]["iterations"] == 0


def test_settle_parts_twins_at_one_place():
    centers = np.array([[0.5, 0.5, 0.5], [0.5, 0.5, 0.5]])
    packing = settle(make_packing(centers, [0.1, 0.1], (1, 1, 1), True, {}), steps=200, overlap=1e-6)
    # Less the overlap allowed; nothing holds them back when they fly apart.
    assert 0.2 * (1 - 1e-6) < np.linalg.norm(np.diff(packing.centers, axis=0)) < 0.5


def test_progress_is_told():
    seen = []
    packing = relax(200, progress=lambda step, mean: seen.append((step, mean)))
    assert [step for step, _ in seen] == list(range(packing.provenance["iterations"] + 1))
    assert seen[-1][1] == packing.provenance["mean_overlap"]


def test_the_part_done_follows_the_digits_of_the_overlap_or_the_steps():
    goal = SimpleNamespace(overlap=1e-4, steps=1000)
    assert module._share(10, 1e-3, 1e-2, goal) == pytest.approx(0.5)
    assert module._share(800, 1e-3, 1e-2, goal) == 0.8
    # Not yet below the first, there already, and nothing to begin with: steps alone tell.
    for mean, first in ((2e-2, 1e-2), (1e-5, 1e-2), (0.0, 0.0)):
        assert module._share(10, mean, first, goal) == 0.01
    assert module._share(10, 1.01e-4, 1e-2, goal) == 0.95


def test_few_must_be_meant():
    with pytest.raises(ValueError, match="number = 99: .* pass allow_few=True"):
        relax(99)


def test_too_wide_a_distribution():
    with pytest.raises(ValueError, match="side 0 must be .*; use more particles"):
        relax(200, radii=Bidisperse(20.0, 0.005))
