"""What a row of speed against error computes: one solve, its errors against the exact solution, and its costs."""

from __future__ import annotations

import tempfile
import warnings

from demheat import referee
from studies.harness import methods
from studies.harness.cost import measured
from studies.speed_error.scenes import IN_TIME, TIMES, exact_of, points_of, scene_of

# What a second solve, whose packing is kept already, costs.
AGAIN = ("wall_s", "cpu_s", "peak_mib")
# Temporal errors far below the finest target: of the whole march, and of each of some hundred steps.
MARCH = {"dem": 1e-5, "fem": 2e-6}
# Knobs of a steady solve that a march has not, and what the contact law needs in bodies without an inside.
STEADY_ONLY, CONTACTS = ("curved",), {"beam": 7.5}
STATS = ("unknowns", "iterations", "residual", "integrator", "steps")


def solved(name, *, method, **knobs):
    """Solve a scene by a method, the DEM from an empty packing cache and then again."""
    once = _march if name in IN_TIME else _steady
    with warnings.catch_warnings():
        # What coarse particles and voxels do not resolve is what the errors show.
        warnings.filterwarnings("ignore", message=".*(do not fit into gaps|no particle lies|thin|narrow|miss them)")
        if "particles" not in knobs:
            return once(name, method=method, **knobs)
        # Made before the packings of this row are kept apart.
        if name not in IN_TIME:
            exact_of(name)
        with tempfile.TemporaryDirectory() as folder, methods.packings_in(folder):
            cold = once(name, method=method, **knobs)
            again = once(name, method=method, judged=False, **knobs)
    return cold | {f"cached_{key}": again[key] for key in AGAIN}


def _steady(name, *, method, judged=True, **knobs):
    exact = exact_of(name)
    ratio = exact.conductivity / methods.MATRIX
    field, row = methods.solved(scene_of(name), ratio, method=method, **knobs)
    return row | _at_points(name, field, exact) if judged else row


def _at_points(name, field, exact):
    """Errors of temperature and flux at the points, % of the span and of the mean flux, and what it costs to ask."""
    points = points_of(name)
    (warm, flux), cost = measured(lambda: (field.temperature_at(points), field.flux_at(points)))
    return {
        "temperature_rms": referee.temperature_error(field, exact, points, values=warm, unit="%").rms,
        "flux_rms": referee.flux_error(field, exact, points, values=flux, unit="%").rms,
        "points_cpu_s": cost["cpu_s"],
        "points_wall_s": cost["wall_s"],
    }


def _march(name, *, method, judged=True, **knobs):
    """Temperatures at all times; the error is the largest over the times of the rms over the points, % of the span."""
    from references import series

    scene, times, points = scene_of(name), TIMES[name], points_of(name)
    knobs = {key: value for key, value in knobs.items() if key not in STEADY_ONLY} | _contacts(name, knobs)

    def march():
        fields = methods.load(method).evolve(scene, times, accuracy=MARCH[method], **knobs)
        return [(field, field.temperature_at(points)) for field in fields]

    found, cost = measured(march)
    row = {key: found[-1][0].stats.get(key) for key in STATS}
    if judged:
        exact = series.evolve(scene, times, points_per_axis=1)
        pairs = zip(found, exact, strict=True)
        errors = [
            referee.temperature_error(field, right, points, values=warm, unit="%").rms for (field, warm), right in pairs
        ]
        row |= {"error_percent": max(errors)}
    return row | cost


def _contacts(name, knobs):
    wanted = knobs.get("law") == "calibrated" and name in CONTACTS
    return {"coordination": CONTACTS[name]} if wanted else {}


def warm_up(name, *, method, **knobs):
    """Load and compile what a row needs, at a size that costs next to nothing; keeps nothing on disk."""
    if name not in IN_TIME:
        methods.warm_up(method, **knobs)
        exact_of(name)
        return
    small = {"particles": 500} if "particles" in knobs else {"size": max(scene_of("slab").size) / 4}
    with tempfile.TemporaryDirectory() as folder, methods.packings_in(folder):
        _march("slab", method=method, **{**knobs, **small})
