"""Packings whose radical facets lie on the interfaces of a scene.

Twins, one on either side of an interface and mirrored in its tangent plane, share that plane as their facet. With
weights delta^2 + c (delta the offset from the interface, c one constant) the facets of all twins of a sphere are
exactly its circumscribed polyhedron, whatever the offsets: no facet crosses the interface.
"""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from demheat.packing.base import Packing, make_packing
from demheat.packing.interfaces import nearest_gap, surfaces_near, surfaces_of
from demheat.scene import Scene

# In mean radii of the packing. Twins at half a radius make cells centred between the interface and the next layer,
# which is what the two-point flux needs where the interface is curved; found best of offsets .3 to .95 and spacings 1.2
# to 2.1 on the centred sphere at four contrasts (at offset .8 and spacing 1.8 the error is six times larger).
OFFSET = 0.5
SPACING = 1.6
# A particle gives way when its centre is nearer to the interface than the twins beside it plus this.
CLEARANCE = 0.4
# Nearer to an obstacle than this the two cells of a pair would be slivers: the pair is left out.
LEAST_OFFSET = 0.05
# Weight of a twin beyond its squared offset: a twin at OFFSET weighs as much as a mean particle.
EXCESS = 1.0 - OFFSET**2
# In a gap of width g the twins of the other side must not come nearer to an interface than its own: with offsets g/4
# and points COVER spacings away at most that needs a spacing below g/(sqrt(2) COVER) = 0.88 g.
GAP_SPACING = 0.85
LEAST_SPACING = 4 * LEAST_OFFSET
# Points thinned to this part of their spacing cover the surface at least as densely as an even pattern does.
THINNING = 0.75
# Every point of an interface lies within this many spacings of a twin: a triangular pattern would need 0.58, Fibonacci
# points need up to 0.77 near their poles.
COVER = 0.8
# In mean radii: interfaces farther apart change neither spacings nor offsets.
REACH = 1.01 * max(SPACING / GAP_SPACING, 4.0 * OFFSET)


class _Twins(NamedTuple):
    points: np.ndarray  # (k, 3) touch points on the interface, m
    normals: np.ndarray  # (k, 3) unit vectors
    offsets: np.ndarray  # (k,) m


def conform(packing: Packing, scene: Scene, *, seed: int = 0) -> Packing:
    """Replace the particles near every interface of a scene by mirrored twins.

    Parameters
    ----------
    packing : Packing
        Of the scene's box.
    scene : Scene
    seed : int
        Turns the point pattern of each sphere.

    Returns
    -------
    Packing
        Radii are square roots of the radical weights (up to a constant added to all). Twins stand closer in narrow
        gaps. Where two interfaces are nearer to each other than a fifth of a mean radius, or an interface to a wall
        than a tenth, twins do not fit and facets there cross the interface; provenance["pairs_left_out"] counts them.

    Raises
    ------
    NotImplementedError
        If there is an inclusion of a shape whose surface is not known; see `demheat.packing.interfaces.surfaces`.
    """
    if not scene.inclusions:
        return packing._replace(provenance={**packing.provenance, "twins": 0, "pairs_left_out": 0})
    radius = packing.radii.mean()
    rng = np.random.default_rng([seed, 71])
    surfaces = surfaces_of(scene)
    parts, left_out = [], 0
    for surface in surfaces:
        others = surfaces_near(surface, surfaces, REACH * radius)
        points, normals = _pattern(surface, others, radius, rng)
        points = surface.touched(points, normals)
        offsets = _room(points, normals, surface, others, scene, OFFSET * radius)
        fits = offsets >= LEAST_OFFSET * radius
        left_out += int(np.sum(_gap(points[~fits], normals[~fits], surface, others) < LEAST_SPACING * radius))
        parts.append(_Twins(points[fits], normals[fits], offsets[fits]))
    twins = _Twins(*(np.concatenate(column) for column in zip(*parts, strict=True)))
    centers, weights, good = _twin_points(twins, scene, radius)
    twins = _Twins(*(column[good] for column in twins))
    near = nearest_gap(packing.centers, surfaces)
    keep = near > _cleared(packing, twins, radius, near)
    kept = np.minimum(packing.radii**2, near**2 - _margin(radius))[keep]
    # Radical facets do not change when all weights grow alike: make the least one positive.
    raised = np.concatenate([kept, weights]) + max(0.0, 0.01 * radius**2 - kept.min(initial=np.inf))
    provenance = {**packing.provenance, "twins": len(centers), "pairs_left_out": left_out}
    return make_packing(
        np.concatenate([packing.centers[keep], centers]), np.sqrt(raised), packing.size, packing.periodic, provenance
    )


