"""The study of tuning: constants that are set and set back, errors of made-up rows, the two parts of an error."""

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from demheat.packing.cache import relaxed
from demheat.packing.twins import conforming, patterns
from demheat.packing.twins.conforming import conform
from demheat.scene import Material, Scene, Sphere
from studies.harness.cells import numbers
from studies.tuning import means, order, scenes
from studies.tuning.cases import OLD
from studies.tuning.constants import CONSTANTS, constant_set

# Two spheres of one material, nearly touching: every constant has something to do.
PAIR = Scene(
    (1.0, 1.0, 1.0),
    Material(1.0),
    [Sphere((0.3, 0.5, 0.5), 0.19, Material(10.0)), Sphere((0.7, 0.5, 0.5), 0.2, Material(10.0))],
    gradient=(0, 1, 0),
)


def twins():
    packing = conform(relaxed(1000, seed=1), PAIR, seed=1)
    return np.column_stack([packing.centers, packing.radii])


# The spacing in gaps is a choice of the law, not a constant of a module; old packings are none.
@pytest.mark.parametrize("name", [name for name in CONSTANTS if name not in ("GAP_SPACING", *OLD)])
def test_a_constant_is_set_and_set_back(name):
    before = twins()
    with constant_set(name, 0.7 if name != "LEAST_OFFSET" else 3.0):
        changed = twins()
    assert changed.shape != before.shape or not np.array_equal(changed, before)
    with constant_set(name, 1.0):
        # EXCESS and the rest of a weight are added in another order: rounding.
        assert_allclose(twins(), before, rtol=1e-12, atol=1e-12)
    assert np.array_equal(twins(), before)


def test_a_constant_is_set_wherever_its_name_is_known_and_after_an_error_too():
    with pytest.raises(ZeroDivisionError), constant_set("SPACING", 2.0):
        assert conforming.SPACING == patterns.SPACING == 2 * CONSTANTS["SPACING"].unit
        raise ZeroDivisionError
    assert conforming.SPACING == patterns.SPACING == CONSTANTS["SPACING"].unit


@pytest.mark.parametrize("family", scenes.FAMILIES)
def test_families_are_what_they_are_called(family):
    for seed in range(200, 203):
        scene = scenes.scene_of(family, seed)
        assert scene == scenes.scene_of(family, seed) != scenes.scene_of(family, seed + 1)
        low = np.array([np.array(s.center) - s.radius for s in scene.inclusions])
        high = np.array([np.array(s.center) + s.radius for s in scene.inclusions])
        inside = np.all((low > 0) & (high < 1), axis=1)
        assert scene.periodic == (family not in ("walled", "cut"))
        if not scene.periodic:
            assert not inside.any() if family == "cut" else inside.all()
        contrasts = np.abs(np.log10(scene.conductivities[1:]))
        assert (contrasts.min() >= 2) == (family == "strong")


def varied(constant, factor, values, particles=2000):
    same = {"part": "varied", "group": "unseen", "constant": constant, "factor": factor, "particles": particles}
    return same | {"unknowns": 2500.0} | dict(zip(("walled", "strong"), values, strict=True))


def reference(family, k):
    return {"part": "reference", "group": "unseen", "family": family, "k": k, "doubt": "1e-6 1e-6"}


def made_up(*others):
    """Errors of -.1, .3 and of .2, .2 %, as shipped."""
    known = [reference("walled", "1 2"), reference("strong", "4 4")]
    return pd.DataFrame([*known, varied(None, 1.0, ("0.999 2.006", "4.008 4.008")), *others])


def test_errors_are_those_against_the_witness_of_the_same_scene():
    found = means.errors(made_up(), "unseen")
    assert_allclose(found["error"], [-0.1, 0.3, 0.2, 0.2], rtol=1e-9)  # rounding
    line = means.summed(found).iloc[0]
    assert_allclose([line["median"], line["mean"], line["high"]], [0.2, 0.15, 0.27], rtol=1e-9)
    assert_allclose(line["sem"], np.std([-0.1, 0.3, 0.2, 0.2], ddof=1) / 2, rtol=1e-9)


def test_two_powers_are_told_apart():
    particles = np.array([1000.0, 8000.0, 27000.0, 64000.0])
    h = particles ** (-1 / 3)
    table = pd.DataFrame({"particles": particles, "error": 5 * h**2 - 100 * h**3, "error_sem": 1e-3 * h**2})
    values, doubts = means.two_powers(table)
    assert_allclose(values, [5, -100], rtol=1e-9)
    assert np.all(doubts > 0) and np.all(doubts / np.abs(values) < 1e-3)


def test_orders_are_fitted_with_their_errors():
    sizes = np.array([1000.0, 8000.0, 64000.0])
    table = pd.DataFrame({"particles": sizes, "error": 1000 / sizes, "error_sem": 10 / sizes, "packings": 4})
    found, doubt = means.fitted(table, "error")
    assert_allclose(found, 3.0, rtol=1e-9)
    # A hundredth of each value: the slope of three points two octaves apart, in the logarithm.
    assert_allclose(doubt, 0.01 / (np.log(2) * np.sqrt(2)), rtol=0.15)  # of 400 draws


def test_an_error_is_its_two_parts():
    """Power of the exact temperature less that of what is off it: as the network's temperature has the least power."""
    row = order.decomposed("sphere", 10.0, 1000, 2)
    error, quadrature, misfit = (numbers(row[name]) for name in ("error", "quadrature", "misfit"))
    # Six digits are stored; the witness is known to 1e-6 %.
    assert_allclose(error, quadrature - misfit, atol=3e-6)
    assert np.all(misfit > 0.05) and np.all(numbers(row["misfit_beside"]) < misfit)
    assert_allclose(numbers(row["volume"]), 0, atol=1e-8)
