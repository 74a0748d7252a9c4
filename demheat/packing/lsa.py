"""Packings by the Lubachevsky-Stillinger algorithm: hard spheres move, collide and grow until they are dense enough.

Source: B. D. Lubachevsky, F. H. Stillinger, J. Stat. Phys. 60 (1990) 561. All spheres have mass 1 whatever their size
and all radii grow in proportion.
"""

import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from demheat.packing.base import Packing, check_box, check_domain, make_packing
from demheat.packing.gate import check_packing
from demheat.packing.motion import Motion
from demheat.packing.radii import Gaussian, Listed, distribution
from demheat.packing.relax import FEWEST, relax
from demheat.powers import cube_root, cubed
from demheat.runtime.limits import check_memory
from demheat.runtime.progress import stage
from demheat.scene.inputs import finite, flag, reals, whole

# Packing fraction at which spheres begin to move, and the most it may be of the one asked for. Started denser, the
# spheres have no time to arrange themselves: 1e4 of them with spread 0.3 then jam at 0.6538 (start at 0.55) or 0.651
# (0.60) instead of 0.6558 (0.4; spheropack, which starts from points: 0.6559).
START, START_OF_TARGET, START_OVERLAP = 0.4, 0.6, 1e-4
# Reduced pressure at which packings count as jammed: the radii could grow by some 1e-6 more.
JAMMED = 1e6
# Beyond it gaps are the rounding of places.
MOST_PRESSURE = 1e12
# Spheres that grow so much faster than they move do not move at all.
FASTEST = 1e3
# Below this the first windows of 10 collisions per sphere, from the start at phi = 0.4, are beyond it already.
LEAST_PRESSURE = 10.0
# No mixture of up to 1 : 10 was found to jam denser.
DENSEST = 0.85
# Collisions per sphere until a reduced pressure p are COLLISIONS log10(p / 5) / growth: found within a fifth for growth
# 0.002 to 0.1 and pressures 30 to 1e12. A collision takes some 2 microseconds. In the fluid before, up to the packing
# fraction of that pressure, they follow from the equation of state: see `_in_fluid`.
COLLISIONS, FIRST_PRESSURE, FIRST_PHI = 3.4, 5.0, 0.343
# There new lists of neighbours, as spheres fly far, take longer than collisions: so many of them per sphere while the
# diameter grows by itself, at growth 1; found within a quarter for phi 0.05 and 0.3.
LISTS = 18.0
# Least bytes that a sphere takes.
BYTES = 200
# Sides over the largest radius, for a periodic axis or walls: spheres must not meet both ways round a period.
LEAST_SIDES = {True: 4.2, False: 2.0}


@dataclass(frozen=True)
class Growth:
    """How fast the spheres of `lsa` grow, and how far.

    Parameters
    ----------
    phi : float, optional
        Stop at this packing fraction, met to rounding.
    pressure : float, optional
        Stop after the first 10 collisions per sphere whose mean reduced pressure P V / (N k T) reaches this; 10 to
        1e12, default 1e6 (jammed) unless `phi` is given. With both, what comes first stops. Radii of very unequal
        spheres, of which few collide often, overshoot.
    growth : float or sequence of (reduced pressure, rate)
        Growth rate of the mean diameter over the thermal velocity; of a sequence, each rate holds from its pressure on.
        Slower growth jams denser and takes longer.
    most : float
        Collisions, of all spheres, that it may take: half an hour for 1e9, the default. What is estimated to take more
        is refused; twice as many end it.
    progress : callable (collisions per sphere, packing fraction, reduced pressure), optional

    Raises
    ------
    ValueError
        If a number is not as described.
    """

    phi: float | None = None
    pressure: float | None = None
    growth: float | Sequence[tuple[float, float]] = 0.02
    progress: Callable[[float, float, float], None] | None = None
    most: float = 1e9

    def __post_init__(self):
        object.__setattr__(self, "growth", _checked_stages(self.growth))
        if self.phi is not None:
            object.__setattr__(self, "phi", finite("phi", self.phi, "> 0 and < 1", lambda v: 0 < v < 1))
        pressure = JAMMED if self.phi is None and self.pressure is None else self.pressure
        if pressure is not None:
            valid = f">= {LEAST_PRESSURE:g} and <= {MOST_PRESSURE:g}; give phi for a thinner gas"
            pressure = finite("pressure", pressure, valid, lambda v: LEAST_PRESSURE <= v <= MOST_PRESSURE)
        object.__setattr__(self, "pressure", pressure)
        if self.progress is not None and not callable(self.progress):
            raise ValueError(f"progress = {self.progress!r}: must be a function, or None")
        finite("most", self.most, "a finite number of collisions > 0", lambda v: v > 0)

    def rate(self, reached: float) -> float:
        """Growth rate of the last stage whose pressure is reached, of the first before that."""
        return max((stage for stage in self.growth if stage[0] <= reached), default=self.growth[0])[1]

    def check_length(self, number: int, begun: float) -> None:
        """Raise ValueError if spheres are estimated to collide more often than `most`."""
        reach = JAMMED if self.pressure is None else self.pressure
        if self.phi is not None:  # Carnahan and Starling, J. Chem. Phys. 51 (1969) 635
            reach = min(reach, (1 + self.phi + self.phi**2 - cubed(self.phi)) / cubed(1 - self.phi))
        ends = [min(from_, reach) for from_, _ in self.growth[1:]] + [reach]
        thin = FIRST_PHI if self.phi is None else min(self.phi, FIRST_PHI)
        begun = min(begun, thin)
        count = (_in_fluid(begun, thin) + LISTS * (cube_root(thin / begun) - 1)) / self.growth[0][1]
        begin = FIRST_PRESSURE
        for (_, rate), end in zip(self.growth, ends, strict=True):
            if end > begin:
                count, begin = count + COLLISIONS * math.log10(end / begin) / rate, end
        if count * number > self.most:
            raise ValueError(
                f"growth = {self.growth if len(self.growth) > 1 else self.growth[0][1]}: takes some {count:.2g} "
                f"collisions, or as long, for each of {number} spheres, {count * number:.2g} in all; must be faster by "
                f"{count * number / self.most:.2g}, or give most, now {self.most:g}"
            )


