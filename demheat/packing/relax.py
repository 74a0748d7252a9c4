"""Packings by relaxing overlaps: particles start on a jittered grid and push each other apart.

The minimiser is FIRE (Bitzek et al., Phys. Rev. Lett. 97 (2006) 170201) with symplectic Euler steps. Lengths inside are
in units of the mean radius; stiffness is 1.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from demheat.packing import relax_kernels as kernels
from demheat.packing.base import Packing, check_box, check_domain, make_packing, wrap
from demheat.packing.gate import check_packing
from demheat.packing.neighbours import near_rows
from demheat.packing.radii import Gaussian, distribution
from demheat.powers import cube_root, cubed
from demheat.runtime.limits import check_memory, check_steps
from demheat.runtime.progress import stage
from demheat.scene.bodies import ROUND_AXES, across, domain_volume, from_middle, round_radius
from demheat.scene.inputs import finite, flag, whole
from demheat.scene.shapes.morton import morton_order

# Listed pairs reach this many mean radii beyond contact; a new list is made when two particles could have closed half
# of that each. Found fastest from 0.9 to 1.2 (a list costs about ten steps).
SKIN = 1.1
# That a step takes, of a few particles.
LEAST_SECONDS = 1e-5
# FIRE: time steps in units of sqrt(mass/stiffness) of a mean particle, and the usual factors. Found on 2e4 particles:
# a step above 0.6 or a mixing above 0.3 stalls, the published delay of 5 steps and mixing of 0.1 need 1.4 times longer.
DT, DT_MAX, DT_GROW, DT_CUT = 0.5, 0.6, 1.1, 0.5
MIX, MIX_FADE, DELAY = 0.25, 0.99, 1
# Grid spacings that starting points move at random, each way. One: a uniform shift over a whole number of spacings
# erases the Bragg peak of the grid. At 0.15 the relaxed packing kept it (structure factor 900 instead of 1 at that wave
# vector, <n_x^4> off by 6 standard deviations), which the fabric tensor cannot see: it is isotropic on a cubic grid.
JITTER = 1.0
FEWEST = 100
# Least bytes that a particle takes while it is packed.
BYTES = 150


@dataclass(frozen=True)
class Relaxation:
    """How far `relax` and `settle` go.

    Parameters
    ----------
    overlap : float
        Stop when the mean overlap of the overlapping pairs is below this part of the mean diameter.
    steps : int
        Stop there at the latest; provenance["converged"] then is False and "mean_overlap" says what was reached.
    progress : callable (step, mean overlap), optional

    Raises
    ------
    ValueError
        If a number is negative, or not finite.
    """

    overlap: float = 0.002
    steps: int = 400
    progress: Callable[[int, float], None] | None = None

    def __post_init__(self):
        finite("overlap", self.overlap, "a finite part of the mean diameter >= 0", lambda v: v >= 0)
        whole("steps", self.steps, "an integer >= 0", lambda v: v >= 0)
        check_steps("steps", self.steps, min(self.steps, 1e300), LEAST_SECONDS, remedy="fewer")
        if self.progress is not None and not callable(self.progress):
            raise ValueError(f"progress = {self.progress!r}: must be a function, or None")


def relax(
    number: int,
    *,
    size: Sequence[float] = (1.0, 1.0, 1.0),
    phi: float = 0.64,
    radii=None,
    periodic: bool | Sequence[bool] = True,
    domain: str = "box",
    seed: int = 0,
    allow_few: bool = False,
    **knobs,
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
    allow_few : bool
        Fewer than 100 particles are refused unless this is True.
    overlap, steps, progress
        As in `Relaxation`.

    Returns
    -------
    Packing
        Same bits for the same arguments, whatever the number of threads.

    Raises
    ------
    ValueError
        If an argument is not as described, or a sphere is too large for the box.

    Examples
    --------
    >>> from demheat.packing.relax import relax
    >>> packing = relax(500, phi=0.6, seed=0)
    >>> packing.number, round(packing.phi, 6)
    (500, 0.6)
    """
    radii = Gaussian() if radii is None else distribution(radii)
    goal = Relaxation(**knobs)
    _check_request(number, phi, seed, allow_few)
    size, periodic = check_box(size, periodic)
    check_domain(domain, size, periodic)
    rng = np.random.default_rng(seed)
    centers = _starting_points(int(number), size, periodic, domain, rng)
    drawn = radii.draw(int(number), rng)
    drawn *= cube_root(phi * domain_volume(domain, size) / (4.0 / 3.0 * np.pi * np.sum(cubed(drawn))))
    check_fit(drawn, size, periodic)
    order = morton_order(centers, size)
    with stage("packing") as done:
        centers, reached = _minimise(centers[order], drawn, (size, periodic, domain), goal, done)
    provenance = {"algorithm": "relax", "seed": int(seed), "number": int(number), "phi": float(phi)}
    provenance |= {"radii": repr(radii), "overlap": float(goal.overlap), "steps": int(goal.steps)} | reached
    return make_packing(centers, drawn, size, periodic, provenance, domain=domain)


