"""The methods that the studies compare, by name, and one solve of one scene by one of them as a row.

A method is the name of its module and what it fixes; a case adds the scene and the resolution.
"""

from __future__ import annotations

import math
import os
import tempfile
from contextlib import contextmanager
from importlib import import_module
from importlib.util import find_spec

from demheat.gallery import EDGE, HADDAD, sphere_in_cube
from demheat.referee import conductivity_error, heat_balance, value_error
from studies.harness.cost import measured

MATRIX = HADDAD.conductivity
THIRD, HALF = 4 * math.pi / 81, 0.5  # volume fractions of the two sphere scenes: radius L/3, and half of the cube

# Packages whose modules are the methods: rows keep a method's name, so that its files may move.
HOMES = ("references", "demheat")

METHODS = {
    "dem": {"method": "dem", "law": "laguerre", "conforming": True, "interface": "harmonic"},
    "dem-plain": {"method": "dem", "law": "laguerre", "conforming": False, "interface": "harmonic"},
    "dem-mean": {"method": "dem", "law": "laguerre", "conforming": False, "interface": "arithmetic"},
    "dem-calibrated": {"method": "dem", "law": "calibrated", "conforming": False, "interface": "harmonic"},
    "dem-arithmetic": {"method": "dem", "law": "calibrated", "conforming": False, "interface": "arithmetic"},
    "fem": {"method": "fem", "order": 2, "curved": True},
    "fem-straight": {"method": "fem", "order": 2, "curved": False},
    "fem-p1": {"method": "fem", "order": 1, "curved": False},
    "fft": {"method": "fft", "scheme": "cg", "rule": "laminate"},
    "fft-plain": {"method": "fft", "scheme": "cg", "rule": "plain"},
    "fft-em": {"method": "fft", "scheme": "eyre-milton", "rule": "laminate"},
    "fft-em-plain": {"method": "fft", "scheme": "eyre-milton", "rule": "plain"},
    "maxwell": {"method": "bounds"},
    "exact": {"method": "exact"},
}
# What a warm-up solves: the same code at a size that costs next to nothing.
SMALL = {
    "dem": {"particles": 1000, "seed": 99},
    "fem": {"size": EDGE / 4},
    "fft": {"voxels": 16},
}


def path_of(method):
    """Path of a method's module by its name, the last part of it; empty if there is no such module."""
    paths = (f"{home}.{method}" for home in HOMES)
    return next((path for path in paths if method and find_spec(path)), "")


def load(method):
    """Module of a method by its name, as "fem".

    Raises
    ------
    ValueError
        If there is no such method.
    """
    if not path_of(method):
        raise ValueError(f"method = {method!r}: must be a module of {' or '.join(HOMES)}")
    return import_module(path_of(method))


def case(name, **more):
    """Case of one method: its name, what is given here, and what the method fixes."""
    return {"name": name, **more, **METHODS[name]}


def exact_ratio(fraction, contrast):
    """Exact effective conductivity of the sphere in a cube over that of the matrix."""
    from references import exact

    return exact.solve(sphere_in_cube(contrast, fraction=fraction)).conductivity / MATRIX


def solve_row(scene, ratio, *, method, **knobs):
    """Row of one solve, or of Maxwell's formula. Arguments as `solved`."""
    if method == "bounds":
        return _maxwell_row(scene, ratio)
    return solved(scene, ratio, method=method, **knobs)[1]


def solved(scene, ratio, *, method, **knobs):
    """Solve a scene by a method; return its Field and what a row shows.

    Parameters
    ----------
    scene : Scene
    ratio : float
        Exact effective conductivity over that of the matrix.
    method : str
        Name of its module.
    knobs : keywords of its `solve`

    Returns
    -------
    field : Field
    row : dict
        `k_ratio`, `error_percent` (relative to exact), `inclusion` (its discrete volume fraction), `heat_imbalance`
        (heat entering minus leaving over heat passing), statistics and cost of the solve.
    """
    field, cost = measured(load(method).solve, scene, **knobs)
    row = {"k_ratio": field.conductivity / MATRIX, "exact_ratio": ratio}
    row["error_percent"] = 100 * conductivity_error(field, MATRIX * ratio)
    row["inclusion"] = float(sum(field.fractions[1:]))
    row["heat_imbalance"] = None if scene.periodic else abs(heat_balance(field))
    row["packing_cached"] = field.stats.get("cached")
    names = ("packing_s", "tessellation_s", "network_s", "solve_s", "unknowns", "iterations", "residual")
    return field, row | {name: field.stats.get(name) for name in names} | cost


def _maxwell_row(scene, ratio):
    from references.bounds import maxwell

    sphere = scene.inclusions[0]
    fraction = 4 / 3 * math.pi * sphere.radius**3 / scene.volume
    found, cost = measured(maxwell, MATRIX, sphere.material.conductivity, fraction)
    found = float(found) / MATRIX
    return {"k_ratio": found, "exact_ratio": ratio, "error_percent": 100 * value_error(found, ratio), **cost}


def warm_up(method, **knobs):
    """Solve a small scene the same way, so that a row pays for no loading or compiling; keeps nothing on disk."""
    if method not in SMALL:
        return
    with tempfile.TemporaryDirectory() as folder, packings_in(folder):
        # A cached packing would leave the packing's kernels unloaded.
        load(method).solve(sphere_in_cube(2.0, fraction=0.1), **{**knobs, **SMALL[method]})


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
