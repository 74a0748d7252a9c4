"""Solutions that follow from others, of all methods on drawn scenes; docs/invariances.md has all of them."""

import numpy as np
import pytest
from changed_scenes import RELATIONS
from drawn_scenes import COUNT, drawn
from method_scenes import METHODS
from relations import applies, first, limit, second, spread

from demheat.method import PARTICLES, VOXELS

# What is kept when a scene is moved or turned is asked on coarse grids, whatever they miss.
pytestmark = pytest.mark.filterwarnings("ignore:gaps beside inclusions")

# Meshes of many spheres take seconds, and so do equations between their multipoles: as many inclusions as the scenes
# have of which others than packings and voxels are asked here.
FEW = 2


def hand(name):
    """Which scene a method is asked for each relation: as few scenes as that takes, others for each method."""
    method = METHODS[name]
    begin = 17 * list(METHODS).index(name)
    # 7 and 50 have no common divisor: all seeds come, and kinds and loads in turn.
    seeds = [(begin + 7 * k) % COUNT for k in range(COUNT)]
    if method.resolution not in (None, PARTICLES, VOXELS):
        seeds = [seed for seed in seeds if len(drawn(seed).inclusions) <= FEW]
    found, used = {}, []
    for relation in RELATIONS:
        seed = next((seed for seed in used + seeds if applies(name, relation, seed)), None)
        if seed is not None:
            found[relation] = seed
            used += [seed] if seed not in used else []
    return found


# Some CPU-seconds each, and each is another method here but for a rule of its links or voxels, its elements' sides, or,
# bricks and elements, what `test_methods` asks (turned, reversed, scaled): `make test-slow`.
SLOW = ("dem-arithmetic", "dem-mean", "dem-plain", "fem", "fem-straight", "fem-p1", "fem-bricks", "fft-em-plain")
NAMES = [pytest.param(name, marks=pytest.mark.slow) if name in SLOW else name for name in METHODS]


def unknown(method, relation):
    """Parts that nobody asks: what knows the conductivity alone has no others; particles are the same in time alone."""
    aside = {"temperature", "flux"} if method.call == "estimate" else set()
    return aside | (set() if relation == "time" else {"places"})


# What thin layers do to particles without twins is left to chance, but to the same in relations that are exact.
@pytest.mark.filterwarnings("ignore:.*are thin for particles:UserWarning")
@pytest.mark.parametrize("name", NAMES)
def test_relations(name):
    asked, wrong = hand(name), []
    for relation, seed in asked.items():
        found = spread(name, relation, seed)
        for part, value in found._asdict().items():
            if np.isnan(value) and part in unknown(METHODS[name], relation):
                continue
            most = limit(METHODS[name], relation, part)
            print(f"{name}, {relation}, scene {seed}, {part}: {value:.1e}, limit {most:.1e}")
            if not value <= most:
                wrong.append((relation, seed, part, value, most))
    first.cache_clear()
    second.cache_clear()
    assert {"units", "load", "rotation"} <= set(asked) and wrong == []
