"""The discrete element method: a packing, its network of conductances, and the field they give."""

import time
import warnings

import numpy as np

from demheat.calibration import calibration, cube_like, loaded_flat
from demheat.conduction.sources import lost_power, passes, source_power
from demheat.conduction.steady import check_solver, solve_steady
from demheat.conduction.transient import check_request, mean_flux, try_functions
from demheat.conduction.transient import evolve as evolve_network
from demheat.dem.options import check_steady, check_transient
from demheat.network.calibrated import contact_facets
from demheat.network.interface import connect
from demheat.network.laguerre import laguerre, without_hidden
from demheat.network.platonic import COORDINATION, platonic_facets
from demheat.packing.cache import relaxed, tiled
from demheat.packing.conforming import conform
from demheat.packing.domain import tile_counts
from demheat.packing.neighbours import contacts
from demheat.sampling.field_of import field_of
from demheat.scene import Scene

# Contacts of the papers' own law: Haddad et al. 2021.
CALIBRATED_COORDINATION = 7.5


def solve(
    scene,
    *,
    particles=100_000,
    seed=0,
    law="laguerre",
    conforming=None,
    interface="harmonic",
    poor="nearest",
    wall="center",
    coordination=None,
    gap=None,
    packing=None,
    tiles=None,
    solver="auto",
    tolerance=1e-8,
    allow_few=False,
):
    """Steady conduction in a scene by the discrete element method.

    Parameters
    ----------
    scene : Scene
    particles : int
        Number of particles of the packing before twins are added at interfaces.
    seed : int
        Of the packing.
    law : {"laguerre", "calibrated", "platonic"}
        Transmission surfaces: facets of the radical tessellation; or C_t pi R_m^2 between touching particles with C_t
        from a homogeneous solve (Haddad et al. 2021, eqs. 7-9); or faces of regular polyhedra, by the number of
        contacts of each particle (Terreros et al. 2013, section 4), whose volumes do not add up to that of the body.
    conforming : bool, optional
        Mirror particles across every interface so that facets lie on it; the default for "laguerre".
    interface : {"harmonic", "arithmetic"}
        Rule for links between materials (Haddad et al. 2021, eq. 24).
    poor : {"nearest", "keep", "drop"}
        Not with "laguerre": what happens to particles with fewer than 2 links; see
        `demheat.network.calibrated.contact_facets`.
    wall : {"center", "surface"}
        Not with "laguerre": wall temperatures act in the centres of the particles that touch the wall, as in the
        papers, or at the wall.
    coordination : float, optional
        Not with "laguerre": mean number of contacts of particles away from walls, 7.5 with "calibrated" and 7.2 with
        "platonic" by default.
    gap : float, optional
        Not with "laguerre": contacts are within this part of r_i + r_j, instead of as many as `coordination` asks for.
        For bodies too thin to have particles away from walls.
    packing : Packing, optional
        Used instead of a relaxed one; must have the scene's box and periodicity.
    tiles : int, optional
        Of the packing, along the box's shortest side: a smaller one repeated. By default more than 2 million particles
        are tiles of 250 000 or fewer, which cost a few CPU-seconds instead of 90 for each million, and are as accurate;
        twins at interfaces are not repeated. Between walls only with law "laguerre", and in boxes only.
    solver : {"auto", "cg", "amg"}
    tolerance : float
        On the relative residual of the heat balance.
    allow_few : bool
        Accept fewer than 100 particles.

    Returns
    -------
    Field

    Raises
    ------
    ValueError
        If an argument is not as described, before any heavy work.
    NotImplementedError
        For temperatures on walls that meet, with wall "center" and a law other than "laguerre"; for tiles between
        walls with such a law.
    RuntimeError
        If the solver does not converge.

    Warns
    -----
    UserWarning
        If interfaces are so near to each other or to a wall that particles do not fit between them, or an inclusion
        holds no particle.
    """
    check_solver(solver, tolerance)
    contact = {"poor": poor, "wall": wall, "coordination": coordination, "gap": gap}
    conforming = check_steady(
        scene, law=law, conforming=conforming, interface=interface, contact=contact, packing=packing,
        particles=particles, allow_few=allow_few,
    )  # fmt: skip
    counts = _tiles(scene, packing, particles, law, tiles)
    clock = [time.perf_counter()]
    packing = _packing(scene, packing, particles, seed, allow_few, counts)
    clock.append(time.perf_counter())
    packing, facets = _facets(scene, packing, seed, law, conforming, contact)
    clock.append(time.perf_counter())
    factor = calibration(facets, packing, scene) if law == "calibrated" else 1.0
    facets, network = _connected(scene, packing, facets, factor, interface)
    clock.append(time.perf_counter())
    solution = solve_steady(network, scene, solver=solver, tolerance=tolerance)
    clock.append(time.perf_counter())
    spent = dict(zip(("packing_s", "tessellation_s", "network_s", "solve_s"), np.diff(clock), strict=True))
    stats = spent | {"law": law, "calibration": factor}
    return field_of(scene, packing, facets, network, solution, law=law, stats=stats)


