"""Random dispersions of spheres as inclusions: exact volume fraction, no two surfaces closer than a gap.

By the Lubachevsky-Stillinger algorithm (`lsa`), which at this slow growth leaves spheres much as in equilibrium, or by
random sequential addition, one sphere after the other where it finds room. Half the gap is added to every radius, and
taken off every wall, while the spheres are placed.
"""

import math
import os
from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np

from demheat.addition import MOST_FILLED, add_spheres
from demheat.packing.base import Packing, check_box, make_packing
from demheat.packing.kept import LSA, cached, code_hash
from demheat.packing.lsa import LEAST_SIDES, lsa
from demheat.packing.radii import Gaussian, distribution
from demheat.powers import cube_root, cubed
from demheat.scene import Material, Scene, Sphere
from demheat.scene.inputs import axis_number, finite, vector
from demheat.scene.material import check_material

# Whose source decides what a dispersion is.
CODE = (*LSA, "demheat.addition", __name__)

METHODS = ("lsa", "rsa")
RATIO = 6.0
# Of the thermal velocity. Ten times slower than for dense packings, so that spheres collide often enough to forget the
# relaxed grid that they grow from; a second for a few hundred. At 0.02 and 0.0005 pair distributions were the same, at
# fractions 0.1 to 0.5, within the noise of 3 cells of 12 diameters.
GROWTH = 0.002
# Spheres with their gaps: random close packing, beyond which `lsa` would jam or order them; and where random addition
# gives up.
MOST = {"lsa": 0.63, "rsa": MOST_FILLED}
MOST_ADDED = 0.3
# Some 4 CPU-seconds for each thousand by collisions.
MOST_SPHERES = 100_000


@dataclass(frozen=True)
class Placing:
    """How the spheres of a dispersion find their places.

    D below is the diameter of the sphere of mean volume.
    """

    gap: float = 0.02  # Least distance of two surfaces, and of a surface and a wall, in units of D
    method: str = "lsa"  # {"lsa", "rsa"}: Lubachevsky-Stillinger, or random sequential addition (largest spheres first)
    seed: int = 0

    def __post_init__(self):
        if self.method not in METHODS:
            raise ValueError(f"method = {self.method!r}: must be one of {', '.join(METHODS)}")
        _check_whole("seed", self.seed, 0)
        finite("gap", self.gap, "a finite number >= 0, in diameters", lambda v: v >= 0)


def dispersion(
    number: int | None = None,
    *,
    fraction: float = 0.2,
    ratio: float | None = None,
    size: Sequence[float] = (1.0, 1.0, 1.0),
    radii=None,
    periodic: bool = True,
    folder: str | os.PathLike | None = None,
    **knobs,
) -> tuple[np.ndarray, np.ndarray]:
    """Place spheres at random, equal or not; kept on disk, so that each dispersion is made once.

    D below is the diameter of the sphere of mean volume, which follows from number and fraction.

    Parameters
    ----------
    number : int, optional
        Of spheres, at most 100 000; 2 or more by "lsa". By default as many as make the shortest side nearest to
        `ratio` D.
    fraction : float
        Volume fraction, met to rounding; at most 0.3 by "rsa", which between walls jams below that (6 diameters: some
        0.27).
    ratio : float, optional
        L/D, shortest side over D, 6 by default; not together with `number`.
    size : (3,) sequence of float, m
    radii : distribution or (number,) array_like, optional
        Only ratios count; equal by default. See `demheat.packing.radii`.
    periodic : bool
        A periodic cell, whose faces spheres may cross; or walls, with all spheres inside.
    folder : path, optional
        Default `demheat.packing.kept.cache_folder()`.
    gap, method, seed
        As in `Placing`.

    Returns
    -------
    centers : (number, 3) float array, m
    radii : (number,) float array, m

    Raises
    ------
    ValueError
        If an argument is not as described, or the spheres with their gaps are too many or too large for the box.
    RuntimeError
        If no room is found for a sphere.

    Examples
    --------
    >>> from demheat.packing.dispersion import dispersion
    >>> centers, radii = dispersion(20, fraction=0.2, seed=0)
    >>> centers.shape, round(float((4 / 3 * 3.14159265 * radii**3).sum()), 6)
    ((20, 3), 0.2)
    """
    placing = Placing(**knobs)
    _check(number, fraction, ratio, periodic, folder, placing)
    sides = check_box(size, periodic)[0]
    radii = Gaussian(spread=0.0) if radii is None else distribution(radii)
    number = _checked_number(number, fraction, RATIO if ratio is None else ratio, sides)
    # 12 digits: sides such as 0.1 and 0.3 are rounded already, and so are their ratios.
    shape = np.round(sides / sides.max(), 12)
    drawn = _filling(fraction, radii.draw(number, np.random.default_rng([placing.seed, 2])), shape)
    room = placing.gap * _mean_diameter(drawn)
    _check_room(drawn, room, shape, periodic, placing.method)
    if placing.method == "lsa":
        _check_few(drawn, room, shape, periodic, fraction, placing.gap)
    key = {"algorithm": "dispersion", "code": code_hash(*CODE), "radii": repr(radii), "shape": shape.tolist()}
    key |= {"number": number, "fraction": fraction, "periodic": periodic} | asdict(placing)
    unit = cached(lambda: _placed(drawn, room, shape, periodic, placing), key, folder=folder)
    return unit.centers * (sides / shape), _filling(fraction, unit.radii * float(sides.max()), sides)


