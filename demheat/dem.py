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
from demheat.scene import Flux, Material, Scene
from demheat.steady import check_solver, solve_steady

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