def evolve(
    scene,
    times,
    *,
    particles=100_000,
    seed=0,
    law="laguerre",
    conforming=None,
    interface="harmonic",
    poor="nearest",
    wall="center",
    coordination=None,
    gap=None,
    packing=None,
    tiles=None,
    integrator="auto",
    accuracy=1e-3,
    step=None,
    allow_few=False,
):
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
    particles, seed, conforming, interface, packing, tiles, allow_few
        As in `solve`; a packing must have the scene's box and domain.
    law : {"laguerre", "calibrated", "platonic"}
        As in `solve`; the Platonic law has its own capacities, which sum to the body's only by chance.
    poor, wall, coordination, gap
        As in `solve`, for the two contact laws. C_t is that between the body's flat walls, or for a sphere that of a
        cube of the same volume, packed anew with the same radii. With `wall = "center"` particles at a wall with a
        temperature are held at it, as in the papers, and their own heat counts as the wall's.
    integrator : {"auto", "euler", "rkl2", "tr-bdf2", "tr-bdf2-multigrid"}
        The papers' explicit Euler at its largest stable step, Runge-Kutta-Legendre super-steps, or the implicit TR-BDF2
        with conjugate gradients preconditioned by the diagonal or by multigrid; "auto" takes what should cost least.
    accuracy : float
        Temporal error, rms, of the temperature span; explicit Euler has what its step gives. Under moving sources steps
        are a tenth of the time in which one crosses its diameter at 1e-3, and go with the root of the accuracy.
    step : float, s, optional
        Equal steps of at most this size instead of chosen ones; they end at jumps as well, but sources and functions
        may change within a step as they like.

    Returns
    -------
    iterator of Field
        One at each time. Their stats are those of `demheat.conduction.transient.integrate`, with law, calibration and,
        for clipped sources, lost_power (W). Their mean flux is the volume average of what flows, not what enters.

    Raises
    ------
    ValueError
        If an argument is not as described, before any heavy work; an unstable step once its limit is known.
    NotImplementedError
        For contact laws with wall "surface" where a round wall is loaded or the body a sphere, and for conforming
        packings in round bodies.
    RuntimeError
        If steps or linear solves do not converge.
    """
    times = check_request(times, integrator, accuracy, step)
    contact = {"poor": poor, "wall": wall, "coordination": coordination, "gap": gap}
    conforming = check_transient(
        scene, float(times[-1]), law=law, conforming=conforming, interface=interface, contact=contact, packing=packing,
        particles=particles, allow_few=allow_few,
    )  # fmt: skip
    counts = _tiles(scene, packing, particles, law, tiles)
    try_functions(scene)
    how = {"integrator": integrator, "accuracy": accuracy, "step": step}

    def fields():
        made = _packing(scene, packing, particles, seed, allow_few, counts)
        here, facets = _facets(scene, made, seed, law, conforming, contact)
        factor = _calibrated(scene, here, facets, contact) if law == "calibrated" else 1.0
        facets, network = _connected(scene, here, facets, factor, interface)
        held = np.ones(here.number, dtype=bool) if law != "laguerre" and wall == "center" else None
        power = source_power(scene, network.centers, network.volumes)
        stats = {"law": law, "calibration": factor}
        loads = {"power": power, "passes": passes(scene), "pinned": held}
        for now, solution in evolve_network(network, scene, times, **loads, **how):
            more = stats | _lost(scene, now)
            flux = mean_flux(network, scene, solution)
            yield field_of(scene, here, facets, network, solution, law=law, stats=more, mean_flux=flux, time=now)

    return fields()


def _tiles(scene, packing, particles, law, tiles):
    """How many tiles the packing has along each axis, (3,) int array."""
    if packing is not None and tiles is not None:
        raise ValueError(f"tiles = {tiles!r} of a packing that is given: must be None")
    if scene.domain == "box" and (scene.periodic or law == "laguerre"):
        return tile_counts(particles, scene.size, tiles)
    if tiles is not None and tiles != 1:
        raise NotImplementedError(f"tiles in a {scene.domain} with walls and law {law!r}: only in boxes by 'laguerre'")
    return np.ones(3, dtype=int)


def _packing(scene, packing, particles, seed, allow_few, counts):
    """The packing that was given, or a relaxed one in the scene's body, or tiles of one."""
    if packing is not None:
        return packing
    if counts.prod() > 1:
        return tiled(particles, counts, size=scene.size, periodic=scene.periodic, seed=seed)
    domain = {} if scene.domain == "box" else {"domain": scene.domain}
    return relaxed(particles, size=scene.size, periodic=scene.periodic, seed=seed, allow_few=allow_few, **domain)


