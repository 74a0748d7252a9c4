"""Perfect conductors in a network: which of them are one body, and what no particles can tell.

The network is that of a body whose perfect conductors are `GOOD` times as good as the rest: its links between phases
are those of the other side alone. See `demheat.conduction.good` for the equations.
"""

import numpy as np

from demheat.conduction.good import bodies_of, solve_good
from demheat.conduction.steady import Unsolved
from demheat.network.base import SIDES, row_numbers
from demheat.scene.perfect import INFINITE, as_good, contacts, touch
from demheat.scene.shapes.base import TOUCH


def check_perfect(scene) -> None:
    """Raise unless what lies beside perfect conductors is known to particles."""
    if not scene.perfect:
        return
    what = "beside perfect conductors particles know constant conductivities, and walls that do not radiate"
    scene.require(what, takes=("resistance", "perfect", *(() if scene.radiates else ("exchange",))))
    contacts(scene)


def solve_perfect(network, scene, *, solver, tolerance, max_iterations):
    """As `demheat.conduction.good.solve_good`, in the network of the scene `as_good`."""
    inside, good = np.isinf(scene.conductivities)[network.phase], as_good(scene)
    bodies = bodies_of(network, good, inside)
    _check_links(network, scene, bodies)
    _check_contacts(network, scene, bodies)
    _check_walls(network, scene, bodies)
    if np.any(bodies.spans):
        raise ValueError(INFINITE)
    how = {"solver": solver, "tolerance": tolerance, "max_iterations": max_iterations}
    found = solve_good(network, good, bodies, **how, rounds=1)
    if found is None:
        raise Unsolved(f"solve: perfect conductors: residual above {tolerance:.1e} after {max_iterations} iterations")
    return found


def _check_links(network, scene, bodies):
    """Raise where links join perfect conductors that are apart."""
    row, other, phase = row_numbers(network.indptr), network.indices, network.phase
    unlike = np.flatnonzero(bodies.within & (phase[row] < phase[other]))
    pairs, first = np.unique(np.column_stack([phase[row], phase[other]])[unlike], axis=0, return_index=True)
    for (one, two), link in zip(pairs.tolist(), unlike[first], strict=True):
        if not touch(scene, one, two, network.centers[row[link]]):
            raise NotImplementedError(
                f"the gap between perfect conductors {_named(one)} and {_named(two)} is too thin for these particles: "
                "must be wider, resist, or be more particles"
            )


def _check_contacts(network, scene, bodies):
    """Raise where no link joins what touches in a point."""
    for one, two in contacts(scene):
        own, other = (np.unique(bodies.label[network.phase == number + 1]) for number in (one, two))
        if not (np.any(np.isfinite(bodies.held[own])) if one == two else len(np.intersect1d(own, other))):
            raise NotImplementedError(
                f"where {_named(one + 1)} touches {'a wall' if one == two else _named(two + 1)} particles see a gap: "
                "must be more particles"
            )


def _check_walls(network, scene, bodies):
    """Raise if cells of an inclusion reach a wall with a temperature that it does not."""
    for number in np.unique(network.phase[network.wall_particle[bodies.at_wall]]).tolist():
        if not number:
            continue
        low, high = scene.inclusions[number - 1].bounds()
        sides = network.wall_side[bodies.at_wall & (network.phase[network.wall_particle] == number)]
        for side in np.unique(sides).tolist():
            axis, length = side // 2, scene.size[side // 2]
            gap = length - high[axis] if side % 2 else low[axis]
            if gap > TOUCH * length:
                raise NotImplementedError(
                    f"the gap of {gap:.3g} m between a perfect conductor, {_named(number)}, and wall {SIDES[side]} is "
                    "too thin for these particles: must be more particles"
                )


def _named(phase):
    return f"Scene.inclusions[{phase - 1}]" if phase else "Scene.matrix"
