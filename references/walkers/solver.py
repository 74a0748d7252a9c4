"""A scene's conductivity along its load by walkers."""

from dataclasses import dataclass, field

import numpy as np

from demheat.runtime.deadline import budget, look
from demheat.runtime.process_state import one_blas_thread
from demheat.runtime.progress import stage
from demheat.scene import Scene, check_scene
from demheat.scene.inputs import finite, whole
from demheat.scene.symmetry import alike_axes
from references.walkers.steps import CLOCK, PLACE, RESISTED, SQUARE, advance, medium, start
from references.walkers.sums import chosen, products, ways
from references.walkers.surfaces import Surfaces

# Walkers that walk together: each batch has random numbers of its own.
TOGETHER = 8000
# Marks that a walker passes, so much of the square of the longest side over the matrix's diffusivity apart, and longest
# lags in marks: walkers between reflecting walls at that distance forget where they were by exp(-pi^2 0.02) a mark.
MARKS, MARK, LAGS = 30, 0.02, (5, 10, 20)
# The radius of balls on surfaces is by default this part of the bodies' own, for so many walks; it falls with their
# fourth root, so that its square falls as the scatter does.
PART, WALKS = 0.1, 8000
# Of the conductivity: what balls make it wrong by, as found, over the square of their part of a body's own radius.
BIAS = 0.1
# Standard errors on either side: 95 of 100 intervals.
WIDE = 1.96
# Inclusions up to which it is asked whether axes conduct alike.
FEW = 8


@dataclass(frozen=True)
class Walked:
    """A conductivity found by walkers."""

    conductivity: float  # W/(m K)
    # W/(m K): Standard error of the mean over the walks; it falls as one over the square root of their number
    error: float
    bias: float  # W/(m K): What the balls on surfaces may make it wrong by; it falls as the square of their radius
    # `walks`, `radius` (m) of the balls on surfaces, `steps` of all walkers, `axes` alike that were averaged, longest
    # `lag` that was counted
    stats: dict = field(repr=False, default_factory=dict)

    @property
    def lower(self) -> float:
        """Lower end of the interval that holds the conductivity 95 times of 100, W/(m K)."""
        return max(self.conductivity - WIDE * self.error - self.bias, 0.0)

    @property
    def upper(self) -> float:
        """Upper end of the interval, W/(m K)."""
        return self.conductivity + WIDE * self.error + self.bias


def solve(
    scene: Scene,
    *,
    walks: int = WALKS,
    radius: float | None = None,
    seed: int = 0,
    seconds: float | None = None,
) -> Walked:
    """Find the conductivity of a scene along its load by Brownian walkers.

    Nothing is divided into elements: walkers ask how far the nearest surface is, leap that far, and beside a surface
    choose a side by what both conduct.

    Parameters
    ----------
    scene : Scene
        Shapes of any kind in a periodic cell or between two opposite walls that are held, without resistances;
        conductivity 0 is a pore.
    walks : int
        From 100; the cost is in proportion to it, and to the contrast of good conductors to what they lie in.
    radius : float, m, optional
        Of the balls on surfaces in which walkers choose a side. By default a tenth of the bodies' own radius at 8000
        walks, and less at more, so that what it makes wrong falls as fast as the scatter does.
    seed : int
        With which the walks are drawn.
    seconds : float, s, optional
        That it may take, see `demheat.budget`; then TimeoutError.

    Returns
    -------
    Walked

    Raises
    ------
    ValueError
        If an argument is not as described.
    NotImplementedError
        For other loads, images, tensors, resistances, or conductivities that follow the temperature.

    Examples
    --------
    >>> from demheat import gallery
    >>> from references import walkers
    >>> found = walkers.solve(gallery.sphere_in_cube(0.2), walks=400, radius=0.01)
    >>> found.lower < 27.7107 < found.upper, found.error < 0.1  # of one by an exact form
    (True, True)
    """
    with budget(seconds):
        whole("walks", walks, "an integer >= 100", lambda v: v >= 100)
        whole("seed", seed, "an integer >= 0", lambda v: v >= 0)
        check_scene(scene)
        scene.require("walkers know one pair of held walls", steady=True, walls="one isothermal pair")
        if radius is None:
            radius = PART * (WALKS / walks) ** 0.25 * own_radius(scene)
        else:
            radius = finite("radius", radius, "a length > 0 m", lambda v: v > 0)
        stats = {"walks": walks, "radius": radius, "steps": 0, "axes": 3, "lag": 0}
        if len(set(scene.conductivities.tolist())) == 1:
            return Walked(float(scene.conductivities[0]), 0.0, 0.0, stats)
        return _solved(scene, stats, seed)