def _in_fluid(begun, phi):
    """Collisions per sphere, times the growth rate, from one packing fraction to another.

    Of equal spheres, (Z - 1) 3 / sqrt(pi) while the diameter grows by a factor e, with Z by Carnahan and Starling. Of
    the unequal ones of `Gaussian` a quarter fewer were found.
    """
    one, two = (1 / (1 - each) ** 2 + 2 / (1 - each) for each in (begun, phi))
    return (two - one) / math.sqrt(math.pi)


def lsa(
    number: int | None = None,
    *,
    size: Sequence[float] = (1.0, 1.0, 1.0),
    radii=None,
    periodic: bool | Sequence[bool] = True,
    domain: str = "box",
    seed: int = 0,
    start: Packing | None = None,
    allow_few: bool = False,
    **knobs,
) -> Packing:
    """Pack spheres without overlap by letting them grow while they move and collide.

    Parameters
    ----------
    number, size, radii, periodic, domain, seed, allow_few
        As in `relax`.
    start : Packing, optional
        Begin from these spheres in their domain (`number`, `size`, `radii`, `periodic` and `domain` are then left out)
        instead of a relaxed packing at phi = 0.4 or 0.6 of the one asked for. All radii are shrunk until no two
        overlap, at most by half.
    phi, pressure, growth, progress, most
        As in `Growth`: when to stop, and how fast to get there.

    Returns
    -------
    Packing
        No two spheres overlap, nor a sphere and a wall. Same bits for the same arguments, whatever the processor and
        the number of threads. `provenance` has the packing fraction and the reduced pressure reached, collisions and
        events per sphere, and what stopped it.

    Raises
    ------
    ValueError
        If an argument is not as described, the box is too small for the largest spheres, or those of `start` overlap
        by more than half; or if more collisions than `most` are to be expected.
    RuntimeError
        If the spheres jam (reduced pressure 1e6) before `phi`; the message says at which packing fraction. If events
        go on without end, or collisions beyond twice `most`.

    Warns
    -----
    UserWarning
        If the sphere radii had to be shrunk by more than rounding to leave no overlap.

    Examples
    --------
    >>> from demheat.packing.lsa import lsa
    >>> packing = lsa(200, phi=0.5, seed=0)
    >>> packing.number, round(packing.phi, 6)
    (200, 0.5)
    """
    goal = Growth(**knobs)
    _check_seed(seed)
    if start is None:
        radii = Gaussian() if radii is None else distribution(radii)
        size, periodic = _check_request(number, size, periodic, domain, radii, allow_few)
        begin = START if goal.phi is None else min(START, START_OF_TARGET * goal.phi)
        goal.check_length(number, begin)
        start = relax(
            number, size=size, phi=begin, radii=radii, periodic=periodic, domain=domain, seed=seed,
            overlap=START_OVERLAP, allow_few=allow_few,
        )  # fmt: skip
    else:
        _check_alone(start, number, size, radii, periodic, domain)
        goal.check_length(start.number, start.phi)
    motion = Motion(start, np.random.default_rng([seed, 1]))
    _check_room(start, motion.phi, goal.phi)
    with stage("growing") as done:
        stopped = _grow(motion, goal, done)
    centers, radii_now, shrunk = motion.packing()
    if shrunk > 1e-10:
        warnings.warn(f"radii were shrunk by {shrunk:.1e} of themselves to leave no overlap", stacklevel=2)
    provenance = {"algorithm": "lsa", "seed": int(seed), "number": start.number, "start": start.provenance}
    provenance |= {"growth": [list(stage) for stage in goal.growth], "stopped_by": stopped} | motion.reached()
    provenance |= {"start_shrunk": motion.start_shrunk, "shrunk": shrunk}
    return make_packing(centers, radii_now, start.size, start.periodic, provenance, domain=start.domain)


