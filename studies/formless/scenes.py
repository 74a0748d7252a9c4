"""The scenes: periodic cells of one edge in which surfaces without formulas part two phases."""

import math
from functools import cache

import numpy as np

from demheat import Image, LevelSet, Scene, SurfaceMesh
from demheat.gallery import EDGE, HADDAD, scaled

ALONG_X = (100.0, 0.0, 0.0)
# Points along an edge by which the level of a fraction is found: right to some 1e-5 of the cell.
TICKS = 128
# Waves of the random field, and squares of their numbers along the edges; the seed of what is drawn.
WAVES, SQUARES, SEED = 12, (5, 6), 1
# Of the spheres that overlap, in edges.
RADIUS = 0.15
# Of the knot, in edges: its ring, how far it winds about that, its tube; parts along and around.
KNOT = {"ring": 0.26, "winding": 0.11, "tube": 0.05, "along": 192, "around": 16}
BLOCKS = 4
# Points along the trefoil of the round tube: its distances are right to 1e-5 of an edge.
ROUND = 3000


def primitive(x, y, z):
    """Schwarz's P, by its nodes."""
    return np.cos(x) + np.cos(y) + np.cos(z)


def diamond(x, y, z):
    """Schwarz's D, by its nodes."""
    (a, b, c), (d, e, f) = np.sin((x, y, z)), np.cos((x, y, z))
    return a * b * c + a * e * f + d * b * f + d * e * c


def gyroid(x, y, z):
    """Schoen's G, by its nodes."""
    (a, b, c), (d, e, f) = np.sin((x, y, z)), np.cos((x, y, z))
    return a * e + b * f + c * d


@cache
def _waves():
    """Wave numbers, none the opposite of another, and phases."""
    rng, n = np.random.default_rng(SEED), np.arange(-2, 3)
    every = np.stack(np.meshgrid(n, n, n, indexing="ij"), -1).reshape(-1, 3)
    every = every[np.isin(np.sum(every**2, axis=1), SQUARES)]
    every = every[: len(every) // 2]
    return rng.permutation(every)[:WAVES], rng.uniform(0, 2 * np.pi, WAVES)


def waves(x, y, z):
    """A sum of waves of random directions and phases, much like a Gaussian field."""
    numbers, phases = _waves()
    total = np.zeros(len(x))
    for (a, b, c), phase in zip(numbers, phases, strict=True):
        total += np.cos(a * x + b * y + c * z + phase)
    return total


FUNCTIONS = {"primitive": primitive, "diamond": diamond, "gyroid": gyroid, "random field": waves}


@cache
def _level(part, fraction):
    """Level below which a function takes a fraction of its period."""
    ticks = 2 * np.pi * (np.arange(TICKS) + 0.5) / TICKS
    values = [FUNCTIONS[part](np.full(TICKS**2, x), np.repeat(ticks, TICKS), np.tile(ticks, TICKS)) for x in ticks]
    return float(np.quantile(np.concatenate(values), fraction))


def _below(part, fraction):
    level, function = _level(part, fraction), FUNCTIONS[part]
    return lambda points: function(*(2 * np.pi / EDGE * points).T) - level


def _overlapping(fraction):
    """Distance to spheres at random places, as many as fill that much of a large cell in the mean."""
    from scipy.spatial import cKDTree

    count = round(-math.log(1 - fraction) / (4 / 3 * math.pi * RADIUS**3))
    tree = cKDTree(np.random.default_rng(SEED).random((count, 3)), boxsize=1.0)
    return lambda points: tree.query(points / EDGE % 1.0)[0] - RADIUS


def _trefoil(parts):
    """Angles of so many points along a trefoil, and these about its middle, in edges."""
    t = 2 * np.pi * np.arange(parts) / parts
    out = KNOT["ring"] + KNOT["winding"] * np.cos(3 * t)
    return t, np.column_stack([out * np.cos(2 * t), out * np.sin(2 * t), KNOT["winding"] * np.sin(3 * t)])


def knot():
    """Vertices, in edges, and triangles of a tube along a trefoil."""
    t, line = _trefoil(KNOT["along"])
    along = np.roll(line, -1, axis=0) - np.roll(line, 1, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    # Across the line, away from the ring it winds about: a frame that closes.
    middle = KNOT["ring"] * np.column_stack([np.cos(2 * t), np.sin(2 * t), np.zeros_like(t)])
    one = line - middle
    one -= np.einsum("ij,ij->i", one, along)[:, None] * along
    one /= np.linalg.norm(one, axis=1, keepdims=True)
    angle = 2 * np.pi * np.arange(KNOT["around"]) / KNOT["around"]
    around = np.cos(angle)[:, None] * one[:, None] + np.sin(angle)[:, None] * np.cross(along, one)[:, None]
    points = (line[:, None] + KNOT["tube"] * around).reshape(-1, 3) + 0.5
    here = np.arange(len(points)).reshape(len(t), -1)
    there, beside = np.roll(here, -1, axis=0), np.roll(here, -1, axis=1)
    beyond = np.roll(there, -1, axis=1)
    halves = np.stack([here, there, beyond], -1), np.stack([here, beyond, beside], -1)
    return points, np.concatenate([half.reshape(-1, 3) for half in halves])


def _round():
    """Distance to a round tube along the trefoil, of the cross section of that of triangles."""
    from scipy.spatial import cKDTree

    tree, n = cKDTree(_trefoil(ROUND)[1] + 0.5), KNOT["around"]
    tube = KNOT["tube"] * math.sqrt(n / (2 * math.pi) * math.sin(2 * math.pi / n))
    return lambda points: tree.query(points / EDGE)[0] - tube


def made(part, contrast, fraction):
    """The scene of a part."""
    material = scaled(HADDAD, contrast)
    if part.endswith("checkerboard"):
        labels = np.indices((BLOCKS,) * 3).sum(axis=0) % 2
        if part.startswith("random"):
            labels = np.random.default_rng(SEED).permutation(labels.ravel()).reshape(labels.shape)
        return Scene.of_image(Image(labels, EDGE / BLOCKS, {0: HADDAD, 1: material}), gradient=ALONG_X)
    if part == "knot":
        points, triangles = knot()
        shape = SurfaceMesh(EDGE * points, triangles, material)
    else:
        function = _overlapping(fraction) if part == "overlapping spheres" else _below(part, fraction)
        shape = LevelSet(function, ((0.0,) * 3, (EDGE,) * 3), material, periodic=True)
    return Scene((EDGE,) * 3, HADDAD, [shape], gradient=ALONG_X)


def walked(part, contrast, fraction):
    """The same scene for walkers, who take longer to ask triangles than to walk: the knot is a round tube there."""
    if part != "knot":
        return made(part, contrast, fraction)
    shape = LevelSet(_round(), ((0.0,) * 3, (EDGE,) * 3), scaled(HADDAD, contrast))
    return Scene((EDGE,) * 3, HADDAD, [shape], gradient=ALONG_X)
