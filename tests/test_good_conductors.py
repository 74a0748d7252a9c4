"""Conductors a trillion times as good cost as many iterations as those a hundred times as good, to a factor of two."""

import pytest
from spared import slow_but

from demheat import Material, Scene, Sphere, gallery, solve
from references import fem

PLACES = {
    "one": [((0.5, 0.5, 0.5), 1 / 3)],
    "chain": [(((n + 0.5) / 4, 0.5, 0.5), 1 / 8) for n in (0, 1, 2)],
}


def places(name):
    if name != "83":
        return PLACES[name]
    return [(each.center, each.radius) for each in gallery.random_dispersion(83, fraction=0.2, edge=1.0).inclusions]


WAYS = {"dem": lambda scene: solve(scene, particles=4000), "fem": lambda scene: fem.solve(scene, size=0.15)}


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("resistance", [0.0, 0.05])
# Elements refuse spheres that touch, and take a minute for 83.
@pytest.mark.parametrize(
    ("way", "name"),
    slow_but({("dem", "one"), ("dem", "chain")}, [("dem", "one"), ("dem", "83"), ("dem", "chain"), ("fem", "one")]),
)
def test_iterations_are_blind_to_contrast(way, name, resistance):
    def iterations(contrast):
        spheres = [Sphere(c, r, Material(contrast), resistance=resistance) for c, r in places(name)]
        scene = Scene((1.0, 1.0, 1.0), Material(1.0), spheres, gradient=(1.0, 0.0, 0.0))
        return WAYS[way](scene).stats["iterations"]

    # Twice was asked for; of elements 1.4 times was found, of particles 1.3.
    assert iterations(1e12) <= 2 * iterations(100.0)
