"""A body cut at its mirror planes, and how the whole follows from the part.

Across a plane that mirrors body and load no heat passes: it becomes an insulated wall. Across one that mirrors the body
and turns the load round, the temperature is odd about its value on the plane: it becomes an isothermal wall. In a
periodic cell under a mean gradient g along an axis T - g.x is odd about such planes across that axis, which lie half a
period apart: both are isothermal, and their temperatures differ by that of g. So the eighth between the planes of all
three axes, between two isothermal and four insulated walls, has the conductivity of the cell.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from demheat.scene.inputs import reals
from demheat.scene.scene import Scene
from demheat.scene.symmetry.maps import SAME, mirrors


class Reduced(NamedTuple):
    """A part of a body between mirror planes, and what it is a part of."""

    scene: Scene  # The part, its corner of least coordinates at the origin; the whole where nothing was cut
    whole: Scene
    factors: tuple[int, int, int]  # (3,) tuple of int: 1, or 2 where it was cut, along each axis
    origin: tuple[float, float, float]  # (3,) tuple of float, m: Where the part begins in the whole


class Unfolded(NamedTuple):
    """Points of the whole in its part, and what their temperature and flux are by those of the part."""

    points: np.ndarray  # (n, 3) float array, m: In the part
    sign: np.ndarray  # (n,) float array
    # (n,) float array, K: The temperature of the whole is rise + sign times that of the part; up to a constant in a
    # periodic cell, see `unfold`
    rise: np.ndarray
    signs: np.ndarray  # (n, 3) float array: The flux of the whole is that of the part times these


def reduced(scene: Scene) -> Reduced:
    """Cut a body at its mirror planes, as far as its load allows.

    A box between walls is cut in the middle of each axis without a loaded wall, the new wall insulated, and of the
    axis of a single isothermal pair, the new wall at their mean. A periodic cell is cut to an eighth if it has mirror
    planes across all three axes and its gradient is along one of them, else not at all.

    Parameters
    ----------
    scene : Scene
        With a steady load.

    Returns
    -------
    Reduced
        Under a load by walls the part has the conductivity of the whole. Nothing of an inclusion is in it twice:
        spheres are whole or cut through their middles by the new walls, layers end there.

    Raises
    ------
    ValueError
        If the load does not fix a steady temperature.
    NotImplementedError
        If the scene has sources or a round body.

    Examples
    --------
    >>> from demheat import gallery
    >>> from demheat.scene.symmetry import reduced
    >>> reduced(gallery.sphere_in_cube(5.0)).factors  # an eighth of it
    (2, 2, 2)
    """
    planes = _clear(scene, mirrors(scene))
    scene.require(steady=True, takes=("resistance", "perfect"))
    cut = _along(scene, planes) if scene.periodic else _between(scene, planes)
    if not any(cut):
        return Reduced(scene, scene, (1, 1, 1), (0.0, 0.0, 0.0))
    origin = np.array(planes) if scene.periodic else np.zeros(3)
    size = np.array(scene.size) / np.where(cut, 2, 1)
    inclusions = _inside(scene, origin, size)
    part = replace(scene, size=size, inclusions=inclusions, gradient=None, walls=_walls(scene, cut, origin))
    return Reduced(part, scene, tuple(np.where(cut, 2, 1).tolist()), tuple(origin.tolist()))


def unfold(part: Reduced, points) -> Unfolded:
    """Where points of the whole lie in its part, and how temperature and flux there become those of the whole.

    Parameters
    ----------
    part : Reduced
    points : (n, 3) float array, m
        Of the whole; of a periodic cell anywhere.

    Returns
    -------
    Unfolded
        The temperature of a periodic cell is the mean gradient times the position plus a part of zero mean, as that of
        other methods' fields; what is odd about a plane has none.

    Raises
    ------
    ValueError
        If the part is none, or the points are not (n, 3) finite numbers.

    Examples
    --------
    >>> from demheat import gallery
    >>> from demheat.scene.symmetry import reduced, unfold
    >>> part = reduced(gallery.sphere_in_cube(5.0))
    >>> unfold(part, [[0.09, 0.05, 0.05]]).points.round(6)
    array([[0.01, 0.05, 0.05]])
    """
    if not isinstance(part, Reduced):
        raise ValueError(f"part = {part!r}: must be what `reduced` returns")
    points = reals("points", points, "(n, 3) finite coordinates in metres")
    if points.ndim != 2 or points.shape[1] != 3 or not np.all(np.isfinite(points)):
        raise ValueError(f"points of shape {points.shape}: must be (n, 3) finite coordinates in metres")
    whole, size = part.whole, np.array(part.whole.size)
    cut = np.array(part.factors) > 1
    offset, turns = points - part.origin, np.zeros(points.shape)
    if whole.periodic and cut.any():
        turns = np.floor(offset / size)
        offset = offset - turns * size
    beyond = cut & (offset > size / 2)
    inside = np.where(beyond, size - offset, offset)
    signs = np.where(beyond, -1.0, 1.0)
    sign, rise = np.ones(len(points)), np.zeros(len(points))
    axis = _loaded_axis(whole)
    if axis is not None and cut[axis]:
        # The plane in the middle, about which the temperature is odd.
        wall = part.scene.walls["xyz"[axis] + "+"]
        sign = signs[:, axis]
        rise = (1.0 - sign) * wall
        if whole.periodic:
            rise = rise + whole.gradient[axis] * size[axis] * turns[:, axis]
    return Unfolded(inside, sign, rise, signs * sign[:, None])


def _clear(scene, planes):
    """The planes, None for one on which layers with a resistance meet: a wall there would not have it."""
    found = list(planes)
    for layer in scene.inclusions:
        if layer.bounded or not layer.resistance or found[layer.axis] is None:
            continue
        length, plane = scene.size[layer.axis], found[layer.axis]
        # In a periodic cell there is another plane half a period on.
        step = length / 2 if scene.periodic else length
        away = [abs((face - plane) - step * round((face - plane) / step)) for face in (layer.start, layer.stop)]
        if min(away) <= SAME * max(scene.size):
            found[layer.axis] = None
    return tuple(found)


def _loaded_axis(scene):
    """The axis of a load that is odd in the middle of it: a gradient along it, or one isothermal pair; else None."""
    if scene.periodic:
        along = np.flatnonzero(scene.gradient)
        return int(along[0]) if len(along) == 1 else None
    names = sorted(scene.walls)
    held = len(scene.wall_temperatures) == len(names)
    return scene.axis if held and len(names) == 2 and names[0][0] == names[1][0] else None


def _along(scene, planes):
    """Which axes of a periodic cell are cut: all or none, for a box is periodic along all axes or along none."""
    return [_loaded_axis(scene) is not None and None not in planes] * 3


def _between(scene, planes):
    """Which axes of a box with walls are cut."""
    loaded = {"xyz".index(name[0]) for name in scene.walls}
    odd = _loaded_axis(scene)
    return [plane is not None and (axis not in loaded or axis == odd) for axis, plane in enumerate(planes)]


def _walls(scene, cut, origin):
    axis = _loaded_axis(scene)
    if axis is None or not cut[axis]:
        return scene.walls
    name, length = "xyz"[axis], scene.size[axis]
    if scene.periodic:
        low = scene.gradient[axis] * origin[axis]
        return {name + "-": low, name + "+": low + scene.gradient[axis] * length / 2}
    low, high = scene.walls[name + "-"], scene.walls[name + "+"]
    return {name + "-": low, name + "+": (low + high) / 2}


def _inside(scene, origin, size):
    """Inclusions, moved by the origin, as they meet the box of a size."""
    slack, found = SAME * max(scene.size), []
    for shape in scene.inclusions:
        found += (_spheres if shape.bounded else _layers)(shape, scene, origin, size, slack)
    return found


def _layers(layer, scene, origin, size, slack):
    # No layer of a periodic cell comes in again beyond half a period.
    start = max(layer.start - origin[layer.axis], 0.0)
    stop = min(layer.stop - origin[layer.axis], size[layer.axis])
    return [replace(layer, start=start, stop=stop)] if stop - start > slack else []


def _spheres(sphere, scene, origin, size, slack):
    moved = replace(sphere, center=tuple(sphere.center - origin))
    found = []
    for image in moved.images(scene.size, periodic=scene.periodic):
        # Centres on a new wall lie on it exactly: cutters of geometry have tolerances of their own.
        center = np.array(image.center)
        for end in (np.zeros(3), size):
            center = np.where(np.abs(center - end) <= slack, end, center)
        beyond = np.maximum(0.0, np.maximum(-center, center - size))
        if np.linalg.norm(beyond) < image.radius - slack:
            found.append(replace(image, center=tuple(center)))
    return found