def settle(
    packing: Packing,
    *,
    fixed: np.ndarray | None = None,
    steps: int = 100,
    overlap: float = 0.0,
    progress: Callable[[int, float], None] | None = None,
) -> Packing:
    """Push overlapping particles of a given packing apart, some of them held fixed."""
    check_packing(packing)
    n = packing.number
    fixed = np.zeros(n, dtype=bool) if fixed is None else np.asarray(fixed)
    if fixed.dtype != bool or fixed.shape != (n,):
        raise ValueError(f"fixed of shape {fixed.shape} and type {fixed.dtype}: must be {n} bools, one per particle")
    goal = Relaxation(overlap, steps, progress)
    check_fit(packing.radii, packing.size, packing.periodic)
    box = (packing.size, packing.periodic, packing.domain)
    with stage("settling") as done:
        centers, reached = _minimise(packing.centers, packing.radii, box, goal, done, fixed=fixed)
    centers[fixed] = packing.centers[fixed]
    return packing._replace(centers=centers, provenance=packing.provenance | {"settled": reached})


def check_fit(radii, size, periodic) -> None:
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


def _minimise(centers, radii, box, goal, done, *, fixed=None):
    """Run FIRE in a box (size, periodic, domain); returns the centres, inside it, and what was reached.

    Told of the share done: `done`.
    """
    size, periodic, domain = box
    unit = float(np.mean(radii))
    spheres, inner = _in_units(centers, radii, box, unit, fixed)
    points, force = spheres.points, np.zeros_like(spheres.velocity)
    chunks = -(-len(points) // kernels.CHUNK)
    sums, farthest = np.empty((chunks, kernels.SUMS)), np.empty(chunks)
    start, lists, moved, row, first = None, 0, 0.0, 16.0, None
    pace = (DT, MIX, 0)
    for step in range(goal.steps + 1):
        if start is None or 2 * moved > SKIN:
            indptr, indices = near_rows(points, inner.size, periodic, skin=SKIN, guess=row)
            start, lists, row = points[:, :3].copy(), lists + 1, len(indices) / len(points)
        kernels.forces(spheres, indptr, indices, inner, force, sums)
        mean = sums[:, kernels.OVERLAP].sum() / max(sums[:, kernels.COUNT].sum(), 1.0) / 2
        if goal.progress is not None:
            goal.progress(step, mean)
        first = first or mean
        done(_share(step, mean, first, goal))
        power, ff, vv = sums[:, : kernels.OVERLAP].sum(axis=0)
        if mean <= goal.overlap or ff == 0.0 or step == goal.steps:
            break
        stride, pace = _fire(power, ff, vv, *pace)
        kernels.move(spheres, start, force, stride, farthest)
        moved = math.sqrt(farthest.max())
    reached = {"iterations": step, "lists": lists, "mean_overlap": float(mean)}
    worst = float(sums[:, kernels.WORST].max()) / 2
    reached |= {"max_overlap": worst, "converged": bool(mean <= goal.overlap)}
    centers = np.clip(wrap(points[:, :3] * unit, size, periodic), 0.0, size)
    return _inside(centers, size, domain), reached


def _share(step, mean, first, goal):
    """The part done of a relaxation, whose overlaps fall about exponentially; between walls they may stay above."""
    fallen = math.log(first / mean) / math.log(first / goal.overlap) if 0 < goal.overlap < mean < first else 0.0
    return max(step / max(goal.steps, 1), min(0.95, fallen))


def _in_units(centers, radii, box, unit, fixed):
    """Spheres at rest and their box as the kernels take them, lengths in mean radii."""
    size, periodic, domain = box
    points = np.column_stack((centers, radii)) / unit
    spheres = kernels.Spheres(points, np.zeros((len(points), 3)), _mobility(points[:, kernels.RADIUS], fixed))
    flags = np.zeros(3)
    flags[list(ROUND_AXES[domain])] = 1.0
    return spheres, kernels.Box(size / unit, np.where(periodic, size / unit, 0.0), flags)


def _inside(centers, size, domain):
    """Centres that lie beyond the round wall drawn back to it."""
    axes = list(ROUND_AXES[domain])
    if axes:
        off, away = across(centers, domain, size), from_middle(centers, domain, size)
        # A hair less than the radius, so that rounding leaves them inside.
        shrink = np.minimum(1.0, round_radius(domain, size) * (1 - 1e-15) / np.maximum(away, 1e-300))
        centers[:, axes] = size[axes] / 2 + off * shrink[:, None]
    return centers


def _mobility(radii, fixed):
    """Inverse masses; radii in units of the mean radius."""
    # Mass ~ radius up to the mean, ~ radius squared above: a large particle has as many contacts as its surface holds.
    mobility = 1.0 / np.where(radii < 1.0, radii, radii**2)
    if fixed is not None:
        mobility[fixed] = 0.0
    return mobility


def _fire(power, ff, vv, dt, mix, downhill):
    """The next step and the new pace (dt, mix, downhill)."""
    if power <= 0 and vv > 0:
        return kernels.Step(0.0, dt * DT_CUT, dt * DT_CUT), (dt * DT_CUT, MIX, 0)
    if downhill >= DELAY:
        dt, mix = min(dt * DT_GROW, DT_MAX), mix * MIX_FADE
    # Norm of v + dt a, over the norm of a, in the metric of the masses.
    ratio = math.sqrt(max(vv + 2 * dt * power + dt * dt * ff, 0.0) / ff)
    return kernels.Step(1 - mix, (1 - mix) * dt + mix * ratio, dt), (dt, mix, downhill + 1)


def _starting_points(number, size, periodic, domain, rng):
    """Points of a jittered grid inside the domain, (number, 3) float array, m."""
    if domain == "box":
        return _jittered_grid(number, size, periodic, rng)
    asked = math.ceil(number * np.prod(size) / domain_volume(domain, size))
    while True:
        points = _jittered_grid(asked, size, periodic, rng)
        points = points[from_middle(points, domain, size) < round_radius(domain, size)]
        if len(points) >= number:
            return points[:number]
        asked += asked // 20 + 1


def _jittered_grid(number, size, periodic, rng):
    """Points of a nearly cubic grid with at least `number` sites, some left empty at random, moved about."""
    least = np.maximum(1, np.floor(size / cube_root(np.prod(size) / number))).astype(np.int64)
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


def _check_request(number, phi, seed, allow_few):
    whole("number", number, "an integer >= 1", lambda v: v >= 1)
    flag("allow_few", allow_few)
    if number < FEWEST and not allow_few:
        raise ValueError(f"number = {number}: fewer than {FEWEST} particles; pass allow_few=True if you mean it")
    check_memory("number", number, BYTES * int(number))
    finite("phi", phi, "> 0 and <= 0.74, the densest packing of equal spheres", lambda v: 0 < v <= 0.74)
    whole("seed", seed, "an integer >= 0", lambda v: v >= 0)
