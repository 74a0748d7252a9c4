"""Heat sources as powers of the cells of a network, conserved to rounding at each time and smooth in time.

A moving cylinder heats each cell by the overlap with the sphere of the cell's volume at its centre; all overlaps are
then scaled by one factor so that they add up to what the cylinder has in common with the body.
"""

import math

import numpy as np
from scipy.spatial import cKDTree

from demheat.scene import ROUND_AXES, MovingCylinder, UniformSource
from demheat.scene.crossing import touching

# A rim may stick out by so much of the body: rounding of the time at which it arrives at the edge.
EDGE_SLACK = 1e-9
# Slices of a sphere by Gauss-Legendre nodes in the latitude: they find the part of it in a cylinder to 1e-3, or to 6e-3
# where the cylinder is thinner than the sphere.
LATITUDES, SLICES = np.polynomial.legendre.leggauss(8)


def source_power(scene, centers, volumes):
    """The power of a scene's sources in each cell, as a function of time."""
    centers, volumes = np.asarray(centers, dtype=float), np.asarray(volumes, dtype=float)
    steady, moving = np.zeros(len(volumes)), []
    for number, source in enumerate(scene.sources):
        if isinstance(source, UniformSource):
            # Volumes that carry the capacity need not fill the body: the Platonic law's do not.
            steady += source.power_density * scene.volume / volumes.sum() * volumes
        else:
            _check_through(scene, source)
            moving.append(_deposit(scene, number, centers, volumes))
    if not scene.sources:
        return None

    def power(time):
        """Power of each cell at a time in seconds, (n,) float array, W."""
        given = steady.copy()
        for deposit in moving:
            cells, share = deposit(time)
            given[cells] += share
        return given

    return power


def total_power(scene, time):
    """Power that all sources of a scene give to the body."""
    total = 0.0
    for number, source in enumerate(scene.sources):
        if isinstance(source, UniformSource):
            total += source.power_density * scene.volume
        else:
            _check_through(scene, source)
            total += _common_power(scene, number, source, time)
    return total


def lost_power(scene, time):
    """Power of clipped sources that falls outside of the body."""
    lost = 0.0
    for number, source in enumerate(scene.sources):
        if not isinstance(source, UniformSource):
            _check_through(scene, source)
            lost += _full_power(scene, source) - _common_power(scene, number, source, time)
    return lost


def check_sources(scene, stop):
    """Raise ValueError if a source that is not to be clipped leaves the body before a time in seconds."""
    for number, source in enumerate(scene.sources):
        if isinstance(source, UniformSource):
            continue
        _check_through(scene, source)
        if source.clip:
            continue
        # The body is convex and the motion straight: inside at both ends is inside all the time.
        if _clearance(scene, source, 0.0) < 0 or _clearance(scene, source, stop) < 0:
            _refuse(scene, number, source, _leaving(scene, source, stop))


def transits(scene):
    """When the moving cylinders of a scene meet and leave its body, and how fast they are."""
    found = []
    for source in scene.sources:
        if isinstance(source, MovingCylinder):
            _check_through(scene, source)
            between = touching(source, scene.size, scene.domain)
            speed = math.hypot(*source.velocity)
            if between:
                found.append((*between, source.diameter / speed if speed > 0 else math.inf))
    return found


def _check_through(scene, source):
    if scene.domain not in ("box", "cylinder-" + "xyz"[source.axis]):
        raise NotImplementedError(
            f"MovingCylinder along {'xyz'[source.axis]} in a {scene.domain}: only through a box or along the axis of a "
            "round cylinder; elsewhere the length of its way through the body changes across it"
        )


def _across(source):
    return [axis for axis in range(3) if axis != source.axis]


def _clearance(scene, source, time):
    """Distance from the rim to the nearest wall, negative outside, m; with a hair of room."""
    place, sides = source.position(time), np.array(scene.size)[_across(source)]
    room = EDGE_SLACK * sides.max() - source.diameter / 2
    if ROUND_AXES[scene.domain]:
        return sides[0] / 2 - math.hypot(*(place - sides / 2)) + room
    return min(place.min(), (sides - place).min()) + room


def _leaving(scene, source, stop):
    """Time at which the rim reaches a wall, between 0 and `stop`, by halving; 0 if it is outside then, s."""
    inside, outside = 0.0, float(stop)
    if _clearance(scene, source, 0.0) < 0:
        return 0.0
    for _ in range(60):
        middle = (inside + outside) / 2
        if _clearance(scene, source, middle) < 0:
            outside = middle
        else:
            inside = middle
    return inside


