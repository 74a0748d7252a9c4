"""The study of the slab: what it keeps of the particles."""

import numpy as np
from numpy.testing import assert_allclose

from studies import fig05_slab as study
from studies.harness.cells import numbers


def test_particles_in_the_papers_measure():
    """One particle in a slice is 2 % off, all others 0.1 %; of many some are kept, and the largest of each slice."""
    y = (np.arange(1000) + 0.5) / 1000
    local = np.where(np.arange(1000) == 730, -0.02, 0.001)
    row = study._over_particles(y, local, "0.1")
    most = numbers(row["dots_most_0.1"])
    assert_allclose(most, np.where(np.arange(study.SLICES) == 14, 2.0, 0.1))
    assert len(numbers(row["dots_y"])) == len(numbers(row["dots_0.1"])) == study.DOTS
    # A last particle at the wall is in the last slice.
    assert numbers(study._over_particles(np.array([1.0]), np.array([0.5]), "0.1")["dots_most_0.1"])[-1] == 50.0
