"""A periodic cell's conductivity tensor between two that are certain, by three loads on one mesh."""

from dataclasses import replace

import numpy as np

from demheat.runtime.deadline import budget
from demheat.runtime.process_state import one_blas_thread
from demheat.scene import Scene
from references.bracket.answers import ROUNDING, Tensor, check
from references.bracket.energies import flux_energies, temperature_energies
from references.bracket.equations import balanced_flux, linear_temperature
from references.bracket.solver import DROPS, OF_MOMENTS
from references.bracket.surfaces import pushed
from references.fem.system import solve_nodes
from references.mesh import make


def solve_tensor(
    scene: Scene, *, size: float | None = None, tolerance: float = 1e-10, seconds: float | None = None
) -> Tensor:
    """Bound the conductivity tensor of a periodic cell.

    Parameters
    ----------
    scene : Scene
        Spheres and layers in a periodic cell; its gradient does not matter.
    size, tolerance
        As those of `solve`.
    seconds : float, s, optional
        That it may take, see `demheat.budget`; then TimeoutError. What is asked of the result is not in it.

    Returns
    -------
    Tensor

    Raises
    ------
    ValueError
        If an argument is not as described, or the scene has walls.
    NotImplementedError
        If surfaces of the scene touch.
    RuntimeError
        If meshing fails, or a residual stays above the tolerance.

    Examples
    --------
    >>> from demheat import gallery
    >>> from references import bracket
    >>> found = bracket.solve_tensor(gallery.laminate(periodic=True), size=0.05)
    >>> found.middle.diagonal().round(6), found.radius.max() < 1e-6
    (array([98.999981, 54.999981, 98.999981]), np.False_)
    """
    with budget(seconds):
        check(scene, tolerance)
        if not scene.periodic:
            raise ValueError(
                f"Scene.walls = {scene.walls}: a tensor is that of a periodic cell; give a gradient instead"
            )
        with one_blas_thread():
            mesh = make(scene, size=size)
            loads = [replace(scene, gradient=tuple(unit)) for unit in np.eye(3)]
            least, greatest = _least(loads, mesh, tolerance), _greatest(loads, mesh, tolerance)
        stats = {"size": mesh.stats["size"], "elements": len(mesh.cells)}
        return Tensor(least * (1 - ROUNDING), greatest * (1 + ROUNDING), stats)


def _greatest(loads, mesh, tolerance):
    mesh = pushed(loads[0], mesh, upper=True)
    temperatures = [solve_nodes(load, mesh, tolerance).temperature for load in loads]
    return temperature_energies(mesh, loads[0].conductivities[mesh.phase], temperatures) / loads[0].volume


def _least(loads, mesh, tolerance):
    """Of all combinations of the fluxes that of most work for its energy, for each direction of the load."""
    scene = loads[0]
    if not scene.conductivities[mesh.phase].any():
        return np.zeros((3, 3))
    mesh = pushed(scene, mesh, upper=False)
    fluxes = [balanced_flux(load, mesh, tolerance=tolerance) for load in loads]
    energies = flux_energies(mesh, scene.conductivities[mesh.phase], [flux.moments for flux in fluxes])
    # Rows: fluxes; columns: what they work along a unit gradient. The work of a balanced flux is its mean.
    linear = [linear_temperature(mesh, load.gradient) for load in loads]
    works = np.array([[-np.sum(flux.moments * each) for each in linear] for flux in fluxes])
    best = np.linalg.lstsq(energies, works, rcond=None)[0]
    found = works.T @ best
    # Work that jumps between elements could add, for the combination that is taken.
    drop = DROPS * float(np.sum(scene.size))
    lost = 2 * OF_MOMENTS * drop * np.linalg.norm(best, 2) * np.linalg.norm([flux.left for flux in fluxes])
    return ((found + found.T) / 2 - lost * np.eye(3)) / scene.volume
