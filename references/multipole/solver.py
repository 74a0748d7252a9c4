"""Rayleigh's multipole method for any number of spheres in a periodic cell, or in a box between two isothermal walls.

Rayleigh (1892); McPhedran and McKenzie, Proc. R. Soc. A 359 (1978) 45; Sangani and Acrivos, Proc. R. Soc. A 386 (1983)
263. The spheres may differ in radius and conductivity. The only errors are those of the highest degree kept, which
is stated, of the linear solve, and where there are many spheres, of what their cells make at each other, below both. A
scene becomes spheres in `arrangement`, their mirror images in walls included; who makes what at whom is chosen in
`exchange`: periodic sums of `sums` for all pairs in `translations`, or cells in `fast`; the linear system is in
`system`, the choice of the order in `truncation`, pairs that nearly touch in `contacts`, values at points in `field`;
zeta_2 in `third_order`.
"""

import math

import numpy as np

from demheat.error import known
from demheat.field import Field, Samples
from demheat.runtime.deadline import budget
from demheat.runtime.process_state import one_blas_thread
from demheat.scene import Scene, check_scene
from demheat.scene.inputs import finite, whole
from demheat.tensor import axis_loads
from references.midpoints import check_points_per_axis, midpoints
from references.multipole.arrangement import arrange, smallest_gap
from references.multipole.at_rest import at_rest
from references.multipole.field import Evaluator
from references.multipole.nearest_images import beside
from references.multipole.third_order import check_order
from references.multipole.truncation import ACCURACY, by_images, converged, field_truncation, inexactness
from references.threads import MOST_THREADS

# Of the accuracy: the rest is for higher degrees and for exchange by cells.
MOST_TOLERANCE = 0.9


def solve(
    scene: Scene,
    *,
    order: int | None = None,
    accuracy: float | None = None,
    tolerance: float | None = None,
    points_per_axis: int = 24,
    threads: int = 1,
    seconds: float | None = None,
) -> Field:
    """Solve a scene of disjoint spheres: a periodic cell, or a box between two isothermal walls, else insulated.

    Parameters
    ----------
    scene : Scene
        Spheres may differ in radius, conductivity and resistance of the surface; they may cross the faces of a
        periodic cell, walls may cut them in halves only.
    order : int, optional
        Highest degree of the multipoles. By default it is raised until the conductivity is known to `accuracy`, and
        where spheres touch, or so nearly that no degree would do, near pairs are solved by all degrees. With an order
        given nothing is refused: `stats["truncation"]` says what error remains.
    accuracy : float, optional
        Relative, of the mean flux, by default 1e-5: half of the conductivity's interval (`Field.error`) is within it.
        With an order given it only says how exactly that is solved, by default to 1e-10: with 1e-3 the conductivity of
        83 spheres changes by 3e-7, at an eighth of the cost.
    tolerance : float, optional
        Relative residual of the linear system; by default a thousandth of the accuracy, or 1e-10 with an order alone.
    points_per_axis : int
        The samples are the midpoints of so many equal cells along each axis.
    threads : int
    seconds : float, s, optional
        That it may take, see `demheat.budget`; then TimeoutError. What is asked of the result is not in it.

    Returns
    -------
    Field
        The temperature of a periodic cell is the mean gradient times the position plus a periodic part of zero mean. Of
        its `stats`, `truncation` is the relative error of the mean flux that higher degrees would remove, extrapolated
        from the last changes as gaps ask for, `inexactness` that of degrees kept: half of the interval is their sum;
        `field_truncation` the largest term of the last two degrees in the flux at an interface, over the mean gradient;
        `smallest_gap` in metres, mirror images included; `pairs` how many near ones are solved by all
        degrees, 0 where that need not be; `convergence` pairs (order, conductivity). In gaps of such pairs the flux at
        points lacks what is beyond the order.

    Raises
    ------
    ValueError
        If an argument is out of range, or perfect conductors join two temperatures.
    NotImplementedError
        For other walls, layers, nested spheres, spheres cut by a wall beside their centre.
    RuntimeError
        If the linear solve does not converge, or no order that fits into memory is enough for the accuracy.

    Examples
    --------
    >>> from demheat import gallery
    >>> from references import multipole
    >>> print(f"{multipole.solve(gallery.sphere_in_cube(5.0)).conductivity:.3f}")  # exactly 42.640
    42.640
    """
    with budget(seconds):
        _check_knobs(order, accuracy, tolerance, points_per_axis, threads)
        check_scene(scene)
        scene.require(steady=True, takes=("resistance", "perfect"))
        wanted = {"order": order, "accuracy": accuracy, "tolerance": tolerance, "threads": threads}
        return _solved(scene, points_per_axis, wanted)


