"""Where good conductors, or bad ones, nearly meet: gaps that carry much of the heat, or little, which grids may miss.

At ten times the conductivity a missed gap between two spheres was found to cost a tenth of the scene's; at a million
times all of it, since heat takes a short cut.
"""

import numpy as np

# Contrast to what is around, either way, from which on a gap matters.
STRONG = 10.0
# From foot to foot on two surfaces: between round ones a few rounds are near enough to tell.
FEET, ON = 8, 1e-6


def narrows(scene, reach: float, strong: float = STRONG) -> np.ndarray:
    """Which bodies are less than a length from their like, or from a wall, where that matters.

    It does between two that conduct so many times better than what is around both, or both worse; between a good one
    and a held wall, between a bad one and an insulated one, which mirrors it. Of shapes that are no spheres and no
    layers those count that have an end, and whose limits are their own: level sets do not.
    """
    found, parents = np.zeros(len(scene.inclusions), bool), scene.parents()[1:]
    k, around = scene.mean_conductivities[1:], scene.mean_conductivities[parents]
    for alike, good in (((k >= strong * around) & (k > 0), True), ((strong * k <= around) & (around > 0), False)):
        for parent in np.unique(parents[alike]):
            ids = np.flatnonzero(alike & (parents == parent))
            kinds = {i: _kind(scene.inclusions[i]) for i in ids}
            for kind, near in NEAR.items():
                own = np.array([i for i in ids if kinds[i] == kind], int)
                if len(own):
                    shapes = [scene.inclusions[i] for i in own]
                    found[own[near(scene, shapes, reach, _walls(scene, held=good))]] = True
    return found


def _kind(shape):
    if shape.kind in ("sphere", "layer"):
        return shape.kind
    return "other" if shape.bounded and shape.finding != "function" else ""


def _walls(scene, held):
    """Walls with a temperature or surroundings that have one, or the insulated ones: pairs of an axis and a side."""
    if scene.periodic:
        return []
    insulated = [name for name in ("x-", "x+", "y-", "y+", "z-", "z+") if name not in scene.walls]
    return [("xyz".index(name[0]), name[1]) for name in (scene.imposed_temperatures if held else insulated)]


def _near_spheres(scene, spheres, reach, walls):
    from scipy.spatial import cKDTree

    size = np.array(scene.size)
    centers, radii = np.array([s.center for s in spheres]), np.array([s.radius for s in spheres])
    near = np.zeros(len(spheres), bool)
    for axis, side in walls:
        gap = (size[axis] - centers[:, axis] if side == "+" else centers[:, axis]) - radii
        # One that the wall cuts leaves no gap.
        near |= (gap >= 0) & (gap < reach)
    if scene.periodic:
        near |= size.min() - 2 * radii < reach
        centers = centers % size % size
    tree = cKDTree(centers, boxsize=size if scene.periodic else None)
    one, other = tree.query_pairs(2 * radii.max() + reach, output_type="ndarray").T
    apart = centers[one] - centers[other]
    apart -= size * np.round(apart / size) if scene.periodic else 0.0
    close = np.linalg.norm(apart, axis=1) - radii[one] - radii[other] < reach
    near[one[close]] = near[other[close]] = True
    return near


def _near_layers(scene, layers, reach, walls):
    """Layers that have a parent in common lie along one axis."""
    axis = layers[0].axis
    order = np.argsort([layer.start for layer in layers])
    start, stop = np.array([(layers[n].start, layers[n].stop) for n in order]).T
    gap = np.append(start[1:], start[0] + scene.size[axis] if scene.periodic else np.inf) - stop
    close = (gap > 0) & (gap < reach)
    close |= np.roll(close, 1)
    for wall, side in walls:
        if wall == axis:
            gap = scene.size[axis] - stop if side == "+" else start
            close |= (gap > 0) & (gap < reach)
    near = np.zeros(len(layers), bool)
    near[order] = close
    return near


def _near_others(scene, shapes, reach, walls):
    low, high = (np.array(ends) for ends in zip(*(shape.bounds() for shape in shapes), strict=True))
    near = np.zeros(len(shapes), bool)
    for axis, side in walls:
        gap = scene.size[axis] - high[:, axis] if side == "+" else low[:, axis]
        # What lies on a wall, or goes on in the next cell, leaves none.
        near |= (gap > ON * reach) & (gap < reach)
    if scene.periodic:
        gaps = scene.size - (high - low)
        near |= np.any((gaps > ON * reach) & (gaps < reach), axis=1)
    for one, other in zip(*np.triu_indices(len(shapes), 1), strict=True):
        apart = np.abs((low[one] + high[one] - low[other] - high[other]) / 2)
        if scene.periodic:
            apart = np.minimum(apart % scene.size, -apart % scene.size)
        clear = apart - (high[one] - low[one] + high[other] - low[other]) / 2
        # What touches, as boxes along an edge, leaves none.
        if clear.max() < reach and ON * reach < _gap(scene, shapes[one], shapes[other]) < reach:
            near[[one, other]] = True
    return near


def _gap(scene, one, other):
    """Distance between two surfaces, from foot to foot on either, from between them on."""
    x, period = np.array(one.center, float)[None], scene.period
    way = np.array(other.center) - one.center
    x = x + (way - (period * np.round(way / period) if period is not None else 0.0)) / 2
    before = x
    for _ in range(FEET):
        for shape in (one, other):
            before, x = x, x - shape.distance(x, period=period)[:, None] * shape.normal(x, period=period)
    return float(np.linalg.norm(x - before))


NEAR = {"sphere": _near_spheres, "layer": _near_layers, "other": _near_others}
