"""Random dispersions of spheres as inclusions: exact volume fraction, no two surfaces closer than a gap.

By the Lubachevsky-Stillinger algorithm (`lsa`), which at this slow growth leaves spheres much as in equilibrium, or by
random sequential addition, one sphere after the other where it finds room (Widom, J. Chem. Phys. 44 (1966) 3888). Half
the gap is added to every radius, and taken off every wall, while the spheres are placed.
"""

from __future__ import annotations

import math
import os

import numpy as np

from demheat.packing.base import Packing, check_box, make_packing
from demheat.packing.cache import LSA, cached, code_hash
from demheat.packing.lsa import LEAST_SIDES, lsa
from demheat.packing.radii import Gaussian, distribution
from demheat.parts import axis_number, finite, vector
from demheat.scene import Scene, Sphere

METHODS = ("lsa", "rsa")
RATIO = 6.0
# Of the thermal velocity. Ten times slower than for dense packings, so that spheres collide often enough to forget the
# relaxed grid that they grow from; a second for a few hundred. At 0.02 and 0.0005 pair distributions were the same, at
# fractions 0.1 to 0.5, within the noise of 3 cells of 12 diameters.
GROWTH = 0.002
# Spheres with their gaps: random close packing, beyond which `lsa` would jam or order them, and well below where random
# addition jams (0.38), for there nearly every trial is refused.
MOST_FILLED = {"lsa": 0.63, "rsa": 0.35}
MOST_ADDED = 0.3
BATCH, TRIALS = 256, 200_000
# A scene compares all pairs of its spheres, and random addition does too: more take hours.
MOST_SPHERES = 100_000


def dispersion(
    number=None,
    *,
    fraction=0.2,
    ratio=None,
    size=(1.0, 1.0, 1.0),
    gap=0.02,
    radii=None,
    periodic=True,
    method="lsa",
    seed=0,
    folder=None,
):
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
    gap : float
        Least distance of two surfaces, and of a surface and a wall, in units of D.
    radii : distribution or (number,) array_like, optional
        Only ratios count; equal by default. See `demheat.packing.radii`.
    periodic : bool
        A periodic cell, whose faces spheres may cross; or walls, with all spheres inside.
    method : {"lsa", "rsa"}
        Lubachevsky-Stillinger, or random sequential addition (largest spheres first).
    seed : int
    folder : path, optional
        Default `demheat.packing.cache.cache_folder()`.

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
    """
    sides, radii = _check(number, fraction, ratio, size, gap, radii, periodic, method, seed, folder)
    number = _checked_number(number, fraction, RATIO if ratio is None else ratio, sides)
    longest = float(sides.max())
    # 12 digits: sides such as 0.1 and 0.3 are rounded already, and so are their ratios.
    shape = np.round(sides / longest, 12)
    drawn = radii.draw(number, np.random.default_rng([seed, 2]))
    drawn = _filling(fraction, drawn, shape)
    room = gap * _mean_diameter(drawn)
    _check_room(drawn, room, shape, periodic, method)
    if method == "lsa":
        _check_few(drawn, room, shape, periodic, fraction, gap)
    key = {"algorithm": "dispersion", "code": code_hash(*LSA, __name__), "radii": repr(radii), "shape": shape.tolist()}
    key |= {"number": number, "fraction": fraction, "gap": gap, "periodic": periodic, "method": method, "seed": seed}
    unit = cached(lambda: _placed(drawn, room, shape, periodic, method, seed), key, folder=folder)
    return unit.centers * (sides / shape), _filling(fraction, unit.radii * longest, sides)


def dispersion_scene(
    number=None,
    *,
    matrix,
    inclusion,
    load=None,
    axis=1,
    temperatures=(25.0, 35.0),
    size=(1.0, 1.0, 1.0),
    periodic=True,
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
    temperatures : (2,) sequence of float
        Of the low and the high wall of the axis, different.

    Raises
    ------
    ValueError
        As `dispersion`; if the axis or the temperatures are not as described; and if walls are asked for
        a periodic dispersion, whose spheres cross the faces.
    """
    load = ("gradient" if periodic else "walls") if load is None else load
    if load not in ("gradient", "walls"):
        raise ValueError(f"load = {load!r}: must be 'gradient' or 'walls'")
    if load == "walls" and periodic:
        raise ValueError("load = 'walls' with periodic = True: spheres cross the faces; must be periodic = False")
    axis = axis_number(axis)
    low, high = vector("temperatures", temperatures, length=2)
    if low == high:
        raise ValueError(f"temperatures = {temperatures!r}: must be two different ones, or there is no load")
    centers, radii = dispersion(number, size=size, periodic=periodic, **knobs)
    spheres = [Sphere(center, radius, inclusion) for center, radius in zip(centers, radii, strict=True)]
    if load == "walls":
        return Scene(size, matrix, spheres, walls={"xyz"[axis] + "-": low, "xyz"[axis] + "+": high})
    return Scene(size, matrix, spheres, gradient=(high - low) / size[axis] * np.eye(3)[axis])


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
    return max(1, round(6 * fraction * float(np.prod(sides)) / (math.pi * diameter**3)))