def _facets(scene, packing, seed, law, conforming, contact):
    """Packing, with twins at interfaces if wanted and without particles that have no cell, and its facets."""
    if conforming:
        packing = conform(packing, scene, seed=seed)
        _warn_of_gaps(packing)
    if law == "laguerre":
        walls = {"periodic": packing.periodic, "domain": packing.domain}
        facets = laguerre(packing.centers, packing.radii**2, packing.size, **walls)
    else:
        facets = _touching(packing, law, **contact)
    return without_hidden(packing, facets)


def _touching(packing, law, *, poor, wall, coordination, gap):
    """Facets of a law that knows the contacts only."""
    usual, make = {
        "platonic": (COORDINATION, platonic_facets),
        "calibrated": (CALIBRATED_COORDINATION, contact_facets),
    }[law]
    links = contacts(packing, coordination=usual if coordination is None else coordination, gap=gap)
    return make(packing, links=links, poor=poor, wall=wall)


def _calibrated(scene, packing, facets, contact):
    """C_t of a packing between its flat walls; of a sphere's in a cube of the same volume."""
    if scene.domain == "sphere":
        packing = cube_like(packing)
        packing, facets = without_hidden(packing, _touching(packing, "calibrated", **contact))
        scene = Scene(size=tuple(packing.size), matrix=scene.matrix, initial=0.0)
    return calibration(facets, packing, loaded_flat(scene))


def _connected(scene, packing, facets, factor, interface):
    """Facets with calibrated surfaces, and the network of conductances."""
    # Wall areas are those of the walls: what scales is the conductance of their links.
    facets = facets._replace(area=factor * facets.area, wall_distance=facets.wall_distance / factor)
    phase = scene.phase_at(packing.centers)
    _warn_of_lost_phases(scene, phase)
    network = connect(facets, packing.centers, packing.size, phase, scene.conductivities, rule=interface)
    return facets, network


def _lost(scene, now):
    """What clipped sources lose at a time, if there are any."""
    clipped = any(getattr(source, "clip", False) for source in scene.sources)
    return {"lost_power": lost_power(scene, now)} if clipped else {}


def _warn_of_gaps(packing):
    count = packing.provenance["pairs_left_out"]
    if count:
        warnings.warn(
            f"{count} pairs of particles do not fit into gaps narrower than a fifth of the mean particle; facets "
            "cross the interfaces there: use more particles where the gaps matter",
            stacklevel=4,
        )


def _warn_of_lost_phases(scene, phase):
    lost = np.flatnonzero(np.bincount(phase, minlength=len(scene.materials)) == 0)
    # A phase may rightly be absent where later ones cover it: only the matrix can be.
    if np.any(lost > 0):
        warnings.warn(
            f"no particle lies in inclusions {(lost[lost > 0] - 1).tolist()}: they are thinner than a "
            "particle and take no part; use more particles",
            stacklevel=4,
        )
