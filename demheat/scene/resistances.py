"""What heat meets on its way between two phases: the resistances of the surfaces that it crosses.

A surface belongs to its shape and parts it from what the shape was painted on. Where the surfaces of several shapes lie
on each other, as two layers that touch or a layer that ends where the one around it does, heat crosses all of them.
"""

from collections.abc import Callable

import numpy as np


def between(scene) -> Callable[[np.ndarray, np.ndarray], np.ndarray] | None:
    """Resistance between phases that meet."""
    own = scene.resistances
    if not own.any():
        return None
    parents = scene.parents()

    def resistance(here, there):
        pairs, place = np.unique(np.asarray(here, np.int64) * len(own) + there, return_inverse=True)
        # Surfaces around both are not crossed.
        crossed = [_around(a, parents) ^ _around(b, parents) for a, b in (divmod(p, len(own)) for p in pairs.tolist())]
        return np.array([own[list(each)].sum() for each in crossed])[place]

    return resistance


def joined(scene) -> np.ndarray:
    """Which phases no surface with a resistance parts, (1 + number of inclusions,) int array of equal numbers.

    Each has the number of the innermost such surface around it, 0 outside of all: where two numbers differ, one of the
    surfaces is between.
    """
    own, parents = scene.resistances, scene.parents()
    found = np.arange(len(own))
    # An inclusion comes after the one that it lies in.
    for phase in range(1, len(own)):
        found[phase] = phase if own[phase] > 0 else found[parents[phase]]
    return found


def _around(phase, parents):
    found = set()
    while phase:
        found.add(phase)
        phase = int(parents[phase])
    return found
