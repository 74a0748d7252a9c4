"""Which turns and mirrors take a body to itself: mirror planes at which it can be cut, axes that conduct alike.

The body is the box with its inclusions, their materials and the resistances of their surfaces, without its load.
Coordinates and radii count as the same within 1e-12 of the box, the rounding of what users type or work out, and
nothing else does: a sphere moved by a millionth of the box breaks a symmetry. Symmetries are looked for among the turns
and mirrors that take axes to axes.
"""

from collections.abc import Iterator
from itertools import permutations, product
from typing import NamedTuple

import numpy as np

from demheat.scene.scene import Scene, check_scene
from demheat.scene.shapes import Layer, Sphere
from demheat.scene.shapes.bins import BallBins, ball_bins, candidates
from demheat.scene.shapes.periodic import nearest

# Of the longest side: rounding of coordinates that users type or work out.
SAME = 1e-12


class _Body(NamedTuple):
    """The inclusions of a scene as arrays."""

    center: np.ndarray  # (n, 3) float array, m: Of a layer its middle along its normal, else 0
    radius: np.ndarray  # (n,) float array, m: Of a layer half its thickness
    material: np.ndarray  # (n,) int array: Equal numbers for equal materials and equal resistances of the surface
    normal: np.ndarray  # (n,) int array: Of a layer; -1 for a sphere
    size: np.ndarray  # (3,) float array, m
    periodic: bool

    @property
    def slack(self):
        return SAME * float(self.size.max())


def mirrors(scene: Scene) -> tuple[float | None, float | None, float | None]:
    """Planes across x, y and z that mirror a body into itself.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    (3,) tuple of float, m, or None
        Where along each axis; None without such a plane, or where an inclusion is neither a sphere nor a layer, or a
        conductivity a tensor. Between
        walls it is the middle. In a periodic cell there is another one half a period on, and the first of all is given,
        0 where nothing changes along the axis.

    Examples
    --------
    >>> from demheat import gallery
    >>> from demheat.scene.symmetry import mirrors
    >>> mirrors(gallery.sphere_in_cube(5.0))
    (0.05, 0.05, 0.05)
    """
    check_scene(scene)
    body = _body(scene)
    if body is None:
        return None, None, None
    bins = _bins(body)
    return tuple(_plane(body, bins, axis) for axis in range(3))


def alike_axes(scene: Scene) -> tuple[int, int, int]:
    """Axes that some turn or mirror of a body onto itself takes to each other: it conducts alike along them.

    A turn R of the body into itself leaves its conductivity tensor as it is, k = R k R^T. So k_ii = k_jj where R takes
    axis i to j, and one load for each different number below gives all of the diagonal. Beside it is nothing where two
    of the `mirrors` are planes, or the body stands between walls.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    (3,) tuple of int
        For each axis the first one that is like it: (0, 0, 0) for a sphere in the middle of a cube, (0, 1, 2) where no
        two are alike.

    Examples
    --------
    >>> from demheat import gallery
    >>> from demheat.scene.symmetry import alike_axes
    >>> alike_axes(gallery.sphere_in_cube(5.0)), alike_axes(gallery.laminate())
    ((0, 0, 0), (0, 1, 0))
    """
    check_scene(scene)
    body, like = _body(scene), [0, 1, 2]
    if body is None:
        return tuple(like)
    bins = _bins(body)
    for order in permutations(range(3)):
        new = [(a, b) for a, b in enumerate(order) if like[a] != like[b]]
        # To axis a comes what was along axis order[a].
        if not new or np.any(np.abs(body.size[list(order)] - body.size) > body.slack):
            continue
        if any(len(_shifts(body, bins, np.diag(signs)[:, np.argsort(order)])) for signs in product((1, -1), repeat=3)):
            for a, b in new:
                low, high = sorted((like[a], like[b]))
                like = [low if each == high else each for each in like]
    return tuple(like)


