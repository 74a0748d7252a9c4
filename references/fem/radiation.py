"""Steady radiation: Newton's method on the nodes, each round from the last one's temperatures."""

import numpy as np

from demheat.scene import STEFAN_BOLTZMANN, Radiation
from references.fem.multigrid import renewed, solve_free

# Rounds at most, and what each round's linear equations leave of the residual.
ROUNDS, FURTHER = 40, 1e-3


def hottest(scene, robin) -> float:
    """A temperature that no radiating wall exceeds, K: all imposed fluxes left by radiation alone."""
    size = np.array(scene.size)
    across = {name: float(np.prod(np.delete(size, "xyz".index(name[0])))) for name in scene.walls}
    entering = sum(max(value, 0.0) * across[name] for name, value in scene.wall_fluxes.items())
    black = [(load, float(s.areas.sum())) for load, s in robin.walls.values() if isinstance(load, Radiation)]
    leaving = sum(load.emissivity * STEFAN_BOLTZMANN * area for load, area in black)
    around = max(load.temperature for load, _ in black)
    alone = (around**4 + entering / leaving) ** 0.25 if leaving > 0 else 0.0
    return max(alone, *scene.imposed_temperatures.values())


def radiating(mesh, matrix, load, fixed, dof, tolerance, *, known, body):
    """Correction to a known temperature at which conduction and radiation balance, at the free nodes."""
    scene, robin, unit = body
    outside, free = scene.imposed_temperatures, ~fixed & (matrix.diagonal() > 0)
    correction = np.where(free, hottest(scene, robin) - known, 0.0)
    kept, iterations, largest, size, stats = {}, 0, 0.0, np.inf, {"unknowns": int(free.sum())}
    for rounds in range(ROUNDS + 1):
        temperature = known + correction
        b = load + robin.radiated(outside, temperature) / unit
        whole = (matrix + robin.tangent(temperature) / unit).tocsr()
        left, root = (b - matrix @ correction)[free], np.sqrt(whole.diagonal()[free])
        size = float(np.linalg.norm(left / root))
        largest = max(largest, size, float(np.linalg.norm(b[free] / root)))
        if size <= tolerance * largest or rounds == ROUNDS:
            break
        change, found = solve_free(mesh, whole, b - matrix @ correction, fixed, dof, FURTHER, kept=renewed(kept, whole))
        correction += change
        iterations += found["iterations"]
    residual = size / largest if largest > 0 else 0.0
    if not residual <= tolerance:
        raise RuntimeError(
            f"finite elements: residual {residual:.2e} > tolerance {tolerance:.2e} after {ROUNDS} rounds of Newton's "
            "method for radiation"
        )
    return correction, stats | {"iterations": iterations, "residual": residual, "rounds": rounds}
