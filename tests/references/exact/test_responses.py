"""Responses of slab and sphere: images against modes, and what is smooth in the centre."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from references.exact.responses import CROSSOVER, response, sphere_response

CASES = [(drive, far) for drive in ("temperature", "flux", "ramp") for far in ("held", "insulated")]


@pytest.mark.parametrize("time", [0.003, CROSSOVER * 0.999, CROSSOVER * 1.001, 0.05, 0.3])
def test_images_and_modes_agree(time):
    x = np.linspace(0, 1, 41)
    for drive, far in CASES:
        one, other = (response(x, time, drive, far, method=method) for method in ("images", "modes"))
        # Sums of less than 200 terms of order one; what is asked for is 1e-12.
        assert_allclose(one, other, rtol=0, atol=2e-14, err_msg=f"{drive}, {far}")
    for drive in ("temperature", "ramp"):
        # Images are divided by r and its square: near the centre they are of use for short times only.
        r = x if time < 1.1 * CROSSOVER else x[1:]
        one, other = (sphere_response(r, time, drive, method=method) for method in ("images", "modes"))
        assert_allclose(one, other, rtol=0, atol=1e-12, err_msg=drive)


@pytest.mark.parametrize("drive", ["temperature", "ramp"])
@pytest.mark.parametrize("time", [0.002, 0.009, 0.02, 0.2])
def test_the_centre_of_the_sphere_is_smooth(drive, time):
    r = np.array([0.0, 1e-12, 1e-9, 1e-7, 1e-5, 1e-4])
    value, slope = sphere_response(r, time, drive)
    beyond = sphere_response([1e-3], time, drive)[0][0]
    curvature = 2 * (beyond - value[0]) / 1e-6
    # Even in r, to rounding; the difference quotient has an error of 1e-3 squared over the time, at most.
    assert_allclose(value, value[0] + curvature * r**2 / 2, rtol=0, atol=1e-11 * abs(value[0]) + 1e-14)
    assert_allclose(slope, curvature * r, rtol=1e-3, atol=1e-12)