def _filling(fraction, radii, sides):
    """The radii in proportion, their spheres of this volume fraction."""
    return radii * np.cbrt(fraction * np.prod(sides) / (4 / 3 * np.pi * np.sum(radii**3)))


def _mean_diameter(radii):
    """Diameter of the sphere of mean volume."""
    return 2 * float(np.cbrt(np.mean(radii**3)))


def _placed(radii, room, sides, periodic, method, seed) -> Packing:
    """Place the spheres with half the room around each, in a box less that much at each wall."""
    inner = sides if periodic else sides - room
    wide = radii + room / 2
    if method == "rsa":
        centers, kept = _added(wide, inner, periodic, np.random.default_rng([seed, 3]))
    else:
        filled = float(4 / 3 * np.pi * np.sum(wide**3) / np.prod(inner))
        grown = lsa(
            len(radii), size=inner, phi=filled, radii=wide, periodic=periodic, seed=seed, growth=GROWTH, allow_few=True
        )
        centers, kept = grown.centers, grown.radii
    provenance = {"algorithm": f"dispersion by {method}", "seed": int(seed), "number": len(radii)}
    return make_packing(centers + (sides - inner) / 2, kept - room / 2, sides, periodic, provenance)


def _added(radii, sides, periodic, rng):
    """Centres of spheres added at random where they overlap none, (n, 3) float array, and their radii.

    Each trial is held against all spheres before it: fine for thousands.
    """
    radii = np.sort(radii)[::-1]
    centers = np.empty((len(radii), 3))
    for n, radius in enumerate(radii):
        margin = 0.0 if periodic else radius
        for _ in range(0, TRIALS, BATCH):
            trials = margin + (sides - 2 * margin) * rng.random((BATCH, 3))
            square = np.zeros((BATCH, n))
            for axis, side in enumerate(sides):
                along = np.abs(trials[:, axis, None] - centers[:n, axis])
                square += (np.minimum(along, side - along) if periodic else along) ** 2
            free = np.all(square >= (radii[:n] + radius) ** 2, axis=1)
            if free.any():
                centers[n] = trials[np.argmax(free)]
                break
        else:
            raise RuntimeError(f"no room for sphere {n + 1} of {len(radii)} in {TRIALS} trials; use method='lsa'")
    return centers, radii


def _check(number, fraction, ratio, size, gap, radii, periodic, method, seed, folder):
    """Sides of the box and the distribution of radii, all arguments checked."""
    if method not in METHODS:
        raise ValueError(f"method = {method!r}: must be one of {', '.join(METHODS)}")
    if number is not None and ratio is not None:
        raise ValueError(f"number = {number!r}, ratio = {ratio!r}: one gives the other; pass one of them")
    for name, value, least in (("number", number, 1), ("seed", seed, 0)):
        whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
        if not (whole and value >= least) and not (name == "number" and value is None):
            raise ValueError(f"{name} = {value!r}: must be an integer >= {least}")
    if not isinstance(periodic, bool | np.bool_):
        raise ValueError(f"periodic = {periodic!r}: must be True or False")
    if folder is not None and not isinstance(folder, str | os.PathLike):
        raise ValueError(f"folder = {folder!r}: must be a path, or None")
    finite("fraction", fraction, "> 0 and < 1", lambda v: 0 < v < 1)
    finite("gap", gap, "a finite number >= 0, in diameters", lambda v: v >= 0)
    if ratio is not None:
        finite("ratio", ratio, "a finite number > 1", lambda v: v > 1)
    if method == "rsa" and fraction > MOST_ADDED:
        raise ValueError(f"fraction = {fraction!r}: must be <= {MOST_ADDED} by 'rsa'; 'lsa' can do more")
    return check_box(size, periodic)[0], Gaussian(spread=0.0) if radii is None else distribution(radii)


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
    filled = float(4 / 3 * np.pi * np.sum((radii + room / 2) ** 3) / np.prod(inner))
    if filled > MOST_FILLED[method]:
        raise ValueError(
            f"{len(radii)} spheres and their gaps fill {filled:.3f} of the box; must be <= {MOST_FILLED[method]} by "
            f"{method!r}: use a smaller fraction or gap, or between walls more spheres"
        )
