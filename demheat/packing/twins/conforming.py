"""Packings whose radical facets lie on the interfaces of a scene.

Twins, one on either side of an interface and mirrored in its tangent plane, share that plane as their facet. With
weights delta^2 + c (delta the offset from the interface, c one constant) the facets of all twins of a sphere are
exactly its circumscribed polyhedron, whatever the offsets: no facet crosses the interface.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from demheat.packing.base import Packing, sorted_packing
from demheat.packing.gate import check_packing
from demheat.packing.twins.gaps import Interfaces
from demheat.packing.twins.patterns import LEAST_OFFSET, LEAST_SPACING, SPACING, Tally, patterns
from demheat.runtime.progress import stage
from demheat.scene import Scene, check_scene

# In mean radii R of the packing. On a flat interface twins stand OFFSET from it. On one whose principal curvatures sum
# to K they stand BEND R K nearer, though not below half of OFFSET. A fit, not derived: on one sphere and 27 in order,
# contrasts .01, .05 and 10, and on unequal ones, one value takes most of the error away at 8000 and 27 000 particles.
OFFSET, BEND = 0.5, 0.43
# Weight of a twin beyond its squared offset: a twin at OFFSET weighs as much as a mean particle.
EXCESS = 1.0 - OFFSET**2
# A gap holds no particle where it is narrower than NARROW mean radii, by LESS R K less at a bent surface: twins' cells
# reach to its middle, and they stand in the middle of those, at a quarter of the gap. For a particle in the middle of a
# gap of width w the weights leave a cell beside flat interfaces if w (w - 2 OFFSET R) / 4 > 1.57 R^2: from 3.1 R on.
# NARROW and LESS were found on 83 spheres, one that nearly meets its images, and four dense dispersions.
NARROW, LESS = 2.9, 0.7
# Twins nearer to a wall than this part of their offset are left out.
NEAR_WALL = 0.3
# Of a mean radius: offsets in columns of twins, whose cells are prisms, may be as small as rounding allows, and two
# surfaces' twins that are nearer to each other than this are one.
LEAST_COLUMN, ONE = 1e-6, 1e-9
# Twins are nearer to interfaces than so many mean radii, those in columns and of very few facets apart.
AWAY = 0.25 * NARROW + 0.05
# In a gap, over its width: as `demheat.Laguerre` has it.
GAP_SPACING = 0.85
# Every point of an interface lies within this many spacings of a twin: a triangular pattern would need 0.58, Fibonacci
# points need up to 0.77 near their poles.
COVER = 0.8
# Of a mean radius: how far beside a point normals are compared.
STEP = 0.1
# Twins for each particle, at most. A sphere of radius s among particles of radius a has 10 (s / a)^2 twins in place of
# (s / a)^3 particles or so; many more say that the mean radius is not the distance between the particles.
MOST_TWINS = 300


class _Twins(NamedTuple):
    points: np.ndarray  # (k, 3) touch points on the interface, m
    normals: np.ndarray  # (k, 3) unit vectors
    offsets: np.ndarray  # (k, 2) m, against the normal and along it
    reach: np.ndarray  # (k, 2) m, how far their cells go from the interface
    weights: np.ndarray  # (k, 2) m2
    away: np.ndarray  # (k,) m, from the interface at most


class Part(NamedTuple):
    """What is known of the whole where a packing is a part of it."""

    # radius, largest: m: Mean radius of the whole packing, and its largest
    radius: float
    largest: float
    # callable (n, 3) float array, m -> (n,) bool array: Which points belong to the part: twins elsewhere are left out.
    # Where particles near an interface give way is right some three mean radii within the part's edges
    holds: Callable


class Conformed(NamedTuple):
    """A packing with twins, and where its particles come from."""

    packing: Packing
    origin: np.ndarray  # (n,) int array: Number of each particle in the packing that was given; -1 of twins
    alone: np.ndarray  # (n,) bool array: Which of them no twin can have a facet with


def conform(
    packing: Packing, scene: Scene, *, seed: int = 0, gap_spacing: float = GAP_SPACING, part: Part | None = None
) -> Packing:
    """Replace the particles near every interface of a scene by mirrored twins."""
    return conformed(packing, scene, seed=seed, gap_spacing=gap_spacing, part=part).packing


def conformed(
    packing: Packing,
    scene: Scene,
    *,
    seed: int = 0,
    gap_spacing: float = GAP_SPACING,
    part: Part | None = None,
    farthest: float = np.inf,
) -> Conformed:
    """The same, and what became of the particles; no place of a cell without twins is farther than that from its own.

    That length, m, says which cells are beyond the reach of twins: none, if it is infinite.
    """
    check_packing(packing)
    check_scene(scene)
    if not scene.inclusions:
        none = dict.fromkeys(("twins", "even_twins", "pairs_left_out", "shells"), 0)
        packing = packing._replace(provenance={**packing.provenance, **none})
        return Conformed(packing, np.arange(packing.number), np.ones(packing.number, dtype=bool))
    if part is None:
        part = Part(packing.radii.mean(), packing.radii.max(), lambda points: np.ones(len(points), dtype=bool))
        _check_number(packing, scene, part.radius)
    radius = part.radius
    columns = {"close": SPACING / GAP_SPACING * radius, "least": LEAST_SPACING * radius}
    columns["closer"] = gap_spacing / GAP_SPACING
    interfaces = Interfaces(scene, _reach(part, gap_spacing), **columns)
    # Farther than any other gap is looked for, to tell which cells twins do not reach.
    wide = interfaces
    if np.isfinite(farthest):
        wide = Interfaces(scene, max(interfaces.reach, _beyond(farthest, radius)), **columns)
    tally = Tally()
    twins, number, left_out = _twins_on(interfaces, part, seed, tally, gap_spacing)
    centers, weights = np.concatenate(_sides(twins)), twins.weights.T.ravel()
    if interfaces.stacks.members:
        centers, weights = _once(packing, centers, weights, radius)
    near = wide.gap(packing.centers)
    keep = near > _cleared(packing, twins, radius, near)
    kept = np.minimum(packing.radii**2, near**2 - margin(radius))[keep]
    # Radical facets do not change when all weights grow alike: make the least one positive.
    raised = np.concatenate([kept, weights]) + max(0.0, 0.01 * radius**2 - kept.min(initial=np.inf))
    counts = {"twins": number, "even_twins": tally.even, "pairs_left_out": left_out}
    counts["least_gap"] = LEAST_SPACING * float(radius)
    counts["shells"] = int(np.count_nonzero(np.isfinite(interfaces.stacks.spacing)))
    provenance = packing.provenance | counts
    centers = np.concatenate([packing.centers[keep], centers])
    made, order = sorted_packing(centers, np.sqrt(raised), packing.size, packing.periodic, provenance)
    origin, alone = np.full(len(centers), -1), np.zeros(len(centers), dtype=bool)
    origin[: len(kept)] = np.flatnonzero(keep)
    alone[: len(kept)] = _alone(twins, farthest, np.where(np.isinf(near), wide.reach, near)[keep], radius)
    return Conformed(made, origin[order], alone[order])


def _alone(twins, farthest, near, radius):
    """Which of the particles so near to interfaces at least have cells that no twin reaches."""
    heavier = max(0.0, twins.weights.max(initial=0.0) - radius**2)
    return near > _reached(farthest, heavier, twins.away.max(initial=0.0))


def _beyond(farthest, radius):
    """The same where twins are as heavy and as far away as they mostly are at most."""
    return _reached(farthest, (AWAY**2 + EXCESS - 1.0) * radius**2, AWAY * radius)


def _reached(farthest, heavier, away):
    """How far from an interface cells may be reached by twins that are so much heavier and so far away from it."""
    return farthest + np.sqrt(farthest**2 + heavier) + away


def _check_number(packing, scene, radius):
    """Refuse packings whose mean radius is far below the distance between their particles, before anything is made."""
    # Surfaces that fill their bounds, a sphere's to within a factor of two.
    twins = 2 * float(np.sum(faces(scene) / (SPACING * radius) ** 2))
    if twins > MOST_TWINS * packing.number:
        raise ValueError(
            f"packing: of mean radius {radius:.3g} m, by which interfaces would have some {twins:.2g} twins for "
            f"{packing.number} particles; must have radii less unequal, or be denser; or conforming=False"
        )


def faces(scene: Scene) -> np.ndarray:
    """Area of the faces of each inclusion's bounds, at most the box's, (inclusions,) float array, m2."""
    lows, highs = zip(*(shape.bounds() for shape in scene.inclusions), strict=True)
    x, y, z = np.minimum(np.array(highs) - np.array(lows), scene.size).T
    return 2 * (x * y + y * z + z * x)


def _reach(part, gap_spacing):
    """Gaps that are wider than this change nothing, m."""
    # Of spacings and offsets, whose points lie a little inside of their surfaces; of particles that give way; and of
    # those whose weights are limited.
    apart = max(SPACING / gap_spacing, NARROW) + 0.02
    weighty = np.sqrt(part.largest**2 + margin(part.radius))
    return 1.001 * max(apart * part.radius, weighty)


def _twins_on(interfaces, part, seed, tally, gap_spacing):
    """Pairs that fit on all surfaces and belong to the part; of the whole the twins, and the pairs that do not fit."""
    parts, number, left_out = [_Twins(*map(np.empty, ((0, 3), (0, 3), (0, 2), (0, 2), (0, 2), (0,))))], 0, 0
    radius = part.radius
    with stage("twins") as done:
        for points, normals, own in patterns(interfaces, radius, seed, tally, gap_spacing):
            done((own.max(initial=-1) + 1) / len(interfaces))
            facets = interfaces.touched(points, normals, own)
            lift, points = np.linalg.norm(points - facets, axis=1), facets
            offsets = _offsets(points, normals, own, interfaces, radius)
            offsets = _in_columns(offsets, lift, points, normals, own, interfaces, radius)
            apart = interfaces.stacks.apart[own]
            fits = np.all(offsets >= np.where(np.isfinite(apart), LEAST_COLUMN, LEAST_OFFSET) * radius, axis=1)
            width = interfaces.width(points[~fits], normals[~fits], own[~fits])
            left_out += int(np.sum(width < LEAST_SPACING * radius))
            reach = np.minimum(2.0 * OFFSET * radius, np.where(np.isfinite(apart), 0.5 * apart, 2.0 * offsets))
            weights = offsets**2 + EXCESS * radius**2 + interfaces.stacks.rise[own, None]
            away = offsets.max(axis=1) + lift
            twins = _Twins(*(column[fits] for column in (points, normals, offsets, reach, weights, away)))
            good = _in_place(twins, interfaces.scene)
            number += 2 * int(good.sum())
            good &= part.holds(twins.points)
            parts.append(_Twins(*(column[good] for column in twins)))
    return _Twins(*(np.concatenate(column) for column in zip(*parts, strict=True))), number, left_out


def margin(radius: float) -> float:
    """What a particle's weight must stay below its squared distance to an interface so that no facet of it reaches it.

    On the interface a twin at lateral distance t has the power t^2 - EXCESS R^2, a particle at distance D and weight w
    at least D^2 - w; t is at most COVER spacings. So t^2 less EXCESS R^2 is enough; with EXCESS R^2 more instead cells
    of twins are better centred: on seven dispersions not used to find that (a fraction of .15 to .5, contrasts .05 to
    100, radii in a ratio of 1 and 4, 200 particles a sphere) errors of .31 to 1.53 % became .04 to .81 %, all smaller.
    """
    return ((COVER * SPACING) ** 2 + EXCESS) * radius**2


def _offsets(points, normals, own, interfaces, radius):
    """Offset of both twins: by the bend of their surface, or in the middle of the half of a gap that is their own."""
    bent = np.abs(interfaces.bend(points, normals, own, STEP * radius)) * radius
    offset = np.maximum(OFFSET - BEND * bent, 0.5 * OFFSET) * radius
    width = interfaces.width(points, normals, own)
    offset = np.where(width < (NARROW - LESS * bent) * radius, 0.25 * width, offset)
    # Of what does not face it, a wall that cuts it or the surface's own other side, a twin stays off as far.
    offset = np.minimum(offset, 0.25 * interfaces.gap(points, own))
    offset = np.minimum(offset, 0.5 * interfaces.way_to_wall(points, normals, own))
    return np.minimum(offset, 0.5 * interfaces.depth(own))


def _in_columns(offsets, lift, points, normals, own, interfaces, radius):
    """Offsets against the normal and along it, (k, 2): those in columns by what is between their surfaces."""
    apart, offsets = interfaces.stacks.apart[own], np.stack([offsets, offsets], axis=1)
    here = np.isfinite(apart)
    if here.any():
        # Polyhedra about one centre are all as much smaller than their spheres.
        smaller = 1.0 - 0.5 * lift * interfaces.bend(points, normals, own, STEP * radius)
        offsets[here] = (interfaces.stacks.share[own] * apart * smaller[:, None])[here]
    return offsets


def _sides(twins):
    """Centres of the twins within the interfaces and of those outside, two (k, 3) float arrays."""
    inwards, outwards = twins.offsets.T[:, :, None] * twins.normals
    return twins.points - inwards, twins.points + outwards


def _once(packing, centers, weights, radius):
    """Centres and weights of twins without those that are also another surface's."""
    box = np.where(packing.periodic, packing.size, 0.0)
    places = np.where(packing.periodic, centers % packing.size % packing.size, centers)
    pairs = cKDTree(places, boxsize=box).query_pairs(ONE * radius, output_type="ndarray")
    return np.delete(centers, pairs[:, 1], axis=0), np.delete(weights, pairs[:, 1])


def _in_place(twins, scene):
    """Pairs of which each lies in the box, and the two in two phases."""
    inner, outer = _sides(twins)
    good = scene.phase_at(inner) != scene.phase_at(outer)
    if not scene.periodic:
        for side, offset in zip((inner, outer), twins.offsets.T, strict=True):
            near = NEAR_WALL * offset[:, None]
            good &= np.all((side > near) & (side < scene.size - near), axis=1)
    return good


def _cleared(packing, twins, radius, near):
    """Distance from the interfaces within which each particle gives way to the twins beside it: that of their cells."""
    cleared = np.full(len(near), 2.0 * OFFSET * radius)
    close = np.flatnonzero(near < cleared)
    if len(close) and len(twins.points):
        box = packing.size if packing.periodic.all() else None
        tree = cKDTree(twins.points % packing.size if box is not None else twins.points, boxsize=box)
        _, nearest = tree.query(packing.centers[close])
        way = packing.centers[close] - twins.points[nearest]
        way -= packing.size * np.round(way / packing.size) if box is not None else 0.0
        outside = np.einsum("ij,ij->i", way, twins.normals[nearest]) > 0
        cleared[close] = twins.reach[nearest, outside.astype(int)]
    return cleared
