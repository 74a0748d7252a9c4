"""Only here: a constant that is varied without effect, or not set back."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat.packing.cache import relaxed
from demheat.packing.twins import conforming, patterns
from demheat.packing.twins.conforming import conform
from demheat.scene import Material, Scene, Sphere
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
