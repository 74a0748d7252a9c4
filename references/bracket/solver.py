"""A scene's conductivity between two bounds that are certain."""

import math
from dataclasses import replace

import numpy as np

from demheat.gate import check_bracket
from demheat.runtime.deadline import budget
from demheat.runtime.limits import free_memory
from demheat.runtime.process_state import cpu_seconds, one_blas_thread
from demheat.scene import Scene
from demheat.scene.inputs import finite
from references.bracket.answers import ROUNDING, Bracket, check
from references.bracket.energies import flux_energies, temperature_energies
from references.bracket.equations import balanced_flux
from references.bracket.surfaces import pushed
from references.fem.system import solve_nodes
from references.mesh import make
from references.mesh.sizes import BYTES, MOST_CELLS, checked_size

# The integral of |normal flux| over a face is at most so many times the sum of the magnitudes of its three moments:
# each corner's value is 12/area times (its moment less a quarter of the sum), and weighs a third of the area.
OF_MOMENTS = 7.0
# Temperatures stay between those of the walls. In a periodic cell what the inclusions add to the linear temperature is
# taken, not proved, to stay below so many times its drop over the cell; found: at most 0.63 on 20 random cells. It
# multiplies the residual alone.
DROPS = 10.0
# A finer mesh's edges over a coarser one's: by the width's third power, but neither more nor less than these.
POWER, FINER = 1 / 3, (0.5, 0.85)
# Of edges over the width's powers, where bounds close in like the edges' fourth power.
FASTEST = 1 / 4
# The first mesh on the way to a width: edges over the mesher's usual ones, a tenth of its cost.
FIRST = 2.5
# Of the best conductor: what conducts less is stopped by pores, and no ratio of bounds tells how well it is known.
NOTHING = 1e-9


def solve(
    scene: Scene,
    *,
    size: float | None = None,
    width: float | None = None,
    tolerance: float = 1e-10,
    seconds: float | None = None,
) -> Bracket:
    """Bound the conductivity of a scene along its load from both sides.

    The temperature is quadratic, the flux linear in each element, which lets both bounds close in like the third to
    fourth power of the edge length; interfaces are quadratic too and pushed to the safe side of the true ones.

    Parameters
    ----------
    scene : Scene
        Spheres and layers in a periodic cell, or between two opposite walls that are held; conductivity 0 is a pore.
    size : float, m, optional
        Longest wanted edge of the mesh, see `references.mesh.make`; with `width` that of the
        first mesh.
    width : float, optional
        Refine until upper over lower bound is at most 1 + width; or until pores are seen to stop the heat.
    tolerance : float
        Largest relative residual of both systems of equations, scaled to a unit diagonal. What it leaves of the
        flux unbalanced is counted against the lower bound.
    seconds : float, s, optional
        That it may take, see `demheat.budget`; then TimeoutError. What is asked of the result is not in it.

    Returns
    -------
    Bracket

    Raises
    ------
    ValueError
        If an argument is not as described, or the width asks for a mesh that memory does not hold.
    NotImplementedError
        If surfaces of the scene touch.
    RuntimeError
        If meshing fails, or a residual stays above the tolerance.
    ImportError
        If gmsh or a system library that it needs is missing.

    Examples
    --------
    >>> from demheat import gallery
    >>> from references import bracket
    >>> found = bracket.solve(gallery.sphere_in_cube(5.0), size=0.03)
    >>> found.lower < 42.6403 < found.upper, found.width < 0.02
    (True, True)
    """
    with budget(seconds):
        if width is not None:
            finite("width", width, "a number > 0, as 1e-3", lambda v: v > 0)
        check(scene, tolerance)
        scene, drop, power = _unit_load(scene)
        # The order of BLAS's sums, and so the last bits, is that of its threads.
        with one_blas_thread():
            found = _narrowed(scene, size, width, tolerance, drop, power)
        check_bracket(scene, found.lower, found.upper)
        return found


