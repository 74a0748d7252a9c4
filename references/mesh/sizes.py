"""How fine a mesh must be where: small spheres, thin layers and shells, narrow gaps. Geometry only, no mesher."""

import math
from itertools import pairwise, product
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from demheat.runtime.limits import free_memory
from demheat.scene.inputs import finite, whole
from references.mesh.solids import sized

# How much longer edges may be one metre farther from a feature, in metres.
GROWTH = 0.3
# Cube root of the box volume over the default size: about 1e5 nodes at either order,
EDGES = {1: 50, 2: 26}
# or if that is more, this times the cube root of the number of spheres (found: 0.07 % on 83 of them at order 2).
EDGES_APART = 8
MOST_CELLS = 3e7
# Tetrahedra of a uniform mesh over its volume and the size's cube; found: 4.2 to 4.6.
CELLS = 4.5
# Of memory at most, with the equations and what solves them, per tetrahedron of each order.
BYTES = {1: 1500, 2: 3500}
# Of the longest edge. Closer surfaces touch: the cusp between them has no valid elements (2e-6 meshes, 0 does not).
NARROWEST = 1e-6
# Of the longest edge: radius of a sphere. gmsh misplaces elements in spheres of 1e-6, and is lost in much smaller ones.
SMALLEST = 3e-6
_WHY = "the cusp between touching surfaces has no valid elements; leave a gap or let them overlap clearly"
_SMALLER = "; spheres of 0.99 times their radii do (radius_factor = 0.99 of a file of them)"
# Of the longest edge. Coordinates closer than this are one plane: rounding of what the user typed.
SAME = 1e-10
# Edge length on a small sphere over its radius; in a gap, to a distance of width = sqrt(gap radius), over that width;
# in a shell over its thickness.
ON_SPHERE, IN_GAP, IN_SHELL = 0.33, 0.5, 3.0
# Of the smaller sphere's radius. What is wider is no gap: the sphere's own elements grow to the size that it asks for.
FAR = 6.0
# Of the longest edge: images of spheres beyond say nothing, however coarse the mesh.
BEYOND = 0.25


class Sizes(NamedTuple):
    """Wanted edge lengths; away from each feature they grow to `size`."""

    size: float  # m: Everywhere else
    balls: np.ndarray  # (k, 5) float array, m: Centre, radius and the edge length inside
    shells: np.ndarray  # (k, 6) float array, m: Centre, inner radius, outer radius and the edge length between them
    slabs: np.ndarray  # (k, 4) float array: Axis, start, stop (m) and the edge length between them (m)


def checked_size(scene, size, order):
    """Longest edge for a scene."""
    whole("order", order, "1 or 2", lambda v: v in (1, 2))
    if size is None:
        bounded = sum(not shape.flat for shape in scene.inclusions)
        return scene.volume ** (1 / 3) / max(EDGES[order], EDGES_APART * bounded ** (1 / 3))
    finite("size", size, "a finite number > 0 m", lambda v: v > 0)
    least = (CELLS * math.prod(scene.size) / MOST_CELLS) ** (1 / 3)
    if size < least:
        raise ValueError(f"size = {size!r} m: more than {MOST_CELLS:.0e} tetrahedra; must be >= {least:.3g} m")
    # Longer edges than the box's do not exist.
    return min(float(size), max(scene.size))


def wanted_sizes(scene, size, *, coarser=1.0):
    """Edge lengths for a scene."""
    centers, radii = _spheres(scene, size)
    planes = _planes(scene)
    outer, inner, gaps = _pairs(scene, centers, radii, size)
    gaps = np.vstack([gaps, _box_gaps(scene, centers, radii, planes)])
    width = np.sqrt(gaps[:, 3] * gaps[:, 4])
    balls = np.vstack(
        [
            np.column_stack([centers, radii, ON_SPHERE * radii]),
            np.column_stack([gaps[:, :3], width, IN_GAP * width]),
            sized(scene, size / coarser, planes, (ON_SPHERE, IN_GAP, FAR, NARROWEST)),
        ]
    )
    thickness = radii[outer] - radii[inner]
    shells = np.column_stack([centers[inner], radii[inner], radii[outer], IN_SHELL * thickness])
    slabs = np.array([(axis, a, b, b - a) for axis in range(3) for a, b in pairwise(planes[axis])])
    for each in (balls, shells, slabs):
        each[:, -1] *= coarser
    return Sizes(size, *(t[t[:, -1] < size] for t in (balls, shells, slabs)))