def _body(scene):
    """The body of a scene, or None if it is unknown what a mirror makes of an inclusion."""
    if scene.domain != "box" or not scene.only(Sphere, Layer) or scene.anisotropic:
        return None
    center, radius, normal = [], [], []
    for shape in scene.inclusions:
        layer = not shape.bounded
        middle = np.zeros(3)
        if layer:
            middle[shape.axis] = (shape.start + shape.stop) / 2
        center.append(middle if layer else shape.center)
        radius.append((shape.stop - shape.start) / 2 if layer else shape.radius)
        normal.append(shape.axis if layer else -1)
    numbers = {}
    kinds = [(shape.material, shape.resistance) for shape in scene.inclusions]
    material = [numbers.setdefault(kind, len(numbers)) for kind in kinds]
    columns = np.array(radius, float), np.array(material, int), np.array(normal, int)
    return _Body(np.array(center, float).reshape(-1, 3), *columns, np.array(scene.size), scene.periodic)


def _bins(body) -> BallBins:
    """Where the inclusions are: balls of the size of rounding about their centres."""
    return ball_bins(body.center, np.full(len(body.center), 2 * body.slack), body.size, periodic=body.periodic)


def _plane(body, bins, axis):
    flip = np.diag(np.where(np.arange(3) == axis, -1.0, 1.0))
    shifts = _shifts(body, bins, flip)
    if not body.periodic:
        return float(body.size[axis] / 2) if len(shifts) else None
    beside = np.delete(nearest(shifts, body.size), axis, axis=1)
    shifts = shifts[np.all(np.abs(beside) <= body.slack, axis=1), axis]
    half = body.size[axis] / 2
    places = shifts / 2 % half
    # Not half a period where that is 0 but for rounding.
    return float(np.min(np.where(places >= half - body.slack, 0.0, places))) if len(places) else None


def _shifts(body, bins, turn):
    """All shifts, (k, 3) float array in metres, by which a turned body becomes the body itself; between walls one."""
    if not body.periodic:
        found = (body.size - turn @ body.size)[None] / 2
    else:
        found = _guesses(body, turn)
        # A few inclusions rule most guesses out, all at once.
        for number in _spread(len(body.center)):
            if len(found):
                found = found[_taken(body, bins, turn, found, np.full(len(found), number))]
    everything = np.arange(len(body.center))
    taken = [np.all(_taken(body, bins, turn, np.tile(shift, (len(everything), 1)), everything)) for shift in found]
    return found[np.array(taken, bool)]


def _guesses(body, turn):
    """Shifts that take one turned inclusion to one like it: a sphere, for layers do not fix all of a shift."""
    if not len(body.center):
        return np.zeros((1, 3))
    one = int(np.argmax(body.normal < 0)) if np.any(body.normal < 0) else 0
    normal = _turned_normal(body, turn)[one]
    like = (body.material == body.material[one]) & (body.normal == normal)
    like &= np.abs(body.radius - body.radius[one]) <= body.slack
    return body.center[like] - turn @ body.center[one]


def _taken(body, bins, turn, shifts, numbers):
    """Whether turned inclusions, each by its number and with its shift, take the place of one that is the same."""
    normal = _turned_normal(body, turn)[numbers]
    place = body.center[numbers] @ turn.T + shifts
    # Layers have no place along themselves.
    place[(normal[:, None] >= 0) & (normal[:, None] != np.arange(3))] = 0.0
    point, other = candidates(bins, place)
    period = body.size if body.periodic else None
    same = np.abs(nearest(place[point] - body.center[other], period)).max(axis=1, initial=0.0) <= body.slack
    same &= np.abs(body.radius[numbers[point]] - body.radius[other]) <= body.slack
    same &= (body.material[numbers[point]] == body.material[other]) & (normal[point] == body.normal[other])
    found = np.zeros(len(numbers), bool)
    found[point[same]] = True
    return found


def _turned_normal(body, turn):
    """Normals of turned layers."""
    to = np.argmax(np.abs(turn), axis=0)
    return np.where(body.normal >= 0, to[body.normal], -1)


def _spread(count) -> Iterator[int]:
    """A few numbers below a count, far apart."""
    return iter(np.unique(np.linspace(0, count - 1, min(count, 4)).astype(int)) if count else ())