def _narrowed(scene, size, width, tolerance, drop, power):
    if width is not None and size is None:
        size = FIRST * checked_size(scene, None, 2)
    while True:
        found = _once(scene, size, tolerance, drop, power)
        if width is None or found.width <= width or found.upper <= NOTHING * max(scene.conductivities):
            return found
        _check_width(width, found)
        size = found.stats["size"] * float(np.clip((width / found.width) ** POWER, *FINER))


def _check_width(width, found):
    """Refuse a width far beyond any mesh as soon as one mesh tells; `make` refuses what is nearer."""
    elements, most = found.stats["elements"], min(MOST_CELLS, free_memory() / BYTES[2])
    # Wherever bounds close in as fast as is found anywhere.
    needed = elements * (found.width / width) ** (3 * FASTEST)
    if math.isfinite(found.width) and needed > most:
        least = found.width * (elements / most) ** (1 / (3 * FASTEST))
        raise ValueError(
            f"width = {width!r}: takes some {needed:.1e} tetrahedra, here {most:.1e} are possible; must be >= "
            f"{least:.1g} here, as {elements} give {found.width:.1e}"
        )


def _unit_load(scene):
    """The same conductivity under a load of one, counted from 0, since offsets and scales would cost digits.

    Besides, the largest difference of temperatures, K, and the energy of a unit conductivity, K2 m.
    """
    if scene.periodic:
        gradient = np.array(scene.gradient) / np.linalg.norm(scene.gradient)
        drop = DROPS * float(np.abs(gradient * scene.size).sum())
        return replace(scene, gradient=tuple(gradient)), drop, scene.volume
    length = scene.size[scene.axis]
    if scene.wall_fluxes:
        raise ValueError(f"Scene.walls = {scene.walls}: bounds need two opposite walls, both held at a temperature")
    (one, low), (other, high) = scene.wall_temperatures.items()
    if low == high:
        raise ValueError(f"Scene.walls = {scene.walls}: temperatures must differ to define a conductivity")
    return replace(scene, walls={one: 0.0, other: 1.0}), 1.0, scene.volume / length**2


def _once(scene, size, tolerance, drop, power):
    begin = cpu_seconds()
    mesh = make(scene, size=size)
    meshed = cpu_seconds()
    lower, fluxes = _lower(scene, mesh, tolerance, drop, power)
    bounded = cpu_seconds()
    upper, temperatures = _upper(scene, mesh, tolerance, power)
    cpu = {"mesh": meshed - begin, "lower": bounded - meshed, "upper": cpu_seconds() - bounded}
    stats = {"size": mesh.stats["size"], "elements": len(mesh.cells), "unbalanced": fluxes.pop("unbalanced")}
    lower, upper = float(lower) * (1 - ROUNDING), float(upper) * (1 + ROUNDING)
    return Bracket(lower, upper, stats | {"temperatures": temperatures, "fluxes": fluxes, "cpu_s": cpu})


def _lower(scene, mesh, tolerance, drop, power):
    """By Thomson's principle: the power of the true temperature is at least (what a flux works along it)^2 / energy."""
    if not scene.conductivities[mesh.phase].any():
        return 0.0, {"unbalanced": 0.0}
    mesh = pushed(scene, mesh, upper=False)
    flux = balanced_flux(scene, mesh, tolerance=tolerance)
    energy = flux_energies(mesh, scene.conductivities[mesh.phase], [flux.moments])[0, 0]
    lost = OF_MOMENTS * flux.left * drop
    if flux.work <= lost:
        return 0.0, flux.stats | {"unbalanced": 0.0}
    return (flux.work - lost) ** 2 / energy / power, flux.stats | {"unbalanced": float(2 * lost / flux.work)}


def _upper(scene, mesh, tolerance, power):
    """By Dirichlet's principle: the power of the true temperature is at most the energy of any other."""
    mesh = pushed(scene, mesh, upper=True)
    solved = solve_nodes(scene, mesh, tolerance)
    stats = {name: solved.stats[name] for name in ("unknowns", "iterations", "residual")}
    energy = temperature_energies(mesh, scene.conductivities[mesh.phase], [solved.temperature])[0, 0]
    return energy / power, stats
