"""A scene solved slab by slab: packing, cells and networks one slab at a time, then all equations from disk."""

from __future__ import annotations

import time
import warnings

import numpy as np

from demheat import dem
from demheat.build import warn_of_twins
from demheat.conduction.steady import AMG_UNKNOWNS, solve_checked
from demheat.dem.estimate import estimator_of
from demheat.dem.memory import MIB, unknowns
from demheat.dem.options import Particles
from demheat.field import Field
from demheat.laws import Laguerre
from demheat.runtime.deadline import budget
from demheat.runtime.limits import check_memory, check_room
from demheat.runtime.progress import announced, stage
from demheat.scene import Scene
from demheat.scene.inputs import whole
from demheat.streamed.equations import joined, number_all
from demheat.streamed.field import field_of
from demheat.streamed.memory import expected, on_disk
from demheat.streamed.store import Parts, Store, checked_folder
from demheat.tiles.cells import cells_of, check_filled, conformed, packed
from demheat.tiles.checks import check
from demheat.tiles.slabs import most_slabs, slabs_of

KNOWS = "demheat.streamed solves steady conduction in boxes without pores, by the discrete element method"
# From a million particles on the solve takes about as much memory as the cells of so many slabs: more would cost time.
USUAL = 4


def solve(
    scene: Scene,
    *,
    folder,
    law: Laguerre | None = None,
    particles: int = 1_000_000,
    slabs: int | None = None,
    seed: int = 0,
    tolerance: float = 1e-8,
    replicas: int | None = None,
    seconds: float | None = None,
) -> Field:
    """Steady conduction in a scene by the discrete element method, for more particles than fit into memory as a whole.

    The body is cut into slabs. Particles, twins and cells of one slab are in memory at a time and written to a folder;
    the matrix is mapped from there while it is solved, and the field reads a slab again when it is asked for something.
    The answer is that of `demheat.solve`, to the tolerance of the equations.

    Parameters
    ----------
    scene : Scene
        A box without pores; conductivities are numbers, walls do not radiate.
    folder : path
        New or empty, on a disk with some kilobyte of room for each particle. The field needs it for all but its
        conductivity, mean flux and walls; it is the user's to remove.
    law : Laguerre, optional
    particles : int
    slabs : int, optional
        Default: 4, or as many as the particles allow; more take less memory for the cells and more time.
    seed, tolerance, replicas
        As those of `demheat.solve`.
    seconds : float, s, optional
        That it may take, see `demheat.budget`; then TimeoutError. What is asked of the result is not in it.

    Returns
    -------
    Field
        With `stats` of `demheat.solve`, and slabs and folder besides.

    Raises
    ------
    ValueError
        If an argument is not as described; or for more particles than fit into the free memory or onto the disk,
        before any heavy work.
    NotImplementedError
        If the scene is another.
    RuntimeError
        If the solver does not converge.

    Examples
    --------
    >>> import tempfile
    >>> from demheat import gallery, streamed
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     field = streamed.solve(gallery.sphere_in_cube(5.0), folder=folder, particles=5000, slabs=2)
    ...     print(f"{field.conductivity:.1f} W/(m K)")  # exactly 42.640
    42.6 W/(m K)
    """
    with budget(seconds):
        return _solved(scene, folder, law, particles, slabs, seed, tolerance, replicas)


def _solved(scene, folder, law, particles, slabs, seed, tolerance, replicas):
    law = Laguerre() if law is None else law
    wanted = Particles(particles=particles, seed=seed, replicas=replicas)
    check(scene, law, wanted, tolerance, knows=KNOWS)
    path, cuts = checked_folder(folder), _cuts(scene, wanted.particles, slabs)
    number = unknowns(scene, law, wanted)
    # The packing may be in the cache: what it would take is said, not asked for.
    check_memory("particles", wanted.particles, expected(number, cuts[0]))
    check_room("folder", path, on_disk(number, cuts[0]))
    packed_at_once = 0 if wanted.tiles(scene, law) else wanted.particles / wanted.repeats(scene, law).prod()
    needed = expected(number, cuts[0], packed_at_once)
    with announced("DEM in slabs", needed):
        return _answer(scene, law, wanted, Parts(scene, Store(path), cuts, []), tolerance, needed)


def _cuts(scene, particles, slabs):
    """The slabs of a body, as each of them sees all."""
    most = most_slabs(slabs_of(scene, particles, 1, 0, name="slabs"))
    number = min(USUAL, most) if slabs is None else whole("slabs", slabs, "an integer >= 1", lambda v: v >= 1)
    return [slabs_of(scene, particles, number, rank, name="slabs") for rank in range(number)]


def _answer(scene, law, wanted, parts, tolerance, needed):
    begun = time.perf_counter()
    made = _cut(law, wanted, parts)
    number_all(parts)
    cut = time.perf_counter()
    network = joined(parts)
    try:
        by_size = "amg-single" if len(network.volumes) > AMG_UNKNOWNS else "cg"
        solution = solve_checked(network, scene, solver=by_size, tolerance=tolerance)
    finally:
        del network
        parts.store.drop_matrix()
    spent = {"cells_s": cut - begun, "solve_s": time.perf_counter() - cut}
    estimator = estimator_of(law, wanted, lambda law, wanted: _coarser(scene, law, wanted, tolerance))
    stats = {"law": law.name, "calibration": 1.0, "slabs": len(parts.cuts), "folder": str(parts.store.folder)}
    stats |= {"expected_mib": needed / MIB, **solution.stats, **made, **spent}
    with stage("field"):
        field = field_of(parts, solution, estimator=estimator, stats=stats)
    if np.any(field.fractions == 0):
        lost = np.flatnonzero(field.fractions == 0) - 1
        warnings.warn(f"no particle lies in inclusions {lost[:8].tolist()}: use more particles", stacklevel=4)
    return field


def _cut(law, wanted, parts):
    """Make the network of each slab and write it; what a field's `stats` say of all."""
    scene, volume = parts.scene, 0.0
    with stage("slabs") as done:
        for slabs in parts.cuts:
            done(slabs.rank / len(parts.cuts))
            packing, part = packed(scene, law, wanted, slabs)
            packing = conformed(packing, part, scene, law, wanted)
            if law.conforming and slabs.rank == 0:
                warn_of_twins(packing, wanted.particles)
            cells = cells_of(scene, law, packing, slabs)
            volume += float(cells.network.volumes[: cells.own].sum())
            parts.store.write(slabs.rank, cells)
            parts.own.append(cells.own)
            # Twins aside, whose radii are raised by slabs.
            made = {"packing": packing.provenance, "mean_radius": part.radius}
            # Before the next is made.
            del packing, cells
    check_filled(volume, scene)
    return made


def _coarser(scene, law, wanted, tolerance):
    """A run with fewer particles, for the error: a quarter of them takes less memory as a whole."""
    same = {"seed": wanted.seed, "allow_few": wanted.allow_few, "tolerance": tolerance}
    return dem.solve(scene, law=law, particles=wanted.particles, **same)