def solve_axes(
    scene: Scene,
    *,
    order: int | None = None,
    accuracy: float | None = None,
    tolerance: float | None = None,
    points_per_axis: int = 24,
    threads: int = 1,
    seconds: float | None = None,
) -> tuple[Field, Field, Field]:
    """Solve a scene of disjoint spheres for loads along x, y and z; what they make at each other is summed once.

    The fields are those that `solve` finds for the scenes of `demheat.tensor.axis_loads`, to the residual of the linear
    system: sums for a higher degree than one load needs are those of all.
    """
    with budget(seconds):
        _check_knobs(order, accuracy, tolerance, points_per_axis, threads)
        wanted = {"order": order, "accuracy": accuracy, "tolerance": tolerance, "threads": threads}
        wanted |= {"kept": {}}
        return tuple(_solved(load, points_per_axis, wanted) for load in axis_loads(scene))


def _solved(scene, points_per_axis, wanted):
    """The Field of a scene, its multipoles `converged` as wanted."""
    arrangement = arrange(scene, any_matrix=True)
    if scene.matrix.conductivity == 0:
        return at_rest(scene, arrangement.spheres, points_per_axis)
    # The order of BLAS's sums, and so the last bits, is that of its threads; here more of them gain nothing.
    with one_blas_thread():
        history = converged(arrangement, **wanted)
    return _field(scene, arrangement, history, points_per_axis)


def _field(scene, arrangement, history, points_per_axis):
    (spheres, gradient, level, unit), conductivities, made = arrangement, scene.conductivities, []
    # Slopes in perfect conductors are the limit of s times them.
    conductivities[np.isinf(conductivities)] = scene.matrix.conductivity
    inclusion = np.append(spheres.original + 1, 0)

    @one_blas_thread()
    def at(points):
        # The waves' amplitudes are worth their time only if the field is asked for.
        if not made:
            made.append(Evaluator(spheres, history[-1], gradient))
        values, owner = made[0](points / unit)
        phase = inclusion[owner]
        return level + values[:, 0], -conductivities[phase][:, None] * values[:, 1:] / unit, phase

    def sampler():
        points, volumes = midpoints(scene, points_per_axis)
        temperature, flux, phase = at(points)
        return Samples(points, volumes, temperature, phase.astype(np.int32), flux)

    # What mirror images share with their originals' box is what these share with the images'.
    shares = np.bincount(spheres.original, 4 / 3 * math.pi * spheres.radii**3, spheres.count) / np.prod(spheres.size)
    mean_flux = scene.matrix.conductivity * history[-1].mean_flux / unit
    return Field(
        scene=scene,
        mean_flux=mean_flux,
        fractions=np.concatenate([[1 - shares.sum()], shares]),
        sampler=sampler,
        temperature_at=lambda points: at(points)[0],
        flux_at=lambda points: at(points)[1],
        wall_temperature=scene.wall_temperatures,
        wall_heat={name: _entering(scene, name, mean_flux) for name in scene.walls or {}},
        stats=_stats(scene, arrangement, history),
        estimator=_degrees,
    )


def _degrees(field):
    """What higher degrees would remove, and what may hide in how exactly those kept are solved."""
    stats, widest = field.stats, max((each.radius for each in field.scene.inclusions), default=0.0)
    slope = field.scene.gradient if field.scene.periodic else np.ptp(list(field.wall_temperature.values()))
    slope = np.linalg.norm(slope) / (1.0 if field.scene.periodic else field.scene.size[field.scene.axis])
    relative = stats["truncation"] + stats["inexactness"]
    return known(field, relative, "higher degrees", temperature=float(stats["field_truncation"] * slope * widest))


def _entering(scene, name, mean_flux):
    """Heat through a wall, W: as the sides are insulated, every section across the load passes the mean flux."""
    axis, sign = "xyz".index(name[0]), 1 if name[1] == "-" else -1
    return float(sign * mean_flux[axis] * scene.volume / scene.size[axis])


def _stats(scene, arrangement, history):
    spheres, gradient, _, unit = arrangement
    last, k = history[-1], -scene.matrix.conductivity / ((gradient @ gradient) or math.nan)
    return {
        "order": last.order,
        "unknowns": spheres.count * ((last.order + 1) ** 2 - 1),
        "iterations": last.iterations,
        "residual": last.residual,
        "inexactness": inexactness(last),
        "truncation": by_images(history, beside(spheres)).left,
        "field_truncation": field_truncation(spheres, last, gradient),
        "smallest_gap": smallest_gap(spheres) * unit,
        "pairs": last.pairs,
        "convergence": tuple((solved.order, float(k * solved.mean_flux @ gradient)) for solved in history),
    }


def _check_knobs(order, accuracy, tolerance, points_per_axis, threads):
    if order is not None:
        check_order(order)
    for name, value in (("accuracy", accuracy), ("tolerance", tolerance)):
        if value is not None:
            finite(name, value, "a number from 1e-14 to below 1", lambda v: 1e-14 <= v < 1)
    wanted = ACCURACY if accuracy is None else accuracy
    if order is None and tolerance is not None and tolerance > MOST_TOLERANCE * wanted:
        raise ValueError(f"tolerance = {tolerance:g}: must be <= {MOST_TOLERANCE} of the accuracy, {wanted:g}")
    check_points_per_axis(points_per_axis)
    valid = f"an integer >= 1; at most {MOST_THREADS}"
    whole("threads", threads, valid, lambda v: 1 <= v <= MOST_THREADS)
