"""Only here: LAMMPS and our kernel on other links, or at other temperatures; LAMMPS where it is not."""

import itertools
import math
import sys

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat.packing.base import make_packing
from studies.common.slab import METAL
from studies.time_integrators import lammps_peer


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
