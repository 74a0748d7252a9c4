"""How far the spheres of a packing lie from its walls."""

import numpy as np

from demheat.packing.base import Packing
from demheat.packing.gate import check_packing
from demheat.scene import bodies
from demheat.scene.inputs import finite


def walls(packing: Packing) -> tuple[str, ...]:
    """Names of the walls of a packing."""
    check_packing(packing)
    return bodies.wall_names(packing.domain, packing.periodic)


def wall_distance(packing: Packing, wall) -> np.ndarray:
    """Distance of each centre from one wall, (n,) float array, m."""
    check_packing(packing)
    _check_wall(packing, wall)
    return bodies.wall_distance(packing.centers, wall, packing.domain, packing.size)


def wall_distances(packing: Packing) -> np.ndarray:
    """Distance of each centre from the nearest wall, (n,) float array, m; infinite where there is none."""
    names = walls(packing)
    return bodies.nearest_wall(packing.centers, names, packing.domain, packing.size)


def outward(packing: Packing, wall) -> np.ndarray:
    """Unit vector from each centre towards one wall, (n, 3) float array; NaN in the middle of a round body."""
    check_packing(packing)
    _check_wall(packing, wall)
    return bodies.outward(packing.centers, wall, packing.domain, packing.size)


def check_margin(packing: Packing, margin, name="margin") -> float:
    """Depth of the core in metres for a margin in mean radii."""
    check_packing(packing)
    margin = finite(name, margin, "a finite number of mean radii >= 0", lambda v: v >= 0)
    mean = float(np.mean(packing.radii))
    largest = float(np.min(np.where(packing.periodic, np.inf, packing.size / 2)))
    if margin * mean >= largest:
        raise ValueError(f"{name} = {margin!r}: must be < {largest / mean:.6g} mean radii, where no core is left")
    return margin * mean


def bulk(packing: Packing, margin) -> np.ndarray:
    """Which particles lie at least so far away from every wall, flat or round, (n,) bool array."""
    depth = check_margin(packing, margin)
    deep = wall_distances(packing) >= depth
    if depth == 0:
        # Rounding may put the centre of a particle at a curved wall beyond it.
        deep[:] = True
    if not deep.any():
        raise ValueError(f"margin = {margin!r}: no particle is that many mean radii away from all walls")
    return deep


def _check_wall(packing, wall):
    known = bodies.wall_names(packing.domain)
    if wall not in known:
        raise ValueError(f"wall = {wall!r}: must be one of {', '.join(known)}")
