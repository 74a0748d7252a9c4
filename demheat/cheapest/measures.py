"""What laws of error and cost read off a scene: a few lengths and numbers, without solving anything."""

import math
from typing import NamedTuple

import numpy as np

from demheat.scene import Scene
from demheat.scene.volumes import coats, extents

# Gap of a lone sphere, over its diameter, beyond which it makes no difference.
WIDEST = 10.0
# Along each axis, by which the volume of a body without an end is found where walls cut it.
POINTS = 24
# A pore changes the flux no more than a body so many times less conducting.
PORE = 1e3


class Measures(NamedTuple):
    """Measures of a scene."""

    edge: float  # m: Of the cube of the box's volume
    smallest: float  # m: Least width of an inclusion, or of what an inclusion in it leaves of it; the edge without any
    narrowest: float  # m: Least width of an inclusion alone
    fraction: float  # Volume of all inclusions over the box's
    # Largest |k_i - k_o| / (k_i + 2 k_o) of an inclusion's conductivity and that around it: how much it disturbs a
    # uniform flux; 0 to 1
    strength: float
    contrast: float  # Largest |ln(k_i / k_o)|, of a pore that of a thousandth
    surface: float  # m2: Of all interfaces
    # searched, asked: m2, of those whose nearest points are searched for, and of those of functions (`Shape.finding`)
    searched: float
    asked: float
    count: int  # Number of inclusions
    count_searched: int
    gap: float  # Least gap between two enclosing balls, or twice that to a wall, over the smaller one's radius
    # drawn, triangles, sharp: Of surfaces of triangles the area, m2, the number of these and of their sharp edges
    drawn: float = 0.0
    triangles: int = 0
    sharp: int = 0


def measures(scene: Scene) -> Measures:
    """Measure a scene."""
    edge, shapes = scene.volume ** (1 / 3), scene.inclusions
    if not shapes:
        return Measures(edge, edge, edge, *[0.0] * 6, 0, 0, WIDEST)
    inner, around = _neighbours(scene)
    # What has no end is at most as wide as the box.
    widths, volumes = np.minimum(extents(scene), edge), np.array([_volume(scene, shape) for shape in shapes])
    outermost = np.array(scene.parents()[1:]) == 0
    # Volume over width: of a layer half its two faces, of a ball a sixth of its surface, of a fibre a quarter.
    faces = np.array([2 if shape.flat else 6 if shape.bounded else 4 for shape in shapes])
    surfaces = faces * volumes / widths
    drawn, triangles, sharp, _ = np.array([shape.drawn for shape in shapes]).T
    # Where the area is known so is how wide the ball or the polyhedron around a ball is that has as much volume to it:
    # bounds are much wider than a knot's tube, or than a gyroid's sheet.
    areas = np.array([_crossed(scene, shape) if shape.finding == "function" else shape.drawn.area for shape in shapes])
    widths = np.where(areas > 0, np.minimum(widths, 6 * volumes / np.maximum(areas, 1e-300)), widths)
    surfaces = np.where(areas > 0, areas, surfaces)
    searched, asked = (np.array([shape.finding == how for shape in shapes]) for how in ("search", "function"))
    return Measures(
        edge=edge,
        smallest=float(min(widths.min(), coats(scene).min())),
        narrowest=float(widths.min()),
        fraction=float(volumes[outermost].sum() / scene.volume),
        strength=float(np.max(np.abs(inner - around) / (inner + 2 * around))),
        contrast=float(np.max(np.abs(_log_ratio(inner, around)))),
        surface=float(surfaces.sum()),
        searched=float(surfaces[searched].sum()),
        asked=float(surfaces[asked].sum()),
        count=len(shapes),
        count_searched=int(searched.sum()),
        gap=_gap(scene),
        drawn=float(drawn.sum()),
        triangles=int(triangles.sum()),
        sharp=int(sharp.sum()),
    )


def _neighbours(scene):
    """Conductivity of each inclusion and of what is around it; bodies of nothing in nothing count as alike."""
    k = scene.mean_conductivities
    if scene.perfect:
        # As what conducts so many times better than the rest.
        k = np.where(np.isinf(k), PORE * k[np.isfinite(k)].max(initial=1e-300), k)
    inner, around = k[1:], k[np.array(scene.parents()[1:])]
    none = (inner == 0) & (around == 0)
    return np.where(none, 1.0, inner), np.where(none, 1.0, around)


