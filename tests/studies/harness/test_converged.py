"""Extrapolation of a method's own rows."""

import numpy as np
import pandas as pd
from numpy.testing import assert_allclose

from studies.harness.converged import converged


def ladder(name, knob, sizes, values):
    return pd.DataFrame({"name": name, knob: sizes, "k_ratio": values, "status": "ok"})


def test_converged_takes_off_the_terms_that_it_names():
    h = np.array([1 / 64, 1 / 128, 1 / 256])
    voxels = ladder("fft", "voxels", [64, 128, 256], 1.5 + 2 * h - 30 * h**2)
    assert_allclose(converged(voxels, "fft"), 1.5, rtol=1e-12)  # rounding
    particles = ladder("dem", "particles", [1e3, 1e4, 1e5], 1.5 + np.array([9.0, 1e4 ** (-2 / 3), 1e5 ** (-2 / 3)]))
    # Rounding again; the coarsest does not count.
    assert_allclose(converged(particles, "dem"), 1.5, rtol=1e-12)
    assert converged(ladder("fem", "size", [0.1, 0.05], [2.0, 1.6]), "fem") == 1.6
    assert converged(voxels.iloc[:2], "fft") is None
    assert np.isnan(converged(voxels.assign(k_ratio=[1.5, np.nan, 1.5]), "fft"))