def dispersion_scene(
    number: int | None = None,
    *,
    matrix: Material,
    inclusion: Material,
    load: str | None = None,
    axis: int = 1,
    temperatures: Sequence[float] = (25.0, 35.0),
    size: Sequence[float] = (1.0, 1.0, 1.0),
    periodic: bool = True,
    **knobs,
) -> Scene:
    """Scene of a random dispersion under a load along one axis.

    Parameters
    ----------
    number, size, periodic, knobs
        As in `dispersion`.
    matrix, inclusion : Material
    load : {"gradient", "walls"}, optional
        A periodic cell under the mean gradient that the temperatures make, the default for periodic dispersions; or
        walls held at them, the others insulated, the default for walled ones. Walled dispersions can take both, so that
        the same spheres are seen under either.
    axis : {0, 1, 2}
    temperatures : (2,) sequence of float, K or degrees Celsius
        Of the low and the high wall of the axis, different.

    Returns
    -------
    Scene

    Raises
    ------
    ValueError
        As `dispersion`; if the axis or the temperatures are not as described; and if walls are asked for
        a periodic dispersion, whose spheres cross the faces.

    Examples
    --------
    >>> from demheat import Material
    >>> from demheat.packing.dispersion import dispersion_scene
    >>> scene = dispersion_scene(20, fraction=0.2, seed=0, matrix=Material(0.195), inclusion=Material(1.5))
    >>> len(scene.inclusions), scene.gradient
    (20, (0.0, 10.0, 0.0))
    """
    for name, material in (("matrix", matrix), ("inclusion", inclusion)):
        check_material(name, material)
    walls = _load(load, axis, temperatures, size, periodic)
    centers, radii = dispersion(number, size=size, periodic=periodic, **knobs)
    spheres = [Sphere(center, radius, inclusion) for center, radius in zip(centers, radii, strict=True)]
    return Scene(size, matrix, spheres, **walls)


def _load(load, axis, temperatures, size, periodic):
    """Walls or gradient of a scene, as its keyword."""
    load = ("gradient" if periodic else "walls") if load is None else load
    if load not in ("gradient", "walls"):
        raise ValueError(f"load = {load!r}: must be 'gradient' or 'walls'")
    if load == "walls" and periodic:
        raise ValueError("load = 'walls' with periodic = True: spheres cross the faces; must be periodic = False")
    axis = axis_number(axis)
    low, high = vector("temperatures", temperatures, length=2)
    if low == high:
        raise ValueError(f"temperatures = {temperatures!r}: must be two different ones, or there is no load")
    if load == "walls":
        return {"walls": {"xyz"[axis] + "-": low, "xyz"[axis] + "+": high}}
    return {"gradient": (high - low) / size[axis] * np.eye(3)[axis]}


def _checked_number(number, fraction, ratio, sides):
    """Number of spheres; if none is given at least 1 and nearest to that of the ratio of shortest side to diameter."""
    if number is not None:
        if number > MOST_SPHERES:
            raise ValueError(f"number = {number}: must be <= {MOST_SPHERES}; more would take hours")
        return int(number)
    with np.errstate(over="ignore"):
        share = np.prod((float(sides.min()) / ratio) / sides) * math.pi / 6
        wanted = fraction / share if share > 0 else math.inf
    if wanted > MOST_SPHERES:
        raise ValueError(
            f"ratio = {ratio!r} at fraction = {fraction!r} in size = {sides.tolist()}: makes {wanted:.3g} spheres; "
            f"must be <= {MOST_SPHERES}, more would take hours. Use a smaller ratio"
        )
    diameter = float(sides.min()) / ratio
    return max(1, round(6 * fraction * float(np.prod(sides)) / (math.pi * cubed(diameter))))


