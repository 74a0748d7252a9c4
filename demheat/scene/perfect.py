"""Perfect conductors: what stands for them in numbers, which of them touch, and which join two temperatures.

What touches without a resistance has one temperature, however small the contact: between perfect conductors the heat
across a gap rises without bound as it closes.
"""

from dataclasses import fields, replace

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order

from demheat.scene.shapes.base import TOUCH

INFINITE = "perfect conductors join two temperatures: the effective conductivity is infinite"

# Conductivity that stands for infinity, of the best of the rest: half of the digits are left for what differs in a body
# of it, half of them for the flux beside it.
GOOD = 1e8
# From foot to foot on two surfaces, to where they meet: faces do in the first rounds, if at all.
FEET = 50


def as_good(scene):
    """The scene with `GOOD` times the conductivity of the rest in place of infinity."""
    if not scene.perfect:
        return scene
    k = scene.mean_conductivities
    good = GOOD * (float(k[np.isfinite(k)].max(initial=0.0)) or 1.0)
    return recast(scene, lambda each: min(each, good))


def recast(scene, change):
    """The scene with other conductivities where materials conduct alike all round."""
    inclusions = [_shape_as(each, change) for each in scene.inclusions]
    return replace(scene, matrix=_as(scene.matrix, change), inclusions=inclusions)


def _as(material, change):
    if not material.isotropic or (new := change(material.conductivity)) == material.conductivity:
        return material
    return replace(material, conductivity=new)


def _shape_as(shape, change):
    changed = {"material": _as(shape.material, change)}
    if changed["material"] is shape.material:
        return shape
    if "shapes" in {field.name for field in fields(shape)}:
        changed["shapes"] = [_shape_as(each, change) for each in shape.shapes]
    return replace(shape, **changed)


def touching_spheres(scene) -> tuple[int, int] | None:
    """Places of two perfect spheres that touch, or of one that touches a held wall, twice; None if all are apart."""
    found = contacts(scene)
    return found[0] if found else None


def contacts(scene) -> list[tuple[int, int]]:
    """All pairs as `touching_spheres` has them; a ValueError if what touches joins two temperatures."""
    inclusions = enumerate(scene.inclusions)
    ids = [n for n, s in inclusions if s.kind == "sphere" and s.material.perfect and s.resistance == 0]
    ids = np.array(ids, int)
    if not len(ids):
        return []
    centers, radii = (np.array([getattr(scene.inclusions[n], name) for n in ids]) for name in ("center", "radius"))
    one, two, shift = _pairs(centers, radii, scene.period)
    walls = _walls(scene, centers, radii)
    _check_apart(len(ids), one, two, shift, walls, scene)
    # One that a wall halves is its own image there.
    met = [int(ids[sphere]) for sphere, _, halved in walls if not halved]
    return [*zip(ids[one].tolist(), ids[two].tolist(), strict=True), *zip(met, met, strict=True)]


def touch(scene, one: int, two: int, x) -> bool:
    """Whether two perfect phases touch: one lies in the other, or their surfaces meet where they are near a point."""
    parents = scene.parents()
    if parents[max(one, two)] == min(one, two):
        return True
    shapes = [scene.inclusions[phase - 1] for phase in (one, two)]
    if all(shape.kind == "sphere" for shape in shapes):
        return (min(one, two) - 1, max(one, two) - 1) in contacts(scene)
    x = np.asarray(x, float)[None]
    for _ in range(FEET):
        for shape in shapes:
            x = x - shape.distance(x, period=scene.period)[:, None] * shape.normal(x, period=scene.period)
    return bool(abs(shapes[0].distance(x, period=scene.period)[0]) <= TOUCH * max(scene.size))


def _pairs(centers, radii, period):
    """Spheres that touch, and by how many cells the second is shifted: two (n,) and an (n, 3) int array."""
    from scipy.spatial import cKDTree

    own, shift, reach = np.arange(len(radii)), np.zeros((len(radii), 3), int), 2 * radii.max() * (1 + TOUCH)
    if period is not None:
        turns = np.floor(centers / period).astype(int)
        inside = centers - turns * period
        cells = np.stack(np.meshgrid(*[np.arange(-1, 2)] * 3, indexing="ij"), axis=-1).reshape(-1, 1, 3)
        near = np.all((inside + cells * period >= -reach) & (inside + cells * period <= period + reach), axis=2)
        cell, own = np.nonzero(near)
        # Cells are those of the spheres as they are given.
        shift = cells[cell, 0] - turns[own]
    places = centers[own] + (shift * period if period is not None else 0.0)
    at = centers - (turns * period if period is not None else 0.0)
    found = cKDTree(places).query_ball_point(at, reach)
    one, other = np.repeat(np.arange(len(radii)), [len(each) for each in found]), np.concatenate(found).astype(int)
    two = own[other]
    back = shift[other] + (turns[one] if period is not None else 0)
    apart = np.linalg.norm(places[other] - at[one], axis=1)
    touch = (apart <= (radii[one] + radii[two]) * (1 + TOUCH)) & ((one < two) | ((one == two) & back.any(axis=1)))
    # Not one in the other.
    touch &= apart > np.abs(radii[one] - radii[two]) * (1 + TOUCH)
    return one[touch], two[touch], back[touch]


def _walls(scene, centers, radii):
    """Spheres that meet a wall, its temperature, and whether it goes through their middle."""
    found = []
    for name, value in scene.wall_temperatures.items():
        axis = "xyz".index(name[0])
        away = centers[:, axis] if name[1] == "-" else scene.size[axis] - centers[:, axis]
        halved = np.abs(away) <= TOUCH * radii
        found += [(int(n), value, halved[n]) for n in np.flatnonzero(away <= radii * (1 + TOUCH))]
    return found


def _check_apart(count, one, two, shift, walls, scene):
    """Raise ValueError if a body of touching spheres has two temperatures."""
    graph = coo_array((np.ones(len(one)), (one, two)), shape=(count, count)).tocsr()
    graph = graph + graph.T
    steps = {}
    for a, b, step in zip(one.tolist(), two.tolist(), shift, strict=True):
        steps[a, b], steps[b, a] = step, -step
    place, body, open_ = np.zeros((count, 3), int), np.arange(count), np.diff(graph.indptr) > 0
    for start in np.flatnonzero(open_).tolist():
        if not open_[start]:
            continue
        order, before = breadth_first_order(graph, start, directed=False)
        body[order], open_[order] = start, False
        for each in order[1:].tolist():
            place[each] = place[before[each]] + steps[int(before[each]), each]
    held = {}
    for sphere, value, _ in walls:
        held.setdefault(int(body[sphere]), set()).add(value)
    drop = scene.gradient if scene.periodic else (0.0, 0.0, 0.0)
    rises = (place[one] + shift - place[two]) * scene.size @ np.array(drop)
    if any(len(values) > 1 for values in held.values()) or np.any(rises != 0):
        raise ValueError(INFINITE)
