"""Rayleigh's multipole method for any number of spheres in a periodic cell: an exact witness for random dispersions.

Rayleigh (1892); McPhedran and McKenzie, Proc. R. Soc. A 359 (1978) 45; Sangani and Acrivos, Proc. R. Soc. A 386 (1983)
263. The spheres may differ in radius and conductivity. The only errors are those of the highest degree kept, which
is stated, and of the linear solve. The sums are in `multipole_sums`, the system in `multipole_system`, the field in
`multipole_field`.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from demheat.field import Field, Samples
from demheat.scene import Sphere
from references.multipole.field import Evaluator
from references.multipole.sums import entries
from references.multipole.system import Spheres, homogeneous, received, solve_order, translation

KNOWN = "multipole knows disjoint spheres in a periodic cell under a mean gradient"
FIRST_ORDER, HIGHEST_ORDER = 8, 40
# Periodic sums are made for so many orders more than asked for at once.
AHEAD = 6
# What one product with the translations (in multiplications, some 1e9 a second) and their table (in bytes) may cost.
MOST_WORK, MOST_BYTES = 2e10, 3e9
# Bounds on the ratio of successive changes, of two degrees each, by which the rest is extrapolated.
RATIOS = (0.2, 0.95)
# Neglected share of what a dipole makes at its nearest neighbour, without the powers of the degree that come with it.
ENOUGH = 1e-15


def solve(scene, *, order=None, accuracy=1e-5, tolerance=1e-10, points_per_axis=24, threads=1):
    """Solve a periodic cell with disjoint spheres.

    Parameters
    ----------
    scene : Scene
        Periodic; spheres may differ in radius and conductivity and may cross its faces.
    order : int, optional
        Highest degree of the multipoles. By default it is raised until the conductivity is known to `accuracy`. With
        an order given nothing is refused: `stats["truncation"]` says what error remains.
    accuracy : float
        Relative, of the mean flux; for order = None.
    tolerance : float
        Relative residual of the linear system.
    points_per_axis : int
        The samples are the midpoints of so many equal cells along each axis.
    threads : int

    Returns
    -------
    Field
        The temperature is the mean gradient times the position plus a periodic part of zero mean. Of its `stats`,
        `truncation` is the relative error of the mean flux that higher degrees would remove, extrapolated from the
        last changes; `field_truncation` the largest term of the last two degrees in the flux at an interface, over
        the mean gradient; `smallest_gap` in metres; `convergence` pairs (order, conductivity).

    Raises
    ------
    ValueError
        If an argument is out of range.
    NotImplementedError
        For walls, layers, nested spheres, a matrix of no conductivity.
    RuntimeError
        If the linear solve does not converge, or if the order that the gaps between the spheres ask for is too high.
    """
    _check_knobs(order, accuracy, tolerance, points_per_axis, threads)
    scene.require(steady=True)
    spheres, unit = _spheres(scene)
    history = _converged(spheres, np.array(scene.gradient) * unit, order, accuracy, tolerance, threads, unit)
    return _field(scene, spheres, unit, history, points_per_axis)


def _field(scene, spheres, unit, history, points_per_axis):
    conductivities, made = scene.conductivities, []

    def at(points):
        # The waves' amplitudes are worth their time only if the field is asked for.
        if not made:
            made.append(Evaluator(spheres, history[-1], np.array(scene.gradient) * unit))
        values, owner = made[0](points / unit)
        return values[:, 0], -conductivities[owner + 1][:, None] * values[:, 1:] / unit, owner + 1

    def sampler():
        axes = [(np.arange(points_per_axis) + 0.5) * length / points_per_axis for length in scene.size]
        points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        temperature, flux, phase = at(points)
        volumes = np.full(len(points), scene.volume / len(points))
        return Samples(points, volumes, temperature, phase.astype(np.int32), flux)

    shares = 4 / 3 * math.pi * spheres.radii**3 / np.prod(spheres.size)
    return Field(
        scene=scene,
        mean_flux=scene.matrix.conductivity * history[-1].mean_flux / unit,
        fractions=np.concatenate([[1 - shares.sum()], shares]),
        sampler=sampler,
        temperature_at=lambda points: at(points)[0],
        flux_at=lambda points: at(points)[1],
        stats=_stats(scene, spheres, unit, history),
    )


def _stats(scene, spheres, unit, history):
    last, gradient = history[-1], np.array(scene.gradient) * unit
    k = -scene.matrix.conductivity / (gradient @ gradient)
    return {
        "order": last.order,
        "unknowns": len(spheres.radii) * ((last.order + 1) ** 2 - 1),
        "iterations": last.iterations,
        "residual": last.residual,
        "truncation": _truncation(history),
        "field_truncation": _field_truncation(spheres, last, gradient),
        "smallest_gap": _smallest_gap(spheres) * unit,
        "convergence": tuple((solved.order, float(k * solved.mean_flux @ gradient)) for solved in history),
    }


def zeta2(scene, *, order=None):
    """Milton's parameter zeta_2 of the spheres of a periodic cell, averaged over the three axes.

    With p = -alpha a^3 g the dipoles and T the translation, the conductivity at third order in beta = (s - 1)/(s + 2)
    is c_3 = (4 pi/V) sum over spheres and lm of 3l/(2l+1) |C_lm|^2, C = T a^3 what unit dipoles make at each other;
    by Torquato's expansion (Random Heterogeneous Materials, 2002, sec. 20.1) the mean of c_3 over the axes is
    3 phi_2^3 + 6 phi_1 phi_2 zeta_2. The mean of the first two orders over the axes is that of an isotropic medium.

    Parameters
    ----------
    scene : Scene
        Periodic, all spheres of one material; its conductivities do not matter.
    order : int, optional
        Highest degree received. By default one that leaves a relative error of some 1e-12, or else an error is raised;
        one that is given leaves some (a/d)^(2 order), a the largest radius and d its least distance to a centre.

    Returns
    -------
    float

    Raises
    ------
    ValueError
        If there is no sphere or not all spheres are of one material, or the order is too high for memory or precision.
    NotImplementedError
        As for `solve`.
    RuntimeError
        If the order that the gaps and radii ask for is too high.
    """
    spheres, unit = _spheres(scene, any_matrix=True)
    if len(set(spheres.contrasts.tolist())) != 1:
        raise ValueError(
            f"Scene.inclusions: {len(spheres.radii)} spheres of {len(set(spheres.contrasts.tolist()))} materials; "
            "zeta_2 is defined for one or more spheres of one material"
        )
    order = _zeta2_order(spheres, unit, order)
    table = translation(spheres, order + 1)
    n, m = entries(order)
    weight = np.where(n > 0, 3 * n / (2 * n + 1), 0.0) * np.where(m > 0, 2.0, 1.0) * spheres.radii[:, None]
    volume, total = float(np.prod(spheres.size)), 0.0
    for component, entry, size in ((0, 1, 1.0), (0, 2, math.sqrt(0.5)), (1, 2, math.sqrt(0.5))):
        dipoles = np.zeros((2, len(spheres.radii), len(n)))
        # Moment a^3 in units of a^2, along z, x, y.
        dipoles[component, :, entry] = size * spheres.radii
        total += 4 * math.pi / volume * np.sum(weight * received(spheres, table, order, dipoles) ** 2) / 3
    phi = 4 / 3 * math.pi * np.sum(spheres.radii**3) / volume
    return float((total - 3 * phi**3) / (6 * phi * (1 - phi)))


def _zeta2_order(spheres, unit, order):
    """The order that was given, or the one that is enough; refused beyond what memory and numbers hold."""
    count = len(spheres.radii)
    # Entries of degree order + 1 for each pair. At 150 square roots of factorials overflow; small spheres add powers.
    memory = math.sqrt(2 * MOST_BYTES / (16 * (1 + count * (count - 1) / 2))) - 3
    highest = min(2 * HIGHEST_ORDER, int(memory))
    if order is not None:
        _check_order(order)
        if order > highest:
            raise ValueError(f"order = {order}: must be <= {highest} for {count} spheres in memory and precision")
        return order
    gap = max(_smallest_gap(spheres), 0.0)
    ratio = spheres.radii.max() / (spheres.radii.max() + spheres.radii.min() + gap)
    needed = max(4, math.ceil(math.log(ENOUGH) / (2 * math.log(ratio))))
    if needed > highest:
        small, large = (unit * radius for radius in (spheres.radii.min(), spheres.radii.max()))
        raise RuntimeError(
            f"multipole: smallest gap {gap * unit:.3g} m between {count} spheres of radii {small:.3g} to {large:.3g} m "
            f"needs order {needed}; {highest} is the highest in memory and precision. Give order=... to accept less"
        )
    return needed


def _converged(spheres, gradient, order, accuracy, tolerance, threads, unit):
    """Solutions of rising order, two degrees apart; the last is the answer."""
    highest = _highest_order(len(spheres.radii))
    if order is not None and order > highest:
        raise ValueError(f"order = {order}: must be <= {highest} for {len(spheres.radii)} spheres in memory and time")
    wanted = FIRST_ORDER if order is None else order
    orders = [n for n in (wanted - 6, wanted - 4, wanted - 2, wanted) if n >= 1]
    history, table, reach = [homogeneous(spheres, gradient)], None, 0
    while len(spheres.radii):
        for n in orders:
            if n > reach:
                reach = wanted if order is not None else min(n + AHEAD, highest)
                table = translation(spheres, 2 * reach)
            options = {"tolerance": tolerance, "guess": history[-1], "threads": threads}
            history.append(solve_order(spheres, table, gradient, n, **options))
        if order is not None or _truncation(history) <= accuracy:
            return history
        _refuse_hopeless(history, accuracy, highest, _smallest_gap(spheres) * unit)
        orders = [history[-1].order + 2]
    return history


def _refuse_hopeless(history, accuracy, highest, gap):
    now, left = history[-1].order, _truncation(history)
    needed = now + 2 * math.ceil(math.log(accuracy / left) / math.log(_ratio(_changes(history))))
    # The prediction at low orders is rough: half as much again is allowed for.
    if now + 2 > highest or (now >= 10 and needed > 1.5 * highest):
        raise RuntimeError(
            f"multipole: smallest gap {gap:.3g} m needs order {needed} or so for accuracy = {accuracy:.1e}; at order "
            f"{now} the mean flux is known to {left:.1e}, and {highest} is the highest order. Give order=... to accept "
            "less, or a larger accuracy"
        )


def _changes(history):
    """Relative changes of the mean flux, the last three at most, from order 0 on, that of the matrix alone."""
    flux = [solved.mean_flux for solved in history]
    scale = max(float(np.linalg.norm(flux[-1])), np.finfo(float).tiny)
    return [float(np.linalg.norm(b - a)) / scale for a, b in pairwise(flux)][-3:]


def _ratio(changes):
    """Mean ratio of successive changes; a half where there is only one."""
    if changes[0] == 0 or len(changes) == 1:
        return 0.5 if changes[0] else RATIOS[0]
    return float(np.clip((changes[-1] / changes[0]) ** (1 / (len(changes) - 1)), *RATIOS))


def _truncation(history):
    """Relative error left in the mean flux: twice what it is if changes go on as a geometric series.

    In a symmetric array some degrees hardly matter: the last change but one counts as well. Twice, as ratios rise
    slowly with the order where gaps are small.
    """
    changes = _changes(history)
    if not changes:
        return 0.0
    ratio = _ratio(changes)
    before = changes[-2] * ratio if len(changes) > 2 else 0.0
    return 2 * max(changes[-1], before) * ratio / (1 - ratio)


def _field_truncation(spheres, solved, gradient):
    n, _ = entries(solved.order)
    last = np.abs(n * solved.source / spheres.radii[:, None])[:, :, n >= max(1, solved.order - 1)]
    return float(last.max(initial=0.0) / np.linalg.norm(gradient))


def _highest_order(count):
    work = (MOST_WORK / (4 * max(count, 1) ** 2)) ** 0.25 - 1
    memory = math.sqrt(MOST_BYTES / (16 * (1 + count * (count - 1) / 2))) / math.sqrt(2) - 1
    return max(1, min(HIGHEST_ORDER, int(work), int(memory)))


def _spheres(scene, *, any_matrix=False):
    """The spheres in units of the largest diameter, and that unit in metres."""
    scene.require(KNOWN, walls="none", shapes=(Sphere,), nested=False)
    k = scene.matrix.conductivity
    if k == 0 and not any_matrix:
        raise NotImplementedError("multipole: a matrix of no conductivity; disjoint spheres then carry no heat")
    unit = 2 * max((sphere.radius for sphere in scene.inclusions), default=max(scene.size) / 2)
    return Spheres(
        np.array([sphere.center for sphere in scene.inclusions]).reshape(-1, 3) / unit,
        np.array([sphere.radius for sphere in scene.inclusions]).reshape(-1) / unit,
        np.array([sphere.material.conductivity for sphere in scene.inclusions]) / (k if k > 0 else 1.0),
        np.array(scene.size) / unit,
    ), unit


def _smallest_gap(spheres):
    """Least distance between two surfaces, images included; infinite without spheres."""
    gap = float(np.min(spheres.size)) - 2 * float(spheres.radii.max()) if len(spheres.radii) else math.inf
    for i in range(len(spheres.radii) - 1):
        apart = spheres.centers[i + 1 :] - spheres.centers[i]
        apart -= spheres.size * np.round(apart / spheres.size)
        gap = min(gap, float(np.min(np.linalg.norm(apart, axis=1) - spheres.radii[i + 1 :])) - spheres.radii[i])
    return float(gap)


def _check_knobs(order, accuracy, tolerance, points_per_axis, threads):
    if order is not None:
        _check_order(order)
    for name, value in (("accuracy", accuracy), ("tolerance", tolerance)):
        if not (isinstance(value, int | float) and 1e-14 <= value < 1):
            raise ValueError(f"{name} = {value!r}: must be a number from 1e-14 to below 1")
    for name, value in (("points_per_axis", points_per_axis), ("threads", threads)):
        if not isinstance(value, int | np.integer) or isinstance(value, bool) or value < 1:
            raise ValueError(f"{name} = {value!r}: must be an integer >= 1")


def _check_order(order):
    if not isinstance(order, int | np.integer) or isinstance(order, bool) or order < 1:
        raise ValueError(f"order = {order!r}: must be an integer >= 1")
