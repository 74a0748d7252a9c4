"""What methods say of their own errors on one drawn scene, beside their errors."""

import math

import numpy as np

import demheat.dem
import references.fem
import references.fft
import references.multipole
from demheat.referee import conductivity_error, span, temperature_error, value_error
from studies.common.drawn import exact_field, scene_of
from studies.harness.cost import measured
from studies.harness.methods import all_methods

MODULES = {"dem": demheat.dem, "fem": references.fem, "fft": references.fft, "multipole": references.multipole}
# Least and largest value of each knob: what is drawn between them by the scene's seed; lengths in longest sides.
DRAWN = {"particles": (2000, 20_000), "voxels": (24, 80), "size": (1 / 10, 1 / 5), "order": (4, 12)}
# Iterations of FFT schemes, beyond which they say that they did not converge: pores among good conductors need many.
ITERATIONS = 1000
# At as many random points temperatures are compared.
POINTS = 500


def judged(kind, seed, names):
    """Error and estimate of each method."""
    scene = scene_of(kind, seed)
    exact = exact_field(kind, scene)
    rng = np.random.default_rng([seed, 1])
    points = rng.random((POINTS, 3)) * scene.size
    # Pores have no temperature.
    points = points[scene.conductivities[scene.phase_at(points)] > 0]
    row = {"exact": exact.conductivity}
    for name in names:
        share = rng.random()
        try:
            row |= {f"{name}_{key}": value for key, value in _one(name, scene, exact, points, share).items()}
        except (NotImplementedError, RuntimeError) as error:
            if not isinstance(error, NotImplementedError) and "did not converge" not in str(error):
                raise
            row[f"{name}_note"] = " ".join(str(error).split())
    return row


def _one(name, scene, exact, points, share):
    method = all_methods()[name]
    low, high = DRAWN[method.resolution.knob]
    value = low * (high / low) ** share
    if not method.resolution.metric:
        value = round(value)
    knobs = method.knobs | method.at(value, max(scene.size))
    if method.module == "fft":
        knobs["max_iterations"] = ITERATIONS
    field, cost = measured(MODULES[method.module].solve, scene, **knobs)
    estimate, more = measured(lambda: field.error)
    warmth = temperature_error(field, exact, points).rms
    return {
        "off": 100 * conductivity_error(field, exact),
        "half": _half(estimate, exact.conductivity),
        "low": estimate.lower,
        "high": estimate.upper,
        "t_off": 100 * warmth,
        "t_half": 100 * estimate.temperature / span(scene),
        "value": value,
        "cpu_s": cost["cpu_s"],
        "more_s": more["cpu_s"],
    }


def _half(estimate, exact):
    """Half of the interval, % of the exact conductivity."""
    if exact == 0:
        return math.nan
    return 50 * (value_error(estimate.upper, exact) - value_error(estimate.lower, exact))
