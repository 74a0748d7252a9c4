"""The discrete element method in time: a packing, its network of conductances, and fields while it warms up."""

from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np

from demheat.conduction.integrators.choose import check_linear
from demheat.conduction.integrators.march import check_request
from demheat.conduction.sources import check_sources, lost_power, source_power, transits
from demheat.conduction.transient import check_callables
from demheat.conduction.transient import evolve as evolve_network
from demheat.dem.estimate import estimator_of
from demheat.dem.networks import network_of
from demheat.dem.options import Particles, check_fits
from demheat.dem.warm import Helper, parts_of
from demheat.field import Field
from demheat.laws import Calibrated, Choices, Laguerre, Platonic
from demheat.packing.base import Packing
from demheat.sampling.field_of import field_of
from demheat.scene import Scene, check_scene


def evolve(
    scene: Scene,
    times: Sequence[float],
    *,
    law: str | Laguerre | Calibrated | Platonic = "laguerre",
    particles: int = 100_000,
    seed: int = 0,
    integrator: str = "auto",
    accuracy: float = 1e-3,
    step: float | None = None,
    conforming: bool | None = None,
    interface: str | None = None,
    gap_spacing: float | None = None,
    sparse: str | None = None,
    wall: str | None = None,
    coordination: float | None = None,
    gap: float | None = None,
    packing: Packing | None = None,
    replicas: int | None = None,
    allow_few: bool = False,
) -> Iterator[Field]:
    """Conduction in time by the discrete element method, from the scene's initial temperature at time 0.

    Steps end where functions of time on the walls jump and where moving sources meet and leave the body, and are short
    where those change fast. Functions are sampled at a thousand equal parts of the run from time 0 to the last one
    asked for: what is not seen is a pulse narrower than that, or of less than 2 % of the function's range.

    Pores, of conductivity 0, exchange no heat: they keep their initial temperature and what sources put into them. A
    source heats the whole body that it covers, pores included, which then grow hot without end.

    Parameters
    ----------
    scene : Scene
        With an initial temperature, densities and heat capacities; its loads may depend on time.
    times : sequence of float, s
        Increasing, >= 0.
    law : Laguerre, Calibrated, Platonic or {"laguerre", "calibrated", "platonic"}
        As in `solve`; the Platonic law has its own capacities, which sum to the body's only by chance. C_t is that
        between the body's flat walls, or for a sphere that of a cube of the same volume, packed anew with the same
        radii. With `wall = "center"` particles at a wall with a temperature are held at it, as in the papers, and their
        own heat counts as the wall's.
    particles, seed : int
        As in `solve`.
    integrator : {"auto", "euler", "rkl2", "tr-bdf2", "tr-bdf2-multigrid"}
        The papers' explicit Euler at its largest stable step, Runge-Kutta-Legendre super-steps, or the implicit TR-BDF2
        with conjugate gradients preconditioned by the diagonal or by multigrid; "auto" takes what should cost least.
    accuracy : float
        Temporal error, rms, of the temperature span; explicit Euler has what its step gives. Under moving sources steps
        are a tenth of the time in which one crosses its diameter at 1e-3, and go with the root of the accuracy.
    step : float, s, optional
        Equal steps of at most this size instead of chosen ones; they end at jumps as well, but sources and functions
        may change within a step as they like.
    conforming, interface, gap_spacing, sparse, wall, coordination, gap, packing, replicas, allow_few : optional
        As in `solve`; a packing must have the scene's box and domain.

    Returns
    -------
    iterator of Field
        One at each time. Their stats are those of `demheat.conduction.integrators.march.integrate`, with law,
        calibration and, for clipped sources, lost_power (W). Their mean flux is the volume average of what flows, not
        what enters.

    Raises
    ------
    ValueError
        If an argument is not as described, before any heavy work; an unstable step once its limit is known.
    NotImplementedError
        For contact laws with wall "surface" where the round wall of a cylinder is loaded, and for conforming packings
        of inclusions in round bodies; for implicit integrators where a wall radiates.
    RuntimeError
        If steps or linear solves do not converge.

    Examples
    --------
    >>> from demheat import Material, Scene, evolve
    >>> metal = Material(conductivity=185.0, density=2700.0, heat_capacity=900.0)
    >>> ball = Scene((0.1, 0.1, 0.1), metal, domain="sphere", walls={"round": 200.0}, initial=20.0)
    >>> for field in evolve(ball, times=[5.0, 30.0], particles=1000):
    ...     print(f"{field.time:g} s: {field.temperature_at([0.05, 0.05, 0.05])[0]:.0f}")  # exactly 120.778, 199.956
    5 s: 119
    30 s: 200
    """
    check_scene(scene)
    times = check_request(times, integrator, accuracy, step)
    choices = Choices(
        conforming=conforming,
        interface=interface,
        gap_spacing=gap_spacing,
        sparse=sparse,
        wall=wall,
        coordination=coordination,
        gap=gap,
    )
    wanted = Particles(particles=particles, seed=seed, packing=packing, replicas=replicas, allow_few=allow_few)
    law = choices.law(law)
    check_fits(wanted, law)
    scene.require(steady=False, takes=("resistance", "exchange", "image"))
    if scene.radiates:
        check_linear(integrator)
    law.check(scene)
    wanted.check(scene, law)
    check_sources(scene, float(times[-1]))
    check_callables(scene)

    return _march(scene, times, law, wanted, integrator=integrator, accuracy=accuracy, step=step)


def _march(scene, times, law, wanted, **how):
    """Fields at times of what was checked; `how` are the knobs of the integrator."""
    with Helper(parts_of(law, wanted.particles, steady_state=False)) as helper:
        packing = wanted.packed(scene, law)
        helper.join()
    network = network_of(scene, packing, law, seed=wanted.seed)
    loads = {"power": source_power(scene, network.centers, network.volumes), "transits": transits(scene)}
    if law.holds_centers:
        loads["held_centers"] = np.ones(len(network.volumes), dtype=bool)
    for now, solution in evolve_network(network, scene, times, **loads, **how):
        estimator = estimator_of(law, wanted, partial(_answer_at, scene, now, **how), steps=how["accuracy"])
        yield field_of(scene, network, solution, stats=_lost(scene, now), time=now, estimator=estimator)


def _answer_at(scene, time, law, wanted, **how):
    """The field at one time."""
    (field,) = _march(scene, [time], law, wanted, **how)
    return field


def _lost(scene, now):
    """What clipped sources lose at a time, if there are any."""
    clipped = any(getattr(source, "clip", False) for source in scene.sources)
    return {"lost_power": lost_power(scene, now)} if clipped else {}
