"""Spheres apart in a matrix of no conductivity: no heat passes, and each has one temperature."""

import numpy as np

from demheat.scene import Sphere


def sphere_temperature(scene):
    """Temperature of conducting spheres in a matrix of no conductivity; None if the scene is not of that kind.

    In a periodic cell a sphere has the mean temperature at its centre, by the walls that of the one that cuts it, if it
    has one: no heat passes as long as no sphere reaches walls of two temperatures.
    """
    apart = scene.only(Sphere) and not np.any(scene.parents())
    if not apart or scene.matrix.conductivity > 0:
        return None
    spheres = scene.inclusions
    levels = [_reached(scene, sphere) for sphere in spheres]
    if any(len(level) > 1 for level in levels):
        return None

    def temperature(points):
        result = np.full(len(points), np.nan)
        for sphere, level in zip(spheres, levels, strict=True):
            away = points - sphere.center
            if scene.periodic:
                away -= scene.size * np.round(away / scene.size)
            # Surfaces belong to their sphere; a little more is nobody's.
            inside = np.linalg.norm(away, axis=1) <= sphere.radius * (1 + 1e-9)
            if scene.periodic:
                result[inside] = (points[inside] - away[inside]) @ np.array(scene.gradient)
            elif level:
                result[inside] = next(iter(level))
        return result

    return temperature


def _reached(scene, sphere):
    """Temperatures of the walls that cut a sphere, a set."""
    found = set()
    for name, value in scene.wall_temperatures.items():
        axis = "xyz".index(name[0])
        end = 0.0 if name[1] == "-" else scene.size[axis]
        if abs(sphere.center[axis] - end) < sphere.radius and sphere.material.conductivity > 0:
            found.add(value)
    return found
