"""The studies of the slab and of the integrators: what their rows are made of."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from studies.common import slab
from studies.time_integrators import rows as integrator_rows


def test_means_over_slices():
    y = slab.LENGTH * np.array([0.0, 0.01, 0.26, 0.99, 1.0])
    middle, mean = slab.binned(y, np.array([1.0, 3.0, 5.0, 7.0, 9.0]), bins=4)
    assert_allclose(middle, [0.125, 0.375, 0.625, 0.875])
    assert mean.tolist() == [2.0, 5.0, 0.0, 8.0]


@pytest.mark.parametrize("integrator", ["rkl2", "euler"])
def test_error_is_against_a_finer_run(integrator):
    row = integrator_rows.marched("slab", 500, integrator, None if integrator == "euler" else 1e-2)
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


def test_the_slab_is_the_papers():
    scene = slab.slab()
    # Diffusivity 4.7e-3 m2/s: with 0.9 J/(kg K), as printed.
    assert_allclose(
        scene.matrix.conductivity / (scene.matrix.density * scene.matrix.heat_capacity), 4.7009e-3, rtol=1e-4
    )
    assert scene.wall_temperatures == {"y-": 25.0, "y+": 35.0} and scene.initial == 25.0
