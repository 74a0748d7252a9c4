"""Packings by relaxing overlaps: particles start on a jittered grid and push each other apart.

The minimiser is FIRE (Bitzek et al., Phys. Rev. Lett. 97 (2006) 170201) with symplectic Euler steps. Lengths inside are
in units of the mean radius; stiffness is 1.
"""

from __future__ import annotations

import math
from itertools import product

import numpy as np

from demheat.packing import relax_kernels as kernels
from demheat.packing.base import Packing, check_box, check_domain, make_packing, morton_order, wrap
from demheat.packing.neighbours import near_rows
from demheat.packing.radii import Gaussian, distribution
from demheat.parts import finite
from demheat.scene import ROUND_AXES, domain_volume

# Listed pairs reach this many mean radii beyond contact; a new list is made when two particles could have closed half
# of that each. Found fastest from 0.9 to 1.2 (a list costs about ten steps).
SKIN = 1.1
# FIRE: time steps in units of sqrt(mass/stiffness) of a mean particle, and the usual factors. Found on 2e4 particles:
# a step above 0.6 or a mixing above 0.3 stalls, the published delay of 5 steps and mixing of 0.1 need 1.4 times longer.
DT, DT_MAX, DT_GROW, DT_CUT = 0.5, 0.6, 1.1, 0.5
MIX, MIX_FADE, DELAY = 0.25, 0.99, 1
# Grid spacings that starting points move at random, each way. One: a uniform shift over a whole number of spacings
# erases the Bragg peak of the grid. At 0.15 the relaxed packing kept it (structure factor 900 instead of 1 at that wave
# vector, <n_x^4> off by 6 standard deviations), which the fabric tensor cannot see: it is isotropic on a cubic grid.
JITTER = 1.0
FEWEST = 100


def relax(
    number,
    *,
    size=(1.0, 1.0, 1.0),
    phi=0.64,
    radii=None,
    periodic=True,
    domain="box",
    seed=0,
    overlap=0.002,
    steps=400,
    allow_few=False,
    progress=None,
) -> Packing:
    """Pack exactly `number` spheres at packing fraction `phi` with small overlaps.

    Parameters
    ----------
    number : int
    size : (3,) sequence of float, m
    phi : float
        Sum of the sphere volumes over the volume of the domain, met to rounding. Walls leave less room: above what fits
        (0.595 at 1e3 and 0.625 at 1e4 particles with spread 0.3 in a walled cube) overlaps remain.
    radii : Gaussian, Uniform, Lognormal, Bidisperse, Listed or (n,) array_like, optional
        Only ratios count. Default Gaussian(spread=0.3, cut=2.5).
    periodic : bool or (3,) sequence of bool
        Per axis: periodic, or a hard wall at both ends.
    domain : {"box", "cylinder-x", "cylinder-y", "cylinder-z", "sphere"}
        Inscribed in the box, with a hard round wall.
    seed : int
    overlap : float
        Stop when the mean overlap of the overlapping pairs is below this part of the mean diameter.
    steps : int
        Stop there at the latest; provenance["converged"] then is False and "mean_overlap" says what was reached.
    allow_few : bool
        Fewer than 100 particles are refused unless this is True.
    progress : callable (step, mean overlap), optional

    Returns
    -------
    Packing
        Same bits for the same arguments, whatever the number of threads.

    Raises
    ------
    ValueError
        If an argument is not as described, or a sphere is too large for the box.
    """
    radii = Gaussian() if radii is None else distribution(radii)
    size, periodic = _check_request(number, size, phi, periodic, seed, overlap, steps, allow_few)
    check_domain(domain, size, periodic)
    rng = np.random.default_rng(seed)
    centers = _starting_points(int(number), size, periodic, domain, rng)
    drawn = radii.draw(int(number), rng)
    drawn *= np.cbrt(phi * domain_volume(domain, size) / (4.0 / 3.0 * np.pi * np.sum(drawn**3)))
    check_fit(drawn, size, periodic)
    order = morton_order(centers, size)
    box = (size, periodic, domain)
    centers, reached = _minimise(centers[order], drawn, *box, overlap, steps, progress=progress)
    provenance = {"algorithm": "relax", "seed": int(seed), "number": int(number), "phi": float(phi)}
    provenance |= {"radii": repr(radii), "overlap": float(overlap), "steps": int(steps)} | reached
    return make_packing(centers, drawn, size, periodic, provenance, domain=domain)


