"""How much of a packing lies in the core of its domain: exact volumes and surfaces of spheres cut by its faces."""

import math
from itertools import product

import numpy as np

from demheat.packing.base import Packing
from demheat.packing.walls import check_margin
from demheat.scene.bodies import ROUND_AXES, from_middle

# Nodes along the axis of a cylinder, per sphere. Largest error of 2000 spheres cut at random, against 1000 nodes: 6e-11
# of a sphere up to half as wide as the core, 8e-5 of wider ones.
NODES = 32


def packing_fraction(packing: Packing, *, margin: float = 0.0) -> float:
    """Sphere volume over volume, in the part of the domain at least `margin` mean radii away from every wall.

    The core of a walled packing is what compares with a periodic one: walls push spheres apart. Spheres are cut by the
    faces of the core exactly (box, ball), or by Gauss-Legendre quadrature with 32 nodes along the axis (cylinder).
    """
    depth = check_margin(packing, margin)
    core = packing.size - 2 * depth * ~packing.periodic
    volume = core_volume(packing, depth)
    axes = list(ROUND_AXES[packing.domain])
    low, high = core_bounds(packing, depth)
    if not axes:
        return float(math.fsum(spheres_in_box(packing.centers, packing.radii, low, high)[0]) / volume)
    distance, reach = from_middle(packing.centers, packing.domain, packing.size), core[axes[0]] / 2
    if packing.domain == "sphere":
        return float(math.fsum(_lens_volumes(distance, packing.radii, reach)) / volume)
    axis = "xyz".index(packing.domain[-1])
    ends = (low[axis] - packing.centers[:, axis], high[axis] - packing.centers[:, axis])
    return float(math.fsum(_spheres_in_cylinder(distance, packing.radii, reach, *ends)) / volume)


def core_volume(packing, depth):
    """Volume of the domain at least so far away from every wall, m^3: the same shape, smaller."""
    return packing._replace(size=packing.size - 2 * depth * ~packing.periodic).volume


def core_bounds(packing, depth):
    """Bounds of the core's box."""
    low = np.where(packing.periodic, -np.inf, depth)
    return low, np.where(packing.periodic, np.inf, packing.size - depth)


def inscribed_box(packing, depth):
    """Bounds of the largest box (along the axes, square across round ones) in the core."""
    axes = list(ROUND_AXES[packing.domain])
    half = packing.size / 2 - depth * ~packing.periodic
    if axes:
        half[axes] /= math.sqrt(len(axes))
    return packing.size / 2 - half, packing.size / 2 + half


def spheres_in_box(centers, radii, low, high):
    """Volume and surface of spheres inside a box along the axes, exactly."""
    lower, upper = (np.clip((bound - centers) / radii[:, None], -1.0, 1.0) for bound in (low, high))
    cut = np.any((lower > -1) | (upper < 1), axis=1)
    share = np.repeat([[4 / 3 * np.pi], [4 * np.pi]], len(radii), axis=1)
    share[:, cut] = 0.0
    # Inclusion and exclusion over the corners: what lies beyond the lower bounds, less what lies beyond the upper ones.
    for corner in product((0, 1), repeat=3):
        faces = [(lower, upper)[side][cut, axis] for axis, side in enumerate(corner)]
        share[:, cut] += (-1) ** sum(corner) * _beyond(faces)
    return share[0] * radii**3, share[1] * radii**2


def _beyond(faces):
    """Volume and surface of the unit ball beyond three planes x > a, y > b, z > c of any sign, (2, n) float array."""
    total = np.zeros((2, len(faces[0])))
    # A plane at a < 0 leaves both halves less what lies beyond the mirrored plane.
    for halved in product((False, True), repeat=3):
        signs = [2.0 * (a < 0) if h else np.where(a < 0, -1.0, 1.0) for a, h in zip(faces, halved, strict=True)]
        planes = [np.zeros_like(a) if h else np.abs(a) for a, h in zip(faces, halved, strict=True)]
        total += np.prod(signs, axis=0) * _octant(*planes)
    return total