def _pattern(surface, surfaces, radius, rng):
    """Points in the box and normals on a surface, closer where another interface or a wall is near."""
    points, normals = _inside(surface, *surface.pattern(SPACING * radius, rng))
    spacing = _spacing(points, normals, surface, surfaces, radius)
    coarse = spacing >= SPACING * radius
    if coarse.all():
        return points, normals
    fine, fine_normals = _inside(surface, *surface.pattern(0.8 * LEAST_SPACING * radius, rng))
    wanted = _spacing(fine, fine_normals, surface, surfaces, radius)
    narrow = np.flatnonzero(wanted < SPACING * radius)
    chosen = narrow[_thinned(fine[narrow], THINNING * wanted[narrow], points[coarse])]
    return np.concatenate([points[coarse], fine[chosen]]), np.concatenate([normals[coarse], fine_normals[chosen]])


def _inside(surface, points, normals):
    """The points that lie in the box, where it has walls."""
    if surface.scene.periodic:
        return points, normals
    good = np.all((points > 0) & (points < surface.scene.size), axis=1)
    return points[good], normals[good]


def _spacing(points, normals, surface, surfaces, radius):
    """Distance between twins at points of a surface: no more than the gap's width asks, see GAP_SPACING."""
    return np.clip(GAP_SPACING * _gap(points, normals, surface, surfaces), LEAST_SPACING * radius, SPACING * radius)


def _gap(points, normals, surface, surfaces):
    """Width of the gap to the nearest other interface, or to the mirror image in a wall that faces this one."""
    gap = np.full(len(points), np.inf)
    for other in surfaces:
        np.minimum(gap, other.gap(points, skip_self=other is surface), out=gap)
    # A wall that cuts the interface, rather than faces it, leaves no gap.
    return np.minimum(gap, 2.0 * _way_to_wall(points, normals, surface.scene, facing=0.9))


def _way_to_wall(points, normals, scene, *, facing=0.0):
    """Distance along the normal, either way, to the nearest wall whose own normal is that close to it (cosine)."""
    if scene.periodic:
        return np.full(len(points), np.inf)
    size, way = np.array(scene.size), []
    for direction in (normals, -normals):
        height = np.where(direction > 0, size - points, points)
        faced = np.abs(direction) > facing
        way.append(np.divide(height, np.abs(direction), out=np.full_like(height, np.inf), where=faced).min(axis=1))
    return np.minimum(*way)


def _thinned(points, least, taken):
    """Choose points that keep their least distance from each other and from those taken, closest-set first."""
    free = np.ones(len(points), dtype=bool)
    if len(taken):
        free = cKDTree(taken).query(points)[0] >= least
    tree, chosen = cKDTree(points), []
    for p in np.argsort(least, kind="stable"):
        if free[p]:
            chosen.append(p)
            free[tree.query_ball_point(points[p], least[p])] = False
    return np.array(chosen, dtype=int)


def _margin(radius):
    """What a particle's weight must stay below its squared distance to an interface so that no facet of it reaches it.

    On the interface a twin at lateral distance t has the power t^2 - EXCESS R^2, a particle at distance D and weight w
    at least D^2 - w; t is at most COVER spacings.
    """
    return ((COVER * SPACING) ** 2 - EXCESS) * radius**2


def _room(points, normals, surface, surfaces, scene, most):
    """Largest offset that leaves each twin its own place: a half of the way to a wall, a quarter to an interface."""
    room = np.full(len(points), min(most, 0.5 * surface.depth))
    for other in surfaces:
        room = np.minimum(room, 0.25 * other.gap(points, skip_self=other is surface))
    room = np.minimum(room, 0.5 * _way_to_wall(points, normals, scene))
    return room


def _twin_points(twins, scene, radius):
    """Both sides of each pair that lies in the box and in two phases: centres, weights, and the pairs kept."""
    shift = twins.offsets[:, None] * twins.normals
    inner, outer = twins.points - shift, twins.points + shift
    good = scene.phase_at(inner) != scene.phase_at(outer)
    if not scene.periodic:
        margin = 0.3 * twins.offsets[:, None]
        for side in (inner, outer):
            good &= np.all((side > margin) & (side < scene.size - margin), axis=1)
    weights = twins.offsets[good] ** 2 + EXCESS * radius**2
    return np.concatenate([inner[good], outer[good]]), np.tile(weights, 2), good


def _cleared(packing, twins, radius, near):
    """Distance from the interfaces within which each particle gives way to the twins beside it."""
    cleared = np.full(len(near), (OFFSET + CLEARANCE) * radius)
    close = np.flatnonzero(near < cleared)
    if len(close) and len(twins.points):
        box = packing.size if packing.periodic.all() else None
        tree = cKDTree(twins.points % packing.size if box is not None else twins.points, boxsize=box)
        _, nearest = tree.query(packing.centers[close])
        cleared[close] = twins.offsets[nearest] + CLEARANCE * radius
    return cleared