def check_cost(sizes: Sizes, box, order: int) -> float:
    """Refuse a mesh that is hopeless, before it is begun."""
    box = np.array(box)
    cells, most = estimated_cells(sizes, box), min(MOST_CELLS, free_memory() / BYTES[order])
    if cells > most:
        least, need = sizes.size * (cells / most) ** (1 / 3), cells * BYTES[order] / 2**30
        remedy = f"must be >= {least:.2g} m{', or take order = 1' if order == 2 else ''}"
        # Layers and shells keep their own size, whatever is asked for elsewhere.
        shells = np.diff(sizes.shells[:, 3:5], axis=1)[:, 0]
        for what, thick, counts in (
            ("layers", sizes.slabs[:, 3], _layer_cells(sizes, box)),
            ("shells", shells, _shell_cells(sizes, box)),
        ):
            if (number := float(np.sum(counts))) > most:
                remedy = f"{what} down to {thick.min():.2g} m thick take {number:.1e} of them, too thin for FEM"
        raise ValueError(
            f"size = {sizes.size:.3g} m: about {cells:.1e} tetrahedra, which with their equations take {need:.0f} GiB; "
            f"here {most:.1e} are possible: {remedy}"
        )
    return cells


def _spheres(scene, size):
    """Centres and radii of the spheres, and of all images in a periodic cell, less than one size from the box."""
    spheres = [shape for shape in scene.inclusions if shape.fills_ball]
    centers = np.array([s.center for s in spheres]).reshape(-1, 3)
    radii = np.array([s.radius for s in spheres])
    box = np.array(scene.size)
    for i in np.flatnonzero(radii < SMALLEST * max(box)):
        raise NotImplementedError(
            f"sphere of radius {radii[i]:.3g} m at {centers[i]}: too small for a mesh of a box of {max(box):.3g} m"
        )
    if scene.periodic:
        shifts = np.array(list(product((0, -1, 1), repeat=3))) * box
        centers = (centers % box + shifts[:, None]).reshape(-1, 3)
        radii = np.tile(radii, len(shifts))
    outside = np.maximum(0, np.maximum(-centers, centers - box))
    near = np.linalg.norm(outside, axis=1) < radii + min(size, BEYOND * max(box))
    return centers[near], radii[near]


def _planes(scene):
    """Coordinates of the faces and layer planes along each axis."""
    planes, longest = [], max(scene.size)
    for axis, length in enumerate(scene.size):
        layers = [shape for shape in scene.inclusions if shape.flat and shape.axis == axis]
        for x in layers:
            if x.stop - x.start < NARROWEST * longest:
                raise NotImplementedError(f"layer along axis {axis} from {x.start} to {x.stop}: too thin to mesh")
        values = np.clip([0.0, length, *(x.start for x in layers), *(x.stop for x in layers)], 0.0, length)
        values = np.unique(values)
        gaps = np.diff(values, prepend=-np.inf)
        if np.any((gaps > SAME * longest) & (gaps < NARROWEST * longest)):
            raise NotImplementedError(f"layer planes along axis {axis} at {values}: too close to mesh between them")
        planes.append(values[gaps > SAME * longest])
    return planes


def _pairs(scene, centers, radii, size):
    """Nested pairs (outer, inner), and rows (point, gap, smaller radius) for pairs of spheres that are near."""
    outer, inner = _near(centers, radii, size)
    offset = centers[inner] - centers[outer]
    distance = np.linalg.norm(offset, axis=1)
    inside = distance < radii[outer]
    gap = np.where(inside, radii[outer] - radii[inner] - distance, distance - radii[outer] - radii[inner])
    for i in np.flatnonzero(gap < NARROWEST * max(scene.size)):
        # One within another would come closer to its surface.
        more = "" if inside[i] else _SMALLER
        raise NotImplementedError(f"spheres at {centers[outer[i]]} and {centers[inner[i]]} touch: {_WHY}{more}")
    # Concentric spheres have no narrowest point; their shell counts instead.
    off = distance > 0
    along = (radii[outer] + np.where(inside, -1, 1) * gap / 2)[off] / distance[off]
    points = centers[outer[off]] + along[:, None] * offset[off]
    rows = np.column_stack([points, gap[off], radii[inner[off]]])
    return outer[inside], inner[inside], rows[gap[off] < FAR * radii[inner[off]]]


