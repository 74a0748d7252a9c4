"""Our network of a body as a system of equations, for linear solvers of others; and ours on the same."""

import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np

from demheat.network.base import SIDES, Network
from demheat.scene import Scene
from studies.common.peers import laguerre_network, matrix_of
from studies.peers.outside import Found
from studies.peers.packages import found

SEED = 0
# Of the norm of b - A x over that of b.
RESIDUAL = 1e-10
# Particles, by body; the error of the network is not at stake, so few bodies do.
SCENES = {
    "sphere 10": (20_000, 100_000, 1_000_000),
    "sphere 1000": (20_000,),
    "half 10": (20_000,),
    "dispersion 10": (20_000,),
}


class System(NamedTuple):
    """A x = b of a body's particles, and where it comes from."""

    scene: Scene
    network: Network
    a: object  # (n, n) csr_matrix, W/K
    b: np.ndarray  # W

    @property
    def start(self):
        """Temperatures linear between the walls, with which ours begins, too, K."""
        low, high = (self.scene.wall_temperatures[name] for name in ("x-", "x+"))
        return low + (high - low) * self.network.centers[:, 0] / self.scene.size[0]

    def residual(self, x) -> float:
        """Norm of what temperatures leave over that of the right-hand side."""
        return float(np.linalg.norm(self.b - self.a @ x) / np.linalg.norm(self.b))

    def conductivity(self, x) -> float:
        """Of the body by the heat through both walls, W/(m K)."""
        network, walls = self.network, self.scene.wall_temperatures
        heat = []
        for name in ("x-", "x+"):
            mine = network.wall_side == SIDES.index(name)
            heat.append(network.wall_conductance[mine] @ (walls[name] - x[network.wall_particle[mine]]))
        sides = self.scene.size
        return float((heat[0] - heat[1]) / 2 / (walls["x-"] - walls["x+"]) * sides[0] / (sides[1] * sides[2]))


def cases(solvers):
    """Cases of linear solvers, every body at every number of particles."""
    return tuple(
        {"scene": scene, "particles": particles, "solver": solver}
        for scene, numbers in SCENES.items()
        for particles in numbers
        for solver in solvers
    )


def system(scene, particles) -> System:
    """The equations of a body."""
    if scene.conductivities.min() <= 0:
        raise NotImplementedError("pores leave particles without an equation, which only our own solver knows")
    network = laguerre_network(scene, particles, SEED)
    return System(scene, network, *matrix_of(network, scene))


def solved_by(name, scene, *, particles, solver, module=None) -> Found:
    """Hand the equations to the script `with_NAME.py`, see what its temperatures are worth."""
    equations = system(scene, particles)
    with tempfile.TemporaryDirectory() as folder:
        given, answer = Path(folder) / "system.npz", Path(folder) / "x.npy"
        a = equations.a
        np.savez(given, indptr=a.indptr, indices=a.indices, data=a.data, b=equations.b, start=equations.start)
        asked = {"system": str(given), "answer": str(answer), "solver": solver, "tolerance": RESIDUAL}
        told = found(name, asked, module=module)
        x = np.load(answer)
    return judged(equations, x, told)


def judged(equations, x, told) -> Found:
    """A `Found` with the conductivity that follows from temperatures."""
    reached = equations.residual(x)
    # Solvers update their residuals, whose rounding grows with the conditioning.
    if not reached <= 2 * RESIDUAL:
        raise RuntimeError(f"residual {reached:.1e}, asked for {RESIDUAL:.0e}")
    note = f"residual {reached:.1e}" + (f"; {told.note}" if told.note else "")
    return told._replace(conductivity=equations.conductivity(x), unknowns=len(x), note=note)