def settle(packing: Packing, *, fixed=None, steps=100, overlap=0.0, progress=None) -> Packing:
    """Push overlapping particles of a given packing apart, some of them held fixed.

    Parameters
    ----------
    packing : Packing
    fixed : (n,) bool array, optional
        Particles that do not move (they still push the others).
    steps : int
    overlap : float
        Stop earlier when the mean overlap is below this part of the mean diameter.
    progress : callable (step, mean overlap), optional

    Returns
    -------
    Packing
        The particles in the order given (not sorted again): `fixed` stays valid for it.

    Raises
    ------
    ValueError
        If `fixed`, `steps` or `overlap` is not as described, or a sphere is too large for the box.
    """
    n = packing.number
    fixed = np.zeros(n, dtype=bool) if fixed is None else np.asarray(fixed)
    if fixed.dtype != bool or fixed.shape != (n,):
        raise ValueError(f"fixed of shape {fixed.shape} and type {fixed.dtype}: must be {n} bools, one per particle")
    _check_stop(overlap, steps)
    check_fit(packing.radii, packing.size, packing.periodic)
    box = (packing.size, packing.periodic, packing.domain)
    centers, reached = _minimise(packing.centers, packing.radii, *box, overlap, steps, fixed=fixed, progress=progress)
    centers[fixed] = packing.centers[fixed]
    return packing._replace(centers=centers, provenance=packing.provenance | {"settled": reached})


def check_fit(radii, size, periodic):
    """Raise ValueError if a sphere is too large for its box.

    Along a periodic axis only the nearest image of a neighbour is seen, so the two largest spheres must not be able to
    touch both ways round; between walls the largest sphere must fit.
    """
    largest = float(np.max(radii))
    for axis in range(3):
        least = 4 * largest if periodic[axis] else 2 * largest
        if size[axis] < least:
            kind = "twice the largest diameter (periodic axis)" if periodic[axis] else "the largest diameter (walls)"
            raise ValueError(
                f"size = {np.asarray(size).tolist()}: side {axis} must be >= {kind} = {least:.6g}; use more particles, "
                "a narrower distribution or a thicker box"
            )