def _solved(scene, stats, seed):
    """The answer where there is something to choose, with what is asked for in `stats`."""
    walks, radius, directions = stats["walks"], stats["radius"], directions_of(scene)
    through, surfaces = medium(scene, radius, directions), Surfaces(scene, 2 * radius)
    # The order of BLAS's sums, and so the last bits, is that of its threads.
    with one_blas_thread():
        own, steps = _walked(surfaces, through, walks, seed)
        mean, error, lag = chosen(own if scene.conductivities.all() else own[..., :3])
    unit = through.unit * through.mean_capacity
    k, bias = max(unit * mean, 0.0), BIAS * (radius / own_radius(scene)) ** 2
    stats |= {"steps": steps, "axes": len(directions), "lag": LAGS[lag]}
    return Walked(k, unit * error, bias * k, stats)


def own_radius(scene: Scene) -> float:
    """Half the least width of any body, four times that of flat ones, or the longest side without bodies, m."""
    longest = max(scene.size)
    halves = [(2.0 if shape.flat else 0.5) * min(shape.width, longest) for shape in scene.inclusions]
    return min(halves, default=longest)


def directions_of(scene: Scene) -> np.ndarray:
    """Directions along which the conductivity is that along the load, (1 to 3, 3) float array."""
    load = np.array(scene.gradient) if scene.periodic else np.eye(3)[scene.axis]
    load /= np.linalg.norm(load)
    alike = alike_axes(scene) if len(scene.inclusions) <= FEW else (0, 1, 2)
    axes = np.flatnonzero(np.abs(load) > 0)
    if len({alike[axis] for axis in axes}) == 1 and (len(axes) == 1 or len(set(alike)) == 1):
        return np.eye(3)[[axis for axis in range(3) if alike[axis] == alike[axes[0]]]]
    return load[None]


def _walked(surfaces, through, walks, seed):
    """What each walker says, a batch after the other, and how many steps all made."""
    found, steps, mark = [], 0, MARK * float(max(surfaces.size)) ** 2
    with stage("walks") as done:
        for number, first in enumerate(range(0, walks, TOGETHER)):
            rng = np.random.default_rng([seed, number])
            own, made = _batch(surfaces, through, (min(TOGETHER, walks - first), mark), rng)
            found.append(own)
            steps += made
            done(min(first + TOGETHER, walks) / walks)
    return np.concatenate(found, axis=1), steps


def _batch(surfaces, through, wanted, rng):
    """What the walkers of a batch say, over the time of all marks, and how many steps they made."""
    count, mark = wanted
    place, phase = start(surfaces, through, count, rng)
    total = np.zeros((count, through.columns[1].stop))
    total[:, PLACE] = place
    record = np.empty((MARKS + 1, count, RESISTED.stop))
    record[0] = total[:, : RESISTED.stop]
    ends, walker, passed, steps = np.empty_like(total), np.arange(count), np.zeros(count, np.int64), 0
    while len(walker):
        total += advance(surfaces, through, total[:, PLACE], phase, rng)
        steps += len(walker)
        late = np.flatnonzero(total[:, CLOCK] >= (passed + 1) * mark)
        if not len(late):
            continue
        while len(late):
            passed[late] += 1
            record[passed[late], walker[late]] = total[late, : RESISTED.stop]
            late = late[(passed[late] < MARKS) & (total[late, CLOCK] >= (passed[late] + 1) * mark)]
        over = passed == MARKS
        if over.any():
            ends[walker[over]] = total[over]
            total, phase, walker, passed = (each[~over] for each in (total, phase, walker, passed))
        look("walks")
    both, own = through.columns
    squares = ends[:, SQUARE], ends[:, both], ends[:, own]
    drift = 2 * ends[:, CLOCK] / through.mean_capacity
    said = products(ways(record, through.directions), squares, drift, LAGS)
    return said / (2 * ends[:, CLOCK].mean()), steps
