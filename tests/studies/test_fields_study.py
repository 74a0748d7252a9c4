"""The study of fields on a plane: what its rows, claims and pictures are made of."""

from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat.gallery import slab, sphere_in_cube
from demheat.packing.relax import relax
from references import exact
from studies import fig15_16_fields as study
from studies.common import field_errors
from studies.harness import provenance

# An exact field, and the same with known errors: 0.2 K, and 33 W/m2 across the load of 3300.
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
    row = field_errors.over_plane(off_by(1 / 0.1), off_by(1 / 0.1).flux_at, SLAB, study.PLANE, 100, widths)
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


def test_pictures_are_fields_of_the_exact_row_and_errors_of_others():
    truth = field_errors.pictures(SLAB, SLAB.flux_at, SLAB, study.PLANE, 4)
    assert_allclose(field_errors.picture(truth["slice_temperature"]), np.repeat([[12.5], [37.5], [62.5], [87.5]], 4, 1))
    assert_allclose(field_errors.picture(truth["slice_flux"]), 100.0)
    cells = field_errors.pictures(off_by(0), lambda points: 0.9 * SLAB.flux_at(points), SLAB, study.PLANE, 4)
    assert_allclose(field_errors.picture(cells["slice_temperature"]), 2.0)
    assert_allclose(field_errors.picture(cells["slice_flux"]), -10.0)


def test_cells_keep_their_digits():
    values = np.array([[-0.001, 1.2345], [np.nan, 1e4]])
    text = field_errors.cell(values, 2)
    assert text == "0 1.23 nan 10000"
    assert_allclose(field_errors.picture(text), [[0.0, 1.23], [np.nan, 1e4]])
    with pytest.raises(ValueError, match="3 numbers: must hold a square"):
        field_errors.picture("1 2 3")


def test_the_exact_row_is_rayleighs(monkeypatch):
    monkeypatch.setattr(study, "GRID", 40)
    row = study.run("exact", method="exact")
    for key, (value, digits) in study.RAYLEIGH.items():
        assert row[key] == pytest.approx(value, abs=0.51 * 10**-digits)
    assert row["flux_max"] == row["temperature_max"] == row["q_C_error"] == 0.0
    assert len(field_errors.picture(row["slice_flux"])) == study.PICTURE


def test_a_halo_stands_in_for_the_flux_only(monkeypatch):
    from demheat import dem

    solved = []
    monkeypatch.setattr(study, "GRID", 40)  # points that take time and tell nothing here
    monkeypatch.setattr(dem, "solve", _kept(dem.solve, solved))
    case = {"method": "dem", "law": "calibrated", "particles": 500, "seed": 5}
    raw, smooth = (study.run("dem-calibrated", ratio=ratio, **case) for ratio in (None, 4.0))
    assert raw["T_C"] == smooth["T_C"] and raw["temperature_rms"] == smooth["temperature_rms"]
    field, points = solved[1], np.array([[0.05, 0.05, 0.05]])
    samples = field.samples
    near = np.linalg.norm(samples.points - points, axis=1) <= 4 * field.stats["mean_radius"]
    mean = np.average(samples.flux[near, 1], weights=samples.volumes[near])
    assert_allclose(smooth["q_A"], -mean, rtol=1e-12)  # one mean in two orders of summation
    assert raw["q_A"] != smooth["q_A"] and raw["flux_rms_own"] > smooth["flux_rms_own"]


def _kept(solve, solved):
    def keeping(*args, **knobs):
        solved.append(solve(*args, **knobs))
        return solved[-1]

    return keeping


def test_orders_of_exact_second_and_first_order():
    import pandas as pd

    number = np.array([1_000, 8_000, 64_000])
    errors = {"flux_rms_far": 1 / number ** (1 / 3), "temperature_rms": 1 / number ** (2 / 3)}
    (_, flux, at_least), (_, warm, _) = study._orders(pd.DataFrame({"name": "dem", "particles": number} | errors))
    assert_allclose([flux, warm], [1.0, 2.0], rtol=1e-12)
    assert at_least == ">= 1.5"


def test_claims_see_an_error():
    import pandas as pd

    columns = ["flux_rms", "flux_max", "flux_rms_band", *study._errors("q"), *study._errors("T")]
    row = dict.fromkeys(columns, 0.01) | {"q_B_error": -0.7, "name": "dem", "particles": study.PAPERS}
    row |= {"method": "dem", "heat_imbalance": 1e-9}
    found = {text.split(": ")[1]: value for text, value, _ in study._laguerre(pd.DataFrame([row])) if value is not None}
    assert found["largest error of a flux of Table 2, %"] == 0.7
    assert found["largest error of a temperature of Table 2, K"] == 0.01


def test_a_new_drawing_repeats_no_row(monkeypatch):
    parse, seen = provenance._parse, set()
    monkeypatch.setattr(provenance, "_parse", lambda path: seen.add(path.stem) or parse(path))
    provenance.code_hash.cache_clear()
    provenance.code_hash(study.__file__, "demheat.dem")
    provenance.code_hash.cache_clear()
    assert {"field_errors", "slices", "halo"} <= seen and "field_pictures" not in seen