def _minimise(centers, radii, size, periodic, domain, overlap, steps, *, fixed=None, progress=None):
    """Run FIRE; returns the centres, inside the box, and what was reached."""
    unit = float(np.mean(radii))
    points, box = np.column_stack((centers, radii)) / unit, size / unit
    period, across = np.where(periodic, box, 0.0), np.zeros(3)
    across[list(ROUND_AXES[domain])] = 1.0
    mobility = _mobility(points[:, 3], fixed)
    chunks = -(-len(points) // kernels.CHUNK)
    velocity, force = np.zeros((2, len(points), 3))
    sums, farthest = np.empty((chunks, 6)), np.empty(chunks)
    start, lists, moved, row = None, 0, 0.0, 16.0
    pace = (DT, MIX, 0)
    for step in range(steps + 1):
        if start is None or 2 * moved > SKIN:
            indptr, indices = near_rows(points, box, periodic, skin=SKIN, guess=row)
            start, lists, row = points[:, :3].copy(), lists + 1, len(indices) / len(points)
        kernels.forces(points, velocity, mobility, indptr, indices, box, period, across, force, sums)
        mean = sums[:, 3].sum() / max(sums[:, 4].sum(), 1.0) / 2
        if progress is not None:
            progress(step, mean)
        work = sums[:, :3].sum(axis=0)
        if mean <= overlap or work[1] == 0.0 or step == steps:
            break
        keep, push, pace = _fire(*work, *pace)
        kernels.move(points, start, velocity, force, keep, push, pace[0], farthest)
        moved = math.sqrt(farthest.max())
    reached = {"iterations": step, "lists": lists, "mean_overlap": float(mean)}
    reached |= {"max_overlap": float(sums[:, 5].max()) / 2, "converged": bool(mean <= overlap)}
    centers = np.clip(wrap(points[:, :3] * unit, size, periodic), 0.0, size)
    return _inside(centers, size, domain), reached


def _inside(centers, size, domain):
    """Centres that lie beyond the round wall drawn back to it."""
    axes = list(ROUND_AXES[domain])
    if axes:
        middle = size[axes] / 2
        away = np.linalg.norm(centers[:, axes] - middle, axis=1, keepdims=True)
        # A hair less than the radius, so that rounding leaves them inside.
        shrink = np.minimum(1.0, middle[0] * (1 - 1e-15) / np.maximum(away, 1e-300))
        centers[:, axes] = middle + (centers[:, axes] - middle) * shrink
    return centers


def _mobility(radii, fixed):
    """Inverse masses; radii in units of the mean radius."""
    # Mass ~ radius up to the mean, ~ radius squared above: a large particle has as many contacts as its surface holds.
    mobility = 1.0 / np.where(radii < 1.0, radii, radii**2)
    if fixed is not None:
        mobility[fixed] = 0.0
    return mobility


def _fire(power, ff, vv, dt, mix, downhill):
    """Factors of the next FIRE step, v = keep v + push a and x += dt v, and the new pace (dt, mix, downhill)."""
    if power <= 0 and vv > 0:
        return 0.0, dt * DT_CUT, (dt * DT_CUT, MIX, 0)
    if downhill >= DELAY:
        dt, mix = min(dt * DT_GROW, DT_MAX), mix * MIX_FADE
    # Norm of v + dt a, over the norm of a, in the metric of the masses.
    ratio = math.sqrt(max(vv + 2 * dt * power + dt * dt * ff, 0.0) / ff)
    return 1 - mix, (1 - mix) * dt + mix * ratio, (dt, mix, downhill + 1)


def _starting_points(number, size, periodic, domain, rng):
    """Points of a jittered grid inside the domain, (number, 3) float array, m."""
    if domain == "box":
        return _jittered_grid(number, size, periodic, rng)
    axes = list(ROUND_AXES[domain])
    asked = math.ceil(number * np.prod(size) / domain_volume(domain, size))
    while True:
        points = _jittered_grid(asked, size, periodic, rng)
        points = points[np.linalg.norm(points[:, axes] - size[axes] / 2, axis=1) < size[axes[0]] / 2]
        if len(points) >= number:
            return points[:number]
        asked += asked // 20 + 1


def _jittered_grid(number, size, periodic, rng):
    """Points of a nearly cubic grid with at least `number` sites, some left empty at random, moved about."""
    least = np.maximum(1, np.floor(size / np.cbrt(np.prod(size) / number))).astype(np.int64)
    choices = [least + np.array(extra) for extra in product((0, 1), repeat=3)]
    while max(dims.prod() for dims in choices) < number:
        choices = [dims + np.eye(3, dtype=np.int64)[np.argmax(size / dims)] for dims in choices]
    dims = min((dims for dims in choices if dims.prod() >= number), key=np.prod)
    sites = rng.permutation(int(dims.prod()))[:number]
    cells = np.column_stack(np.unravel_index(sites, dims))
    points = (cells + 0.5 + JITTER * rng.uniform(-1, 1, (number, 3))) * size / dims
    # Walls reflect: what would lie beyond one comes back inside.
    inside = np.clip(size - np.abs(size - np.abs(points)), 0.0, size)
    return np.where(periodic, wrap(points, size, periodic), inside)


def _check_request(number, size, phi, periodic, seed, overlap, steps, allow_few):
    if not isinstance(number, int | np.integer) or isinstance(number, bool) or number < 1:
        raise ValueError(f"number = {number!r}: must be an integer >= 1")
    if number < FEWEST and not allow_few:
        raise ValueError(f"number = {number}: fewer than {FEWEST} particles; pass allow_few=True if you mean it")
    finite("phi", phi, "> 0 and <= 0.74, the densest packing of equal spheres", lambda v: 0 < v <= 0.74)
    if not isinstance(seed, int | np.integer) or seed < 0:
        raise ValueError(f"seed = {seed!r}: must be an integer >= 0")
    _check_stop(overlap, steps)
    return check_box(size, periodic)


def _check_stop(overlap, steps):
    finite("overlap", overlap, "a finite part of the mean diameter >= 0", lambda v: v >= 0)
    if not isinstance(steps, int | np.integer) or steps < 0:
        raise ValueError(f"steps = {steps!r}: must be an integer >= 0")