def _refuse(scene, number, source, time):
    names = " and ".join("xyz"[axis] for axis in _across(source))
    raise ValueError(
        f"Scene.sources[{number}]: the rim of the MovingCylinder is at the wall of the {scene.domain}, or beyond, at "
        f"{time:.6g} s, with its axis at {names} = {source.position(time).tolist()} m; must stay inside, or have "
        "clip=True"
    )


def _full_power(scene, source):
    return source.power_density * math.pi / 4 * source.diameter**2 * scene.size[source.axis]


def _common_power(scene, number, source, time):
    """Power of the part of a moving cylinder that lies in the body, W."""
    if _clearance(scene, source, time) >= 0:
        return _full_power(scene, source)
    if not source.clip:
        _refuse(scene, number, source, time)
    place, radius, sides = source.position(time), source.diameter / 2, np.array(scene.size)[_across(source)]
    if ROUND_AXES[scene.domain]:
        area = float(_lens(math.hypot(*(place - sides / 2)), radius, sides[0] / 2))
    else:
        area = _disc_in_rectangle(radius, -place, sides - place)
    return source.power_density * area * scene.size[source.axis]


def _deposit(scene, number, centers, volumes):
    """Function of time that gives the cells a moving cylinder heats, and their powers."""
    source = scene.sources[number]
    points, radii = centers[:, _across(source)], np.cbrt(3 * volumes / (4 * np.pi))
    tree, reach = cKDTree(points), source.diameter / 2 + radii.max()

    def deposit(time):
        total, place = _common_power(scene, number, source, time), source.position(time)
        cells = np.array(tree.query_ball_point(place, reach, return_sorted=True), dtype=np.int64)
        apart = np.linalg.norm(points[cells] - place, axis=1)
        share = volumes[cells] * _overlap(apart, radii[cells], source.diameter / 2)
        if total <= 0.0:
            return cells, np.zeros(len(cells))
        if not share.sum() > 0.0:
            # A source thinner than the gaps between the spheres, or one whose edge only comes in.
            return np.array([tree.query(place)[1]]), np.array([total])
        return cells, share * (total / share.sum())

    return deposit


def _overlap(apart, radii, width):
    """Part of each sphere inside an endless cylinder of radius `width`, its axis so far from the centre."""
    cut = np.abs(apart - width) < radii
    part = np.where(apart < width, 1.0, 0.0)
    angle = np.pi / 4 * (LATITUDES + 1.0)
    # Slices across the axis at z = r sin(angle) are discs of radius r cos(angle).
    disc = radii[cut, None] * np.cos(angle)
    weight = SLICES * np.cos(angle)
    inside = _lens(apart[cut, None], disc, width) @ weight
    part[cut] = inside / (np.pi * disc**2 @ weight)
    return part


def _lens(apart, a, b):
    """Area that two circles of radii a and b have in common, centres so far apart."""
    d = np.maximum(apart, 1e-12 * (a + b))
    at_a = np.arccos(np.clip((d**2 + a**2 - b**2) / (2 * d * a), -1.0, 1.0))
    at_b = np.arccos(np.clip((d**2 + b**2 - a**2) / (2 * d * b), -1.0, 1.0))
    kite = np.sqrt(np.maximum((a + b - d) * (d + a - b) * (d - a + b) * (d + a + b), 0.0))
    return a**2 * at_a + b**2 * at_b - kite / 2


def _disc_in_rectangle(radius, low, high):
    """Area of a disc around the origin within low <= x <= high, both (2,)."""
    corner = [[_disc_below(radius, x, y) for y in (low[1], high[1])] for x in (low[0], high[0])]
    return max(0.0, corner[1][1] - corner[0][1] - corner[1][0] + corner[0][0])


def _disc_below(radius, x, y):
    """Area of a disc around the origin where the coordinates are below x and below y."""
    x, y = (min(max(t / radius, -1.0), 1.0) for t in (x, y))
    # Part of the unit disc below a line; where the corner is outside, the two lines do not meet within the disc.
    below_x, below_y = (math.pi / 2 + math.asin(t) + t * math.sqrt(1 - t * t) for t in (x, y))
    if x * x + y * y < 1.0:
        area = x * y + (below_x + below_y) / 2 - math.pi / 4
    elif x > 0 and y > 0:
        area = below_x + below_y - math.pi
    elif x <= 0 and y <= 0:
        area = 0.0
    else:
        area = below_x if x < y else below_y
    return radius**2 * area
