"""GMRES and the entries that are left out: neither scale nor threads change what is solved."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import gallery
from references.multipole.arrangement import arrange
from references.multipole.system import gmres
from references.multipole.translations import received, translation


def test_entries_left_out_and_threads_do_not_matter():
    spheres = arrange(gallery.random_dispersion(20, fraction=0.005, seed=1)).spheres
    table = translation(spheres, 16)
    assert table.top.min() < 15
    source = np.random.default_rng(0).normal(size=(2, 20, 45))
    found = received(spheres, table, source)
    # Entries bounded by 1e-14 and far below it: rounding.
    assert_allclose(
        found, received(spheres, table._replace(top=np.full_like(table.top, 16)), source), rtol=0, atol=1e-14
    )
    assert np.array_equal(found, received(spheres, table, source, threads=2))


def test_gmres_solves_and_stops():
    rng = np.random.default_rng(0)
    matrix, load = np.eye(30) + 0.3 * rng.normal(size=(30, 30)) / math.sqrt(30), rng.normal(size=30)
    found, iterations = gmres(lambda v: matrix @ v, load, np.zeros(30), 1e-10)
    assert_allclose(matrix @ found, load, rtol=0, atol=1e-10 * np.linalg.norm(load))
    assert 5 < iterations <= 30
    assert gmres(lambda v: matrix @ v, load, found, 1e-9)[1] == 0


@pytest.mark.parametrize("scale", [1e-30, 1e30])
def test_gmres_knows_no_scale(scale):
    """A large load counted as an exhausted basis."""
    rng = np.random.default_rng(0)
    matrix, load = np.eye(30) + 0.3 * rng.normal(size=(30, 30)) / math.sqrt(30), rng.normal(size=30)
    found, iterations = gmres(lambda v: matrix @ v, scale * load, np.zeros(30), 1e-10)
    expected, as_many = gmres(lambda v: matrix @ v, load, np.zeros(30), 1e-10)
    assert iterations == as_many
    assert_allclose(found / scale, expected, rtol=0, atol=1e-13)  # rounding of sums of 30
