"""The methods that the studies compare, found where their modules declare them, and one solve by one of them as a row.

A row names its method and, as `method`, its module; a case adds what the method fixes, the scene and the resolution.
"""

import math
import os
import tempfile
from contextlib import contextmanager

from demheat.declared import all_methods, load, path_of  # noqa: F401 (studies know them from here)
from demheat.gallery import EDGE, HADDAD, sphere_in_cube
from demheat.referee import conductivity_error, heat_balance, value_error
from studies.harness.cost import measured

MATRIX = HADDAD.conductivity
THIRD, HALF = 4 * math.pi / 81, 0.5  # volume fractions of the two sphere scenes: radius L/3, and half of the cube


def compared(*beside):
    """Methods that every study compares, and those named besides, in the order of `found`."""
    return [method for method in all_methods().values() if method.role == "main" or method.name in beside]


def spent(method, resolutions):
    """Values of its knob that a study spends on a method."""
    if method.resolution is None:
        return (None,)
    own = method.orders.values if method.orders else (method.small, method.coarse)
    usual = resolutions.get(method.resolution.knob, (own[0], own[-1]))
    return tuple(resolutions.get(method.name, usual))


def value_of(row):
    """Value of the knob that refines a row's method, not-a-number if there is none."""
    method = all_methods().get(row["name"])
    refined = method.resolution if method else None
    value = row.get(refined.column or refined.knob) if refined else None
    return math.nan if value is None else value


def resolution(row):
    """Resolution of a row, by its method's name, in words; empty if nothing refines the method."""
    value = value_of(row)
    if value != value:
        return ""
    refined = all_methods()[row["name"]].resolution
    return refined.words.format(value / EDGE if refined.metric else value)


def size_of(row):
    """Size of an element of a row, in edges of the cube; not-a-number if nothing refines its method."""
    value = value_of(row)
    if value != value:
        return math.nan
    refined = all_methods()[row["name"]].resolution
    return refined.size(value / EDGE if refined.metric else value)


def at(method, value, seed=0):
    """What a case says of the resolution of a method: its knob and, where elements lie at random, the seed."""
    seeded = {"seed": seed} if method.resolution and method.resolution.seeded else {}
    return method.at(value, EDGE) | seeded


def case(name, **more):
    """Case of one method: its name, what is given here, its module, and what the method fixes."""
    return {"name": name, **more, "method": all_methods()[name].module, **all_methods()[name].knobs}


def exact_ratio(fraction, contrast):
    """Exact effective conductivity of the sphere in a cube over that of the matrix."""
    from references import exact

    return exact.solve(sphere_in_cube(contrast, fraction=fraction)).conductivity / MATRIX


def solve_row(scene, ratio, *, method, **knobs):
    """Row of one solve, or of a formula."""
    if not hasattr(load(method), "solve"):
        return _estimated_row(scene, ratio, load(method).estimate, knobs)
    return solved(scene, ratio, method=method, **knobs)[1]


def solved(scene, ratio, *, method, **knobs):
    """Solve a scene by a method; return its Field and what a row shows."""
    field, cost = measured(load(method).solve, scene, **knobs)
    row = {"k_ratio": field.conductivity / MATRIX, "exact_ratio": ratio}
    row["error_percent"] = 100 * conductivity_error(field, MATRIX * ratio)
    row["inclusion"] = float(sum(field.fractions[1:]))
    row["heat_imbalance"] = None if scene.periodic else abs(heat_balance(field))
    row["packing_cached"] = field.stats.get("cached")
    names = ("packing_s", "tessellation_s", "network_s", "solve_s", "unknowns", "iterations", "residual")
    return field, row | {name: field.stats.get(name) for name in names} | cost


def _estimated_row(scene, ratio, estimate, knobs):
    k, cost = measured(estimate, scene, **knobs)
    error = 100 * value_error(k / MATRIX, ratio)
    return {"k_ratio": k / MATRIX, "exact_ratio": ratio, "error_percent": error, **cost}


def declared(module):
    """The methods that a module declares; none of what is a solver of something else."""
    return [method for method in all_methods().values() if method.module == module]


def small(module):
    """Knobs with which a module's methods cost next to nothing."""
    return next((method.at(method.small, EDGE) for method in declared(module)), {})


def warm_up(method, **knobs):
    """Solve a small scene the same way, so that a row pays for no loading or compiling; keeps nothing on disk."""
    for first in declared(method)[:1]:
        scene = sphere_in_cube(2.0, fraction=0.1, periodic="walls" in first.refuses)
        with tempfile.TemporaryDirectory() as folder, packings_in(folder):
            # A cached packing would leave the packing's kernels unloaded.
            solve_row(scene, 1.0, method=method, **{**knobs, **small(method)})


@contextmanager
def packings_in(folder):
    """Keep packings in another folder for a while."""
    before = os.environ.get("DEMHEAT_CACHE")
    os.environ["DEMHEAT_CACHE"] = str(folder)
    try:
        yield
    finally:
        os.environ.pop("DEMHEAT_CACHE")
        if before is not None:
            os.environ["DEMHEAT_CACHE"] = before
