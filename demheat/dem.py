"""The discrete element method: a packing, its network of conductances, and the field they give."""

import time
import warnings

import numpy as np

from demheat.evaluate import field_of
from demheat.network.calibrated import POLICIES, WALL_RULES, contact_facets
from demheat.network.interface import check_rule, connect
from demheat.network.laguerre import laguerre, without_hidden
from demheat.network.platonic import COORDINATION, platonic_facets
from demheat.packing.cache import relaxed
from demheat.packing.conforming import conform
from demheat.packing.neighbours import contacts
from demheat.scene import WALLS, Flux, Material, Scene
from demheat.sources import lost_power, source_power, total_power
from demheat.steady import check_solver, solve_steady
from demheat.transient import check_request, mean_flux
from demheat.transient import evolve as evolve_network

LAWS = ("laguerre", "calibrated", "platonic")
LOADINGS = ("isothermal", "flux")


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
    packing=None,
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
        Not with "laguerre": mean number of contacts, 7.5 with "calibrated" and 7.2 with "platonic" by default.
    packing : Packing, optional
        Used instead of a relaxed one; must have the scene's box and periodicity.
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
        For temperatures on walls that meet, with wall "center" and a law other than "laguerre".
    RuntimeError
        If the solver does not converge.

    Warns
    -----
    UserWarning
        If interfaces are so near to each other or to a wall that particles do not fit between them, or an inclusion
        holds no particle.
    """
    if law not in LAWS:
        raise ValueError(f"law = {law!r}: must be one of {', '.join(LAWS)}")
    check_rule(interface)
    check_solver(solver, tolerance)
    _check_contacts(law, poor, wall, coordination)
    conforming = law == "laguerre" if conforming is None else bool(conforming)
    if conforming and law != "laguerre":
        raise ValueError(
            f"conforming = True with law = {law!r}: twins need not touch; must be False, or law 'laguerre'"
        )
    scene.check_steady()
    _check_walls(scene, law, wall)
    if packing is None and isinstance(particles, int | float) and particles < 100 and not allow_few:
        raise ValueError(f"particles = {particles!r}: fewer than 100; pass allow_few=True if you mean it")
    clock = [time.perf_counter()]
    if packing is None:
        packing = relaxed(particles, size=scene.size, periodic=scene.periodic, seed=seed, allow_few=allow_few)
    _check_packing(packing, scene)
    clock.append(time.perf_counter())
    if conforming:
        packing = conform(packing, scene, seed=seed)
        _warn_of_gaps(packing)
    if law == "laguerre":
        facets = laguerre(packing.centers, packing.radii**2, packing.size, periodic=packing.periodic)
    else:
        facets = _touching(packing, law, coordination, poor, wall)
    packing, facets = without_hidden(packing, facets)
    clock.append(time.perf_counter())
    factor = calibration(facets, packing, scene) if law == "calibrated" else 1.0
    # Wall areas are those of the walls: what scales is the conductance of their links.
    facets = facets._replace(area=factor * facets.area, wall_distance=facets.wall_distance / factor)
    phase = scene.phase_at(packing.centers)
    _warn_of_lost_phases(scene, phase)
    network = connect(facets, packing.centers, packing.size, phase, scene.conductivities, rule=interface)
    clock.append(time.perf_counter())
    solution = solve_steady(network, scene, solver=solver, tolerance=tolerance)
    clock.append(time.perf_counter())
    spent = dict(zip(("packing_s", "tessellation_s", "network_s", "solve_s"), np.diff(clock), strict=True))
    return field_of(
        scene, packing, facets, network, solution, law=law, stats=spent | {"law": law, "calibration": factor}
    )


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
    packing=None,
    integrator="auto",
    accuracy=1e-3,
    step=None,
    allow_few=False,
):
    """Conduction in time by the discrete element method, from the scene's initial temperature at time 0.

    Parameters
    ----------
    scene : Scene
        With an initial temperature, densities and heat capacities; its loads may depend on time.
    times : sequence of float, s
        Increasing, >= 0.
    particles, seed, conforming, interface, packing, allow_few
        As in `solve`; a packing must have the scene's box and domain.
    law : {"laguerre", "calibrated", "platonic"}
        As in `solve`; the Platonic law has its own capacities, which sum to the body's only by chance.
    poor, wall, coordination
        As in `solve`, for the two contact laws. With `wall = "center"` particles at a wall with a temperature are held
        at it, as in the papers, and their own heat counts as the wall's.
    integrator : {"auto", "euler", "rkl2", "tr-bdf2", "tr-bdf2-multigrid"}
        The papers' explicit Euler at its largest stable step, Runge-Kutta-Legendre super-steps, or the implicit TR-BDF2
        with conjugate gradients preconditioned by the diagonal or by multigrid; "auto" takes what should cost least.
    accuracy : float
        Temporal error, rms, of the temperature span; explicit Euler has what its step gives.
    step : float, s, optional
        Equal steps of at most this size instead of chosen ones.

    Returns
    -------
    iterator of Field
        One at each time. Their stats are those of `demheat.transient.integrate`, with law, calibration and, for clipped
        sources, lost_power (W). Their mean flux is the volume average of what flows, not what enters.

    Raises
    ------
    ValueError
        If an argument is not as described, before any heavy work; an unstable step once its limit is known.
    NotImplementedError
        For contact laws with a round wall that is loaded, and for conforming packings in round bodies.
    RuntimeError
        If steps or linear solves do not converge.
    """
    times = check_request(times, integrator, accuracy, step)
    check_rule(interface)
    contact = {"coordination": coordination, "poor": poor, "wall": wall}
    conforming = _check_evolution(scene, law, conforming, contact, packing)
    if packing is None and isinstance(particles, int | float) and particles < 100 and not allow_few:
        raise ValueError(f"particles = {particles!r}: fewer than 100; pass allow_few=True if you mean it")
    for time_ in (0.0, float(times[-1])):
        # Sources move on straight lines: what is inside the body then is inside all the while.
        total_power(scene, time_)
    how = {"integrator": integrator, "accuracy": accuracy, "step": step}

    def fields():
        here = packing
        if here is None:
            domain = {} if scene.domain == "box" else {"domain": scene.domain}
            here = relaxed(particles, size=scene.size, periodic=False, seed=seed, allow_few=allow_few, **domain)
        if conforming:
            here = conform(here, scene, seed=seed)
            _warn_of_gaps(here)
        yield from _fields(scene, here, times, law, interface, contact, how)

    return fields()


def _fields(scene, packing, times, law, interface, contact, how):
    if law == "laguerre":
        domain = packing.domain
        facets = laguerre(packing.centers, packing.radii**2, packing.size, periodic=packing.periodic, domain=domain)
    else:
        facets = _touching(packing, law, **contact)
    packing, facets = without_hidden(packing, facets)
    factor = calibration(facets, packing, _loaded_flat(scene)) if law == "calibrated" else 1.0
    facets = facets._replace(area=factor * facets.area, wall_distance=facets.wall_distance / factor)
    phase = scene.phase_at(packing.centers)
    _warn_of_lost_phases(scene, phase)
    network = connect(facets, packing.centers, packing.size, phase, scene.conductivities, rule=interface)
    power = source_power(scene, network.centers, network.volumes)
    pinned = np.ones(packing.number, dtype=bool) if law != "laguerre" and contact["wall"] == "center" else None
    more = {"law": law, "calibration": factor}
    clipped = any(getattr(source, "clip", False) for source in scene.sources)
    for now, solution in evolve_network(network, scene, times, power=power, pinned=pinned, **how):
        stats = more | ({"lost_power": lost_power(scene, now)} if clipped else {})
        flux = mean_flux(network, scene, solution)
        yield field_of(scene, packing, facets, network, solution, law=law, stats=stats, mean_flux=flux, time=now)


def _check_evolution(scene, law, conforming, contact, packing):
    """Refuse what a transient cannot do; whether twins are wanted."""
    if law not in LAWS:
        raise ValueError(f"law = {law!r}: must be one of {', '.join(LAWS)}")
    _check_contacts(law, **contact)
    wanted = (law == "laguerre" and bool(scene.inclusions)) if conforming is None else bool(conforming)
    if wanted and law != "laguerre":
        raise ValueError(f"conforming = True with law = {law!r}: twins need not touch; must be False")
    if wanted and scene.domain != "box":
        raise NotImplementedError(f"inclusions in a {scene.domain} have no conforming packing; pass conforming=False")
    if law != "laguerre" and (scene.domain == "sphere" or "round" in (scene.walls or {})):
        raise NotImplementedError(f"law {law!r} has no links to a round wall; use 'laguerre'")
    scene.check_transient()
    _check_walls(scene, law, contact["wall"])
    if packing is not None and (
        packing.domain != scene.domain or packing.periodic.any() or not np.allclose(packing.size, scene.size, rtol=1e-9)
    ):
        raise ValueError(
            f"packing of size {packing.size.tolist()} in a {packing.domain}, periodic {packing.periodic.tolist()}: "
            f"must be walled in the scene's {scene.domain} of size {scene.size}"
        )
    return wanted


def _loaded_flat(scene):
    """A scene of the same size with a load along the first flat wall of this one, or along its axis, or y."""
    flat = [name for name in (scene.walls or {}) if name in WALLS]
    letter = flat[0][0] if flat else scene.domain[-1] if scene.domain.startswith("cylinder") else "y"
    return Scene(size=scene.size, matrix=Material(1.0), walls={letter + "-": 0.0, letter + "+": 1.0})


def _warn_of_gaps(packing):
    count = packing.provenance["pairs_left_out"]
    if count:
        warnings.warn(
            f"{count} pairs of particles do not fit into gaps narrower than a fifth of the mean particle; facets "
            "cross the interfaces there: use more particles where the gaps matter",
            stacklevel=3,
        )


def _warn_of_lost_phases(scene, phase):
    lost = np.flatnonzero(np.bincount(phase, minlength=len(scene.materials)) == 0)
    # A phase may rightly be absent where later ones cover it: only the matrix can be.
    if np.any(lost > 0):
        warnings.warn(
            f"no particle lies in inclusions {(lost[lost > 0] - 1).tolist()}: they are thinner than a "
            "particle and take no part; use more particles",
            stacklevel=3,
        )


def _touching(packing, law, coordination, poor, wall):
    """Facets of a law that knows the contacts only."""
    if law == "platonic":
        mean = COORDINATION if coordination is None else coordination
        return platonic_facets(packing, coordination=mean, poor=poor, wall=wall)
    links = contacts(packing, coordination=7.5 if coordination is None else coordination)
    return contact_facets(packing, links=links, poor=poor, wall=wall)


def _check_contacts(law, poor, wall, coordination):
    if coordination is not None and not (isinstance(coordination, int | float) and 0 < coordination < float("inf")):
        raise ValueError(f"coordination = {coordination!r}: must be a finite number > 0")
    for name, value, valid in (("poor", poor, POLICIES), ("wall", wall, WALL_RULES)):
        if value not in valid:
            raise ValueError(f"{name} = {value!r}: must be one of {', '.join(valid)}")
    if law == "laguerre" and (poor, wall, coordination) != ("nearest", "center", None):
        raise ValueError(
            f"poor = {poor!r}, wall = {wall!r}, coordination = {coordination!r} with law = 'laguerre': only the laws "
            "'calibrated' and 'platonic' have these choices"
        )


def _check_walls(scene, law, wall):
    held = {name[0] for name in scene.wall_temperatures}
    if law != "laguerre" and wall == "center" and len(held) > 1:
        raise NotImplementedError(
            f"law {law!r} with wall 'center' holds the centres of the particles at a wall at its temperature: "
            "where two held walls meet, one particle would join them; use wall 'surface'"
        )


def _check_packing(packing, scene):
    if packing.domain != "box":
        raise NotImplementedError(f"a packing in a {packing.domain}: scenes are boxes")
    if not np.allclose(packing.size, scene.size, rtol=1e-9) or set(packing.periodic.tolist()) != {scene.periodic}:
        kind = "periodic" if scene.periodic else "walled"
        raise ValueError(
            f"packing of size {packing.size.tolist()} and periodicity {packing.periodic.tolist()}: must be "
            f"{kind} in the scene's box {scene.size}"
        )


def calibration(facets, packing, scene, *, loading="isothermal", solver="auto", tolerance=1e-8):
    """C_t of a contact network: conductivity over that of the homogeneous lattice with C_t = 1, under a like load.

    Source: Haddad et al. 2021, eqs. 7-9.

    Parameters
    ----------
    facets : Facets
        With S = pi R_m^2.
    packing : Packing
        In any domain; axes without a load may be periodic or not.
    scene : Scene
        Its box and load; a wall load calibrates between the two walls along its axis.
    loading : {"isothermal", "flux"}
        Between walls: two temperatures, or as in the paper a temperature below and a flux that enters above, where the
        temperature is then read.
    solver, tolerance
        As in `demheat.steady.solve_steady`.

    Returns
    -------
    float

    Raises
    ------
    ValueError
        If `loading` is none of these, or no particle conducts between the two walls.
    """
    if loading not in LOADINGS:
        raise ValueError(f"loading = {loading!r}: must be one of {', '.join(LOADINGS)}")
    walls = None
    if not scene.periodic:
        letter = next(iter(scene.walls))[0]
        walls = {letter + "-": 0.0, letter + "+": 1.0 if loading == "isothermal" else Flux(1.0)}
    unit = Scene(size=scene.size, matrix=Material(1.0), gradient=scene.gradient, walls=walls)
    phase = np.zeros(packing.number, dtype=np.int32)
    network = connect(facets, packing.centers, packing.size, phase, unit.conductivities)
    solution = solve_steady(network, unit, solver=solver, tolerance=tolerance)
    if scene.periodic:
        return 1.0 / field_of(unit, packing, facets, network, solution, law="calibrated", stats={}).conductivity
    return 1.0 / _between_walls(network, solution, "xyz".index(letter))


def _between_walls(network, solution, axis):
    """Conductivity between the two walls across an axis: heat times length over area and temperature difference."""
    low, high = (network.wall_side == 2 * axis + end for end in (0, 1))
    area, heat = network.wall_area[high].sum(), solution.wall_heat[high].sum()
    if not (low.any() and abs(heat) > 0):
        raise ValueError(f"packing: no heat passes between its walls along {'xyz'[axis]}; no particle joins them")
    drop = np.average(solution.wall_temperature[high], weights=network.wall_area[high])
    drop -= np.average(solution.wall_temperature[low], weights=network.wall_area[low])
    return heat * network.size[axis] / (area * drop)
