"""The study of integrators: errors against finer runs; LAMMPS and our kernel, the same links and temperatures."""

import itertools
import math
import sys

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat.packing.base import make_packing
from studies.common.slab import METAL
from studies.time_integrators import lammps_peer
from studies.time_integrators import rows as integrator_rows


def bed_and_network():
    """Eighty spheres of size ratio two, at random places in a box between walls."""
    draw = np.random.default_rng(4)
    packing = make_packing(draw.uniform(0.1, 0.9, (80, 3)), draw.uniform(0.05, 0.1, 80), (1.0,) * 3, False, {})
    return lammps_peer.grown(packing, margin=0.0)


def test_links_are_the_overlapping_pairs():
    bed, network = bed_and_network()
    expected = {}
    for i, j in itertools.permutations(range(bed.number), 2):
        overlap = bed.radii[i] + bed.radii[j] - math.dist(bed.centers[i], bed.centers[j])
        if overlap > 0:
            shared = bed.radii[i] * bed.radii[j] / (bed.radii[i] + bed.radii[j])
            expected[i, j] = 2 * METAL.conductivity * math.sqrt(overlap * shared)
    rows = np.repeat(np.arange(bed.number), np.diff(network.indptr))
    found = dict(zip(zip(rows.tolist(), network.indices.tolist(), strict=True), network.conductance, strict=True))
    assert len(found) == len(network.indices) == 600 and found.keys() == expected.keys()
    # Rounding of an overlap that may be 1e-5 of the radii.
    assert_allclose([found[pair] for pair in expected], list(expected.values()), rtol=1e-10)


@pytest.mark.parametrize("contact", lammps_peer.CONTACTS)
def test_lammps_computes_the_same(contact, monkeypatch):
    pytest.importorskip("lammps")
    monkeypatch.setattr(lammps_peer, "MOST", 50)
    row = lammps_peer.beside(600, contact)
    assert row["steps"] == 50 * lammps_peer.TURNS
    # Rounding, of 300 steps; found 1e-15.
    assert row["difference"] < 1e-12 and row["energy_error"] < 1e-12


def test_refused_where_lammps_is_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "lammps", None)
    with pytest.raises(NotImplementedError, match="lammps is not installed"):
        lammps_peer.beside(600)


def test_error_is_against_a_finer_run(integrator="rkl2"):
    row = integrator_rows.marched("slab", 500, integrator, 1e-2)
    system, start = integrator_rows.system_of("slab", 500)
    coarse, fine = (
        integrator_rows._integrated(system, start, 0.2, name, accuracy).temperature
        for name, accuracy in ((integrator, 1e-2), ("rkl2", 1e-6))
    )
    right = 100 * np.sqrt(np.mean((coarse - fine) ** 2)) / 10.0
    # The row's own reference is at 1e-5 of the span, 0.001 %.
    assert_allclose(row["error_percent"], right, atol=2e-3)
    assert right > 0.01 and row["taken"] == integrator and not row["extrapolated"]


def test_a_long_run_of_euler_is_extrapolated(monkeypatch):
    monkeypatch.setattr(integrator_rows, "MOST_STEPS", 50)
    monkeypatch.setattr(integrator_rows, "SAMPLE", 20)
    row = integrator_rows.marched("sphere", 500, "euler", None)
    assert row["extrapolated"] and row["steps"] > 50 and "error_percent" not in row
    assert row["cpu_s"] > 0 and row["bandwidth_share"] > 0 and row["million_particle_steps"] > 0