def _near(centers, radii, size):
    """Pairs (outer or larger, inner or smaller) of spheres between which elements may have to be small."""
    if not len(radii):
        return np.zeros(0, int), np.zeros(0, int)
    # A gap counts while sqrt(gap radius) is below size / IN_GAP and gap below FAR radii, of the smaller sphere: it is
    # then below their common bound, whatever that radius.
    widest = np.minimum(FAR * radii, math.sqrt(FAR) * size / IN_GAP)
    near = cKDTree(centers).query_ball_point(centers, 2 * radii + widest, return_sorted=True)
    one = np.repeat(np.arange(len(radii)), [len(others) for others in near])
    other = np.concatenate(near).astype(int)
    # Each pair once, found from its larger sphere, the first of two that are equal.
    kept = (radii[one] > radii[other]) | ((radii[one] == radii[other]) & (one < other))
    return one[kept], other[kept]


def _box_gaps(scene, centers, radii, planes):
    """Rows (point, gap, radius) of spheres against planes and edges of the box, stopping short of them or cut."""
    rows, box = [np.zeros((0, 5))], np.array(scene.size)
    for axes in ((0,), (1,), (2,), (0, 1), (0, 2), (1, 2)):
        for values in product(*(planes[a] if len(axes) == 1 else (0.0, box[a]) for a in axes)):
            points = centers.copy()
            points[:, axes] = values
            gap = np.abs(np.linalg.norm(points - centers, axis=1) - radii)
            faces_it = np.all((points >= 0) & (points <= box), axis=1)
            for i in np.flatnonzero(faces_it & (gap < NARROWEST * max(scene.size))):
                raise NotImplementedError(f"sphere at {centers[i]} touches a plane or edge at {points[i]}: {_WHY}")
            rows.append(np.column_stack([points, gap, radii])[faces_it & (gap < FAR * radii)])
    return np.vstack(rows)


def unit_lengths(sizes, scale):
    """The same sizes in another unit."""
    slabs = sizes.slabs / np.array([1.0, scale, scale, scale])
    return sizes._replace(size=sizes.size / scale, balls=sizes.balls / scale, shells=sizes.shells / scale, slabs=slabs)


def estimated_cells(sizes: Sizes, box) -> float:
    """Number of tetrahedra of a mesh, from what is asked of it; found: within a factor of 2.

    Sizes beyond a quarter of the box make the same mesh, of which up to six times as many are expected: where spheres
    are near each other, fine regions overlap.
    """
    cells = CELLS * float(np.prod(box)) / sizes.size**3
    middle = sizes.balls[:, :3]
    here = np.all((middle >= 0) & (middle <= box), axis=1)
    radius, h = sizes.balls[here, 3], sizes.balls[here, 4]
    cells += CELLS * float(np.sum(4 / 3 * math.pi * (radius / h) ** 3))
    return cells + float(np.sum(_layer_cells(sizes, box))) + float(np.sum(_shell_cells(sizes, box)))


def _layer_cells(sizes, box):
    """Tetrahedra of each thin layer, and on both sides of it until edges have grown to the size; found: within 1.5."""
    axis, edge = sizes.slabs[:, 0].astype(int), sizes.slabs[:, 3]
    beside = (edge**-2 - sizes.size**-2) / GROWTH
    return CELLS * np.prod(box) / np.asarray(box)[axis] * (edge**-2 + beside)


def _shell_cells(sizes, box):
    """Tetrahedra of each thin shell in the box, and on both sides of it; found: 0.8 times as many."""
    middle = sizes.shells[:, :3]
    inner, outer, edge = sizes.shells[np.all((middle >= 0) & (middle <= box), axis=1), 3:].T
    beside = (edge**-2 - sizes.size**-2) / GROWTH
    return CELLS * math.pi * (inner + outer) ** 2 * ((outer - inner) / edge**3 + beside)
