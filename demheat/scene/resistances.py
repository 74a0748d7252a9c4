"""What heat meets on its way between two phases: the resistances of the surfaces that it crosses.

A surface belongs to its shape and parts it from what the shape was painted on. Where the surfaces of several shapes lie
on each other, as two layers that touch or a layer that ends where the one around it does, heat crosses all of them.
"""

from collections.abc import Callable

import numpy as np

# Of a facet that stands upright on a surface: nothing passes it, and nothing is divided by 0.
LEAST = 1e-9


def between(scene) -> Callable[[np.ndarray, np.ndarray], np.ndarray] | None:
    """Resistance between phases that meet."""
    own = scene.resistances
    if not own.any():
        return None
    parents = scene.parents()

    def resistance(here, there):
        found = np.zeros(len(here))
        for crossed, pairs in _crossed(here, there, parents):
            found[pairs] = own[crossed].sum()
        return found

    return resistance


def on_facets(scene) -> Callable[[np.ndarray, np.ndarray, np.ndarray, np.ndarray], np.ndarray] | None:
    """Resistance between phases that meet on facets, given by a point and a normal, over the surface that each is.

    Facets beside each other end in steps where they do not meet. A step leans, and is as much surface as it covers: its
    area times the cosine between its normal and the surface's. By areas alone there would be too much surface, which
    falls with the distance between twins, not with its square. For heat along the normal of a plane it is exact.
    """
    own = scene.resistances
    if not own.any():
        return None
    parents = scene.parents()

    def resistance(here, there, points, normals):
        found = np.zeros(len(here))
        for crossed, facets in _crossed(here, there, parents):
            for phase in (each for each in crossed if own[each] > 0):
                shape = scene.inclusions[phase - 1]
                found[facets] += own[phase] / _covers(shape, points[facets], normals[facets], scene.period)
        return found

    return resistance


def _crossed(here, there, parents):
    """Of any two phases that meet those whose surfaces part them, and where the two do; surfaces around both do not."""
    pairs, place = np.unique(np.asarray(here, np.int64) * len(parents) + there, return_inverse=True)
    ends = np.cumsum(np.bincount(place, minlength=len(pairs)))[:-1]
    for pair, places in zip(pairs.tolist(), np.split(np.argsort(place, kind="stable"), ends), strict=False):
        one, other = (_around(phase, parents) for phase in divmod(pair, len(parents)))
        yield list(one ^ other), places


def _covers(shape, points, normals, period):
    """How much of a shape's surface facets at points are, over their area, (n,) float array."""
    # On spheres facets are a polyhedron, on planes they lie in these: no steps.
    if shape.fills_ball or shape.flat:
        return np.ones(len(points))
    cosine = np.einsum("ij,ij->i", shape.normal(points, period=period), normals)
    return np.maximum(np.abs(cosine), LEAST)


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
