"""C_t, the factor that gives a homogeneous contact network the conductivity of its material.

Source: Haddad et al. 2021, eqs. 7-9.
"""

import numpy as np

from demheat.conduction.steady import TOLERANCE, solve_steady
from demheat.packing.cache import relaxed
from demheat.packing.gate import check_packing
from demheat.packing.relax import FEWEST
from demheat.sampling.fluxes import mean_flux
from demheat.scene import WALLS, Flux, Material, Scene

LOADINGS = ("isothermal", "flux")


def calibration(network, scene, *, loading="isothermal", solver="auto", tolerance=TOLERANCE) -> float:
    """C_t of a contact network: conductivity over that of the homogeneous lattice with C_t = 1, under a like load.

    Source: Haddad et al. 2021, eqs. 7-9.
    """
    if loading not in LOADINGS:
        raise ValueError(f"loading = {loading!r}: must be one of {', '.join(LOADINGS)}")
    walls = None
    if not scene.periodic:
        letter = next(iter(scene.walls))[0]
        walls = {letter + "-": 0.0, letter + "+": 1.0 if loading == "isothermal" else Flux(1.0)}
    unit = Scene(size=scene.size, matrix=Material(1.0), gradient=scene.gradient, walls=walls)
    solution = solve_steady(network, unit, solver=solver, tolerance=tolerance)
    if scene.periodic:
        gradient = np.array(scene.gradient)
        return 1.0 / float(-mean_flux(network, unit, solution) @ gradient / (gradient @ gradient))
    return 1.0 / _between_walls(network, solution, "xyz".index(letter))


def cube_like(packing, *, seed=0):
    """A packing with the radii and the packing fraction of another in a cube of the same volume, between walls.

    A sphere has no two opposite walls to calibrate between.
    """
    check_packing(packing)
    size = (packing.volume ** (1 / 3),) * 3
    few = packing.number < FEWEST
    return relaxed(
        packing.number, size=size, phi=packing.phi, radii=packing.radii, periodic=False, seed=seed, allow_few=few
    )


def calibration_scene(scene):
    """A scene of the same size and conductivity 1 whose load is like that of another.

    The mean gradient of a periodic cell; else temperatures along the first flat wall of the other scene, or its axis,
    or its longest side.
    """
    if scene.periodic:
        return Scene(size=scene.size, matrix=Material(1.0), gradient=scene.gradient)
    flat = [name for name in (scene.walls or {}) if name in WALLS]
    longest = "xyz"[int(np.argmax(scene.size))]
    letter = flat[0][0] if flat else scene.domain[-1] if scene.domain.startswith("cylinder") else longest
    return Scene(size=scene.size, matrix=Material(1.0), walls={letter + "-": 0.0, letter + "+": 1.0})


def _between_walls(network, solution, axis):
    """Conductivity between the two walls across an axis: heat times length over area and temperature difference."""
    low, high = (network.wall_side == 2 * axis + end for end in (0, 1))
    area, heat = network.wall_area[high].sum(), solution.wall_heat[high].sum()
    if not (low.any() and abs(heat) > 0):
        raise ValueError(f"packing: no heat passes between its walls along {'xyz'[axis]}; no particle joins them")
    drop = np.average(solution.wall_temperature[high], weights=network.wall_area[high])
    drop -= np.average(solution.wall_temperature[low], weights=network.wall_area[low])
    return heat * network.size[axis] / (area * drop)