def _log_ratio(inner, around):
    """Of conductivities; of a pore, or around a body that nothing around it conducts, that of PORE."""
    none = (inner == 0) | (around == 0)
    return np.where(none, math.log(PORE), np.log(np.where(none, 1.0, inner) / np.where(none, 1.0, around)))


def _volume(scene, shape):
    try:
        return shape.volume_in(scene.size, periodic=scene.periodic)
    except NotImplementedError:
        # A wall cuts it: as much of it lies in the box as of the box around it, exactly so through its middle.
        low, high = shape.bounds()
        if not shape.bounded:
            return scene.volume * float(np.mean(_within(scene, shape, np.zeros(3), np.array(scene.size))))
        inside = np.minimum(high, scene.size) - np.maximum(low, 0.0)
        return shape.volume * float(np.prod(inside / (high - low)))


def _within(scene, shape, low, high):
    """Which points of a grid between two corners lie in a shape, (24, 24, 24) bool array."""
    ticks = [a + (np.arange(POINTS) + 0.5) / POINTS * (b - a) for a, b in zip(low, high, strict=True)]
    points = np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1).reshape(-1, 3)
    return shape.contains(points, period=scene.period).reshape((POINTS,) * 3)


def _crossed(scene, shape):
    """Area of a shape's surface in the box, m2: twice the mean over directions of how often lines of a grid cross it.

    That mean is over three axes here (Crofton's formula): right for a ball, a sixth too much or a third too little for
    planes, where these lean to all axes alike or are across one.
    """
    low, high = shape.bounds()
    if not (scene.periodic and shape.bounded):
        # What crosses a face of a periodic cell goes on at the other one.
        low, high = (np.clip(end, 0.0, scene.size) for end in (low, high))
    inside, step = _within(scene, shape, low, high), (high - low) / POINTS
    crossings = [np.count_nonzero(np.diff(inside, axis=axis)) for axis in range(3)]
    return 2 / 3 * float(sum(count * step.prod() / step[axis] for axis, count in enumerate(crossings)))


def _gap(scene):
    """Of neighbouring spheres, nested ones aside, mirror images in walls or periodic ones included."""
    from scipy.spatial import cKDTree

    parents = scene.parents()[1:]
    outer = [shape for shape, parent in zip(scene.inclusions, parents, strict=True) if parent == 0 and shape.bounded]
    if not outer:
        return WIDEST
    centers, radii = (np.array(part) for part in zip(*(shape.ball() for shape in outer), strict=True))
    # Balls around bounds reach farther than those around triangles.
    radii = np.array([shape.drawn.reach or radius for shape, radius in zip(outer, radii, strict=True)])
    size = np.array(scene.size)
    if not scene.periodic:
        low, high = centers - radii[:, None], size - centers - radii[:, None]
        # A sphere that a wall cuts has its image in itself.
        away = np.where(np.stack([low, high]) > 0, np.stack([low, high]), np.inf).min(axis=(0, 2))
        nearest = float(np.min(2 * away / radii))
    else:
        # A sphere's own nearest image.
        nearest = float(np.min((size.min() - 2 * radii) / radii))
    tree = cKDTree(centers % size if scene.periodic else centers, boxsize=size if scene.periodic else None)
    i, j = tree.query_pairs(min(2.5 * radii.max(), 0.49 * size.min()), output_type="ndarray").T
    apart = np.abs(centers[i] - centers[j])
    if scene.periodic:
        apart = np.minimum(apart % size, -apart % size)
    gaps = np.linalg.norm(apart, axis=1) - radii[i] - radii[j]
    round_ = np.array([shape.kind == "sphere" for shape in outer])
    # Enclosing balls of other bodies overlap where these may be apart.
    told = (gaps > 0) | (round_[i] & round_[j])
    nearest = np.min((gaps / np.minimum(radii[i], radii[j]))[told], initial=nearest)
    return float(np.clip(nearest, 1e-6, WIDEST))
