"""Bodies inscribed in a box [0, size]: the box itself, cylinders along an axis, the sphere. Their walls and volumes.

Scenes and packings know their domain by its name alone; what follows from the name is here.
"""

import math

import numpy as np

# Flat walls by axis and end; a round body has one more, "round", in place of those across its round axes.
WALLS = ("x-", "x+", "y-", "y+", "z-", "z+")
# Axes across which each domain is round.
ROUND_AXES = {"box": (), "cylinder-x": (1, 2), "cylinder-y": (0, 2), "cylinder-z": (0, 1), "sphere": (0, 1, 2)}
# Part of the box that a domain with so many round axes fills.
SHARES = {0: 1.0, 2: math.pi / 4, 3: math.pi / 6}


def check_name(name, domain) -> None:
    """Raise ValueError unless a domain is known."""
    if not isinstance(domain, str) or domain not in ROUND_AXES:
        raise ValueError(f"{name} = {domain!r}: must be one of {', '.join(ROUND_AXES)}")


def domain_volume(domain, size) -> float:
    """Volume of a domain inscribed in a box, m3."""
    return SHARES[len(ROUND_AXES[domain])] * math.prod(float(side) for side in size)


def wall_names(domain, periodic=(False, False, False)) -> tuple[str, ...]:
    """Names of the walls of a domain, the round one last."""
    axes = ROUND_AXES[domain]
    flat = tuple(name for name in WALLS if not ((axis := "xyz".index(name[0])) in axes or periodic[axis]))
    return (*flat, "round") if axes else flat


def round_radius(domain, size) -> float:
    """Radius of the round wall, m; infinite for a box."""
    axes = ROUND_AXES[domain]
    return float(size[axes[0]]) / 2 if axes else math.inf


def across(points, domain, size) -> np.ndarray:
    """Offsets of points from the axis of a cylinder or the middle of a sphere."""
    axes = list(ROUND_AXES[domain])
    return np.asarray(points)[..., axes] - np.asarray(size, dtype=float)[axes] / 2


def from_middle(points, domain, size) -> np.ndarray:
    """Distance of points from the axis of a cylinder or the middle of a sphere, (...,) float array, m; 0 in a box."""
    return np.linalg.norm(across(points, domain, size), axis=-1)


def inside(points, domain, size, *, slack=0.0) -> np.ndarray:
    """Which points lie in a body or on its walls, (...,) bool array."""
    points, size = np.asarray(points), np.asarray(size, dtype=float)
    within = np.all((points >= -slack * size) & (points <= (1 + slack) * size), axis=-1)
    axes = ROUND_AXES[domain]
    if axes:
        within &= from_middle(points, domain, size) <= (0.5 + slack) * size[axes[0]]
    return within


def wall_distance(points, wall, domain, size) -> np.ndarray:
    """Distance of points to one wall, (...,) float array, m; negative beyond it."""
    if wall == "round":
        return round_radius(domain, size) - from_middle(points, domain, size)
    axis = "xyz".index(wall[0])
    x = np.asarray(points)[..., axis]
    return size[axis] - x if wall[1] == "+" else x


def nearest_wall(points, walls, domain, size) -> np.ndarray:
    """Distance of points to the nearest of some walls, (...,) float array, m; infinite where there are none."""
    nearest = np.full(np.shape(points)[:-1], np.inf)
    for wall in walls:
        nearest = np.minimum(nearest, wall_distance(points, wall, domain, size))
    return nearest


def outward(points, wall, domain, size) -> np.ndarray:
    """Unit vectors from points straight towards one wall, (n, 3) float array."""
    normals = np.zeros(np.shape(points))
    if wall != "round":
        normals[:, "xyz".index(wall[0])] = 1.0 if wall[1] == "+" else -1.0
        return normals
    with np.errstate(invalid="ignore"):
        normals[:, list(ROUND_AXES[domain])] = across(points, domain, size) / from_middle(points, domain, size)[:, None]
    # The one axis along which a cylinder is straight too.
    normals[np.isnan(normals).any(axis=1)] = np.nan
    return normals