def _octant(a, b, c):
    """Volume and surface of the unit ball beyond x > a, y > b, z > c, all >= 0, (2, n) float array.

    Gauss and Bonnet give the spherical triangle from its corners and the geodesic curvature of its sides; the
    divergence theorem gives the volume from the faces, seen from the centre.
    """
    met = a * a + b * b + c * c < 1
    planes = [np.where(met, x, 0.0) for x in (a, b, c)]
    surface, cone = np.full_like(a, 2 * np.pi), np.zeros_like(a)
    for k in range(3):
        x, y, z = (planes[(k + i) % 3] for i in range(3))
        surface -= np.arccos(np.clip(-x * y / np.sqrt((1 - x * x) * (1 - y * y)), -1.0, 1.0))
        # On the face x = a: the arc runs from (far_y, z) to (y, far_z).
        far_y, far_z = (np.sqrt(np.maximum(1 - x * x - w * w, 0.0)) for w in (z, y))
        angle = np.arctan2(far_z, y) - np.arctan2(z, far_y)
        surface -= x * angle
        cone += x * ((1 - x * x) * angle - y * (far_z - z) - z * (far_y - y)) / 2
    return np.where(met, [(surface - cone) / 3, surface], 0.0)


def _lens_volumes(distance, radii, reach):
    """Volume of spheres inside a ball of radius `reach`, from the distance of the centres, (n,) float array, m^3."""
    least = 4 / 3 * np.pi * np.minimum(radii, reach) ** 3
    d = np.where(distance > 0, distance, 1.0)
    lens = np.pi * (reach + radii - d) ** 2 * (d * d + 2 * d * (radii + reach) - 3 * (radii - reach) ** 2) / (12 * d)
    return np.where(distance >= radii + reach, 0.0, np.where(distance <= np.abs(reach - radii), least, lens))


def _spheres_in_cylinder(distance, radii, reach, low, high):
    """Volume of spheres inside a cylinder, from their distance to its axis and that of its ends, (n,) float array."""
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    low, high = (np.clip(end, -radii, radii) for end in (low, high))
    whole = np.pi * (radii**2 * (high - low) - (high**3 - low**3) / 3)
    inner = distance < reach
    # Discs are cut for |z| < edge only. There the smaller part of each is integrated over t, z = edge sin(t): it is
    # smooth in t, while over z it ends like a power of 3/2.
    edge = np.sqrt(np.maximum(radii**2 - (reach - distance) ** 2, 0.0))
    start, stop = (np.arcsin(np.clip(end / np.where(edge > 0, edge, 1.0), -1.0, 1.0))[:, None] for end in (low, high))
    t = (start + stop) / 2 + (stop - start) / 2 * nodes
    disc = np.sqrt(np.maximum(radii[:, None] ** 2 - (edge[:, None] * np.sin(t)) ** 2, 0.0))
    areas = _lens_areas(distance[:, None], disc, reach)
    areas = np.where(inner[:, None], np.pi * disc**2 - areas, areas) * np.cos(t)
    part = np.einsum("ij,j->i", areas, weights) * edge * (stop - start)[:, 0] / 2
    return np.where(inner, whole - part, part)


def _lens_areas(distance, disc, reach):
    """Area shared by a disc and a disc of radius `reach` at a distance, float array, m^2."""
    cut = (distance < disc + reach) & (distance > np.abs(reach - disc))
    d, r = np.where(cut, distance, 1.0), np.where(cut, disc, 1.0)
    big = np.where(cut, reach, 1.0)
    small_angle = np.arccos(np.clip((d * d + r * r - big * big) / (2 * d * r), -1.0, 1.0))
    big_angle = np.arccos(np.clip((d * d + big * big - r * r) / (2 * d * big), -1.0, 1.0))
    kite = np.sqrt(np.maximum((-d + r + big) * (d + r - big) * (d - r + big) * (d + r + big), 0.0)) / 2
    lens = r * r * small_angle + big * big * big_angle - kite
    whole = np.where(distance >= disc + reach, 0.0, np.pi * np.minimum(disc, reach) ** 2)
    return np.where(cut, lens, whole)