def _filling(fraction, radii, sides):
    """The radii in proportion, their spheres of this volume fraction."""
    return radii * cube_root(fraction * np.prod(sides) / (4 / 3 * np.pi * np.sum(cubed(radii))))


def _mean_diameter(radii):
    """Diameter of the sphere of mean volume."""
    return 2 * cube_root(np.mean(cubed(radii)))


def _placed(radii, room, sides, periodic, placing) -> Packing:
    """Place the spheres with half the room around each, in a box less that much at each wall."""
    inner = sides if periodic else sides - room
    wide = radii + room / 2
    if placing.method == "rsa":
        kept, rng = np.sort(wide)[::-1], np.random.default_rng([placing.seed, 3])
        centers = add_spheres(kept, inner, rng, periodic=periodic, margin=0.0 if periodic else kept)
    else:
        filled = float(4 / 3 * np.pi * np.sum(cubed(wide)) / np.prod(inner))
        box = {"size": inner, "periodic": periodic}
        grown = lsa(len(radii), **box, radii=wide, seed=placing.seed, phi=filled, growth=GROWTH, allow_few=True)
        centers, kept = grown.centers, grown.radii
    provenance = {"algorithm": f"dispersion by {placing.method}", "seed": int(placing.seed), "number": len(radii)}
    return make_packing(centers + (sides - inner) / 2, kept - room / 2, sides, periodic, provenance)


def _check(number, fraction, ratio, periodic, folder, placing):
    """Raise ValueError unless the arguments of `dispersion` are as described there."""
    if number is not None and ratio is not None:
        raise ValueError(f"number = {number!r}, ratio = {ratio!r}: one gives the other; pass one of them")
    if number is not None:
        _check_whole("number", number, 1)
    if not isinstance(periodic, bool | np.bool_):
        raise ValueError(f"periodic = {periodic!r}: must be True or False")
    if folder is not None and not isinstance(folder, str | os.PathLike):
        raise ValueError(f"folder = {folder!r}: must be a path, or None")
    finite("fraction", fraction, "> 0 and < 1", lambda v: 0 < v < 1)
    if ratio is not None:
        finite("ratio", ratio, "a finite number > 1", lambda v: v > 1)
    if placing.method == "rsa" and fraction > MOST_ADDED:
        raise ValueError(f"fraction = {fraction!r}: must be <= {MOST_ADDED} by 'rsa'; 'lsa' can do more")


def _check_whole(name, value, least):
    if not isinstance(value, int | np.integer) or isinstance(value, bool) or value < least:
        raise ValueError(f"{name} = {value!r}: must be an integer >= {least}")


def _check_few(radii, room, sides, periodic, fraction, gap):
    """Raise ValueError if the spheres are too few for `lsa`."""
    what = "use more spheres, a smaller fraction, or method='rsa'"
    if len(radii) < 2:
        raise ValueError(f"number = {len(radii)}: must be an integer >= 2 by 'lsa', where spheres collide; {what}")
    largest, inner = float(radii.max()) + room / 2, sides if periodic else sides - room
    least = LEAST_SIDES[bool(periodic)] * largest
    if inner.min() < least:
        raise ValueError(
            f"number = {len(radii)}, fraction = {fraction!r}, gap = {gap!r}: by 'lsa' the shortest side must be >= "
            f"{least / (2 * largest):.3g} diameters of the largest sphere with its gap, not "
            f"{inner.min() / (2 * largest):.3g}; {what}"
        )


def _check_room(radii, room, sides, periodic, method):
    """Raise ValueError if the spheres with their gaps cannot be placed."""
    inner = sides if periodic else sides - room
    wide = 2 * float(radii.max()) + room
    if inner.min() <= wide:
        raise ValueError(
            f"spheres of diameter {2 * radii.max():.4g} with gaps of {room:.4g} in a box of {sides.tolist()} (longest "
            "side 1): must fit; use more spheres, or a smaller fraction or gap"
        )
    filled = float(4 / 3 * np.pi * np.sum(cubed(radii + room / 2)) / np.prod(inner))
    if filled > MOST[method]:
        raise ValueError(
            f"{len(radii)} spheres and their gaps fill {filled:.3f} of the box; must be <= {MOST[method]} by "
            f"{method!r}: use a smaller fraction or gap, or between walls more spheres"
        )