def _grow(motion, goal, done):
    """Run until the goal is reached; returns what stopped it, or raises RuntimeError if the spheres jam before."""
    phi, windows, limit, begun = goal.phi, 0, JAMMED if goal.pressure is None else goal.pressure, motion.phi
    while phi is None or motion.phi < phi * (1 - 1e-14):
        reached = motion.pressure if windows else 0.0
        if not motion.run(goal.rate(reached), phi):
            continue
        windows += 1
        if motion.collisions > 2 * goal.most:
            raise RuntimeError(
                f"phi = {motion.phi:.6f}, reduced pressure {motion.pressure:.2e} after {motion.collisions} collisions: "
                f"twice most = {goal.most:g}; let the spheres grow faster"
            )
        done(_share(motion, begun, phi, limit))
        if goal.progress is not None:
            goal.progress(motion.collisions / len(motion.spheres), motion.phi, motion.pressure)
        # The first window may begin with many collisions of spheres that nearly touch.
        if windows > 1 and motion.pressure >= limit:
            if goal.pressure is None:
                raise RuntimeError(
                    f"phi = {phi} not reached: the spheres jam at phi = {motion.phi:.6f}, reduced pressure "
                    f"{motion.pressure:.2e}; ask for less, or let them grow more slowly"
                )
            return "pressure"
    return "phi"


def _share(motion, begun, phi, limit):
    """The part done: of the radii's growth, or on the way to the pressure, which rises about exponentially."""
    grown = (motion.phi - begun) / (phi - begun) if phi is not None and phi > begun else 0.0
    pressed = math.log(motion.pressure) / math.log(limit) if motion.pressure > 1.0 else 0.0
    return min(1.0, max(grown, pressed))


def _check_alone(start, number, size, radii, periodic, domain):
    """A start brings its own spheres and domain: raise ValueError for anything else that says so too."""
    check_packing(start, "start")
    given = {"number": number not in (None, start.number), "size": tuple(size) != (1.0, 1.0, 1.0)}
    given |= {"radii": radii is not None, "periodic": periodic is not True, "domain": domain != "box"}
    if any(given.values()):
        names = ", ".join(name for name, is_given in given.items() if is_given)
        raise ValueError(f"{names}: must be left out with a start, which has its own")


def _check_request(number, size, periodic, domain, radii, allow_few):
    whole("number", number, "an integer >= 2", lambda v: v >= 2)
    flag("allow_few", allow_few)
    if number < FEWEST and not allow_few:
        raise ValueError(f"number = {number}: fewer than {FEWEST} spheres; pass allow_few=True if you mean it")
    check_memory("number", number, BYTES * int(number))
    if isinstance(radii, Listed) and len(radii.values) != number:
        raise ValueError(f"radii: {len(radii.values)} of them for number = {number} spheres; must be one each")
    sides, flags = check_box(size, periodic)
    check_domain(domain, sides, flags)
    return sides, flags


def _check_seed(seed):
    whole("seed", seed, "an integer >= 0", lambda v: v >= 0)


def _checked_stages(growth):
    """Growth as a list of stages, [reduced pressure from which it holds, rate]."""
    valid = f"a rate > 0, or pairs of ascending pressures and rates > 0; all at most {FASTEST:g}"
    single = np.ndim(growth) == 0
    stages = reals("growth", [(0.0, finite("growth", growth, valid))] if single else growth, valid)
    good = stages.ndim == 2 and stages.shape[1] == 2 and len(stages) > 0 and np.all(np.isfinite(stages))
    rates = stages[:, 1] if good else np.empty(0)
    if not (good and np.all((rates > 0) & (rates <= FASTEST)) and np.all(np.diff(stages[:, 0]) > 0)):
        raise ValueError(f"growth = {growth!r}: must be {valid}")
    return stages.tolist()


def _check_room(start, now, phi):
    """Raise ValueError if the start is denser than the target, or its largest spheres would meet both ways round."""
    if phi is not None and now > phi:
        raise ValueError(f"phi = {phi}: must be at least that of the start without overlaps, {now:.6g}")
    most = DENSEST if phi is None else phi
    largest = float(np.max(start.radii)) * cube_root(most / start.phi)
    for axis in range(3):
        # Along a period only the nearest image is seen; a little room, since lists reach beyond contact.
        least = LEAST_SIDES[bool(start.periodic[axis])] * largest
        if start.size[axis] < least:
            raise ValueError(
                f"size = {start.size.tolist()}: side {axis} must be >= {least:.6g} for spheres of radius up to "
                f"{largest:.6g} at phi = {most}{'' if phi else ' (as dense as they may jam)'}; use more spheres, a "
                "narrower distribution or a thicker box"
            )
