"""What the studies of fields look at, on an exact field and the same with known errors."""

from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat.gallery import slab, sphere_in_cube
from demheat.packing.relax import relax
from references import exact
from studies.common import field_errors
from studies.harness.cells import picture

PLANE = {"axis": 2, "at": 0.05}
# Known errors: 0.2 K, and 33 W/m2 across the load of 3300.
SLAB = exact.solve(slab())


def off_by(scale):
    """The slab's field with an error that grows along x."""
    return SimpleNamespace(
        scene=SLAB.scene,
        stats={},
        samples=SLAB.samples._replace(temperature=SLAB.samples.temperature + 0.1),
        temperature_at=lambda points: SLAB.temperature_at(points) + 0.2,
        flux_at=lambda points: SLAB.flux_at(points) + scale * points[:, :1] * [330.0, 0.0, 0.0],
    )


def test_mean_diameter_is_that_of_a_packing():
    packing = relax(2000, size=(0.1, 0.1, 0.1), periodic=True, seed=1)
    # The mean cube of 2000 radii drawn at random scatters by 2 %, its root by 0.7 %; thrice that.
    assert field_errors.mean_diameter(2000, slab()) == pytest.approx(2 * packing.radii.mean(), rel=0.02)


def test_clearance_of_interface_and_insulated_faces():
    scene = sphere_in_cube()
    # At the centre, on the interface, outside near the side x = 0, and near the held side y = 0, which does not count.
    places = np.array([(0.5, 0.5, 0.5), (5 / 6, 0.5, 0.5), (0.08, 0.5, 0.5), (0.5, 0.01, 0.5)])
    assert_allclose(
        field_errors.clearance(scene, 0.1 * places), 0.1 * np.array([1 / 3, 0.0, 0.08, 0.49 - 1 / 3]), atol=1e-15
    )


def test_errors_over_the_plane():
    widths = {"": 0.01, "_far": 0.03}
    row = field_errors.over_plane(off_by(1 / 0.1), off_by(1 / 0.1).flux_at, SLAB, PLANE, 100, widths)
    assert_allclose([row["temperature_rms"], row["temperature_max"]], 2.0)
    # 10 % of the mean flux times x / L, in the middles of the pixels: away from both sides 0.105 to 0.895, ...
    x = (np.arange(100) + 0.5) / 100
    for ending, here in {"": x[10:90], "_band": np.r_[x[:10], x[90:]], "_far": x[30:70]}.items():
        assert_allclose(row[f"flux_max{ending}"], 10 * here.max(), rtol=1e-12)
        assert_allclose(row[f"flux_rms{ending}"], 10 * np.sqrt(np.mean(here**2)), rtol=1e-12)
    assert row["sample_wall_s"] > 0


def test_errors_at_points_and_own_points():
    scene = SLAB.scene
    field = SimpleNamespace(scene=scene, temperature_at=off_by(0).temperature_at)
    row = field_errors.at_points(field, lambda points: 1.01 * SLAB.flux_at(points), SLAB, {"A": (0.5, 0.25, 0.5)})
    assert_allclose([row["T_A"], row["T_A_error"], row["q_A"], row["q_A_error"]], [27.7, 0.2, 3333.0, 1.0])
    assert_allclose(field_errors.at_own_points(off_by(0), SLAB)["own_temperature_rms"], 1.0)


def test_pictures_of_a_field_and_of_errors():
    truth = field_errors.field_pictures(SLAB, PLANE, 4)
    assert_allclose(picture(truth["slice_temperature"]), np.repeat([[12.5], [37.5], [62.5], [87.5]], 4, 1))
    assert_allclose(picture(truth["slice_flux"]), 100.0)
    cells = field_errors.error_pictures(off_by(0), lambda points: 0.9 * SLAB.flux_at(points), SLAB, PLANE, 4)
    assert_allclose(picture(cells["slice_temperature"]), 2.0)
    assert_allclose(picture(cells["slice_flux"]), -10.0)
