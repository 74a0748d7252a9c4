"""How fast the errors of each method fall as it is refined: fitted over sizes, never slower than declared."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from demheat import gallery, referee
from references import exact
from studies.harness import methods

# Where the sphere sits in its periodic cell: not where a grid or mesh would treat it better than elsewhere.
PLACES = [(0.47, 0.52, 0.55), (0.07, 0.31, 0.92), (0.63, 0.17, 0.44)]
REFINED = [method for method in methods.all_methods().values() if method.resolution]


@cache
def cell(contrast, place):
    """Scene, exact Field and its values at random points."""
    scene = gallery.sphere_in_cube(contrast, edge=1.0, periodic=True)
    scene = replace(scene, inclusions=[replace(scene.inclusions[0], center=PLACES[place])])
    return scene, exact.solve(scene), np.random.default_rng(place).random((500, 3))


def errors(method, value):
    """Mean errors of conductivity (signed), temperature and flux at a value of the resolution, (3,) float array."""
    found = []
    for k in range(method.orders.repeats):
        scene, right, points = cell(method.orders.contrast, k)
        seed = {"seed": k} if method.resolution.seeded else {}
        field = methods.load(method.module).solve(scene, **method.knobs, **method.at(value), **seed)
        parts = (e(field, right, points).rms for e in (referee.temperature_error, referee.flux_error))
        found.append((referee.conductivity_error(field, right), *parts))
    return np.mean(found, axis=0)


# Errors of these at one size `test_methods` sees; each is another method here but for its links or sides: `test-slow`.
SLOW = ("dem-plain", "fem-straight")
NAMES = [pytest.param(m, marks=pytest.mark.slow) if m.name in SLOW else m for m in REFINED if m.orders]


@pytest.mark.parametrize("method", NAMES, ids=lambda method: method.name)
def test_declared_orders(method):
    sizes = [method.resolution.size(value) for value in method.orders.values]
    rows = np.abs([errors(method, value) for value in method.orders.values])
    fitted = np.polyfit(np.log(sizes), np.log(rows), 1)[0]
    declared = method.orders.conductivity, method.orders.temperature, method.orders.flux
    print(f"{method.name}: orders of conductivity, temperature and flux {fitted}, declared {declared}")
    assert np.all(fitted >= declared), f"orders of conductivity, temperature and flux {fitted}, declared {declared}"


def test_orders_are_declared_or_their_want_is_explained():
    wrong = [m.name for m in REFINED if (m.orders is None) != ("orders" in m.exceptions)]
    assert not wrong, f"methods with neither `orders` nor a reason in `exceptions`, or both: {', '.join(wrong)}"
