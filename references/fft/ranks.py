"""A scene on voxels by all ranks of an MPI run together, each its slab of the grid: the scalar scheme.

`mpiexec -n 2 python -m demheat.mpi scene.toml --method fft --voxels 512`; or, on every rank alike, `solve`.
"""

import math
from collections.abc import Sequence
from functools import cache, partial

import numpy as np

from demheat.beyond import ranks
from demheat.field import Field
from demheat.scene import Scene
from demheat.scene.turned import turned as turned_scene
from references.fft.cg import nodes_of, solved
from references.fft.checks import LAMINATED, Knobs, check_grid, check_load, checked, rule_of
from references.fft.estimate import estimated
from references.fft.grid import Grid
from references.fft.interpolation import ask, flux_at, samples, temperature_at
from references.fft.memory import OWN
from references.fft.pencils import Pencils, most_ranks
from references.fft.rules import warn_of_thin
from references.fft.slabs import Slab, SlabSystem, painted, slab_of
from references.fft.solver import UNSAID, USUAL
from references.fft.units import Units, linear_part, mean_flux, order_of, problem_of, units_of, wall_heat
from references.threads import Team
from references.voxels.paint import grid_shape

# Least bytes that a voxel takes: four vectors, its phase, and three fields of the transform, two if all is in place.
BYTES = {True: 50, False: 58}
KNOWS = (
    "fft on ranks solves scheme 'cg' with rule 'laminate' or 'plain' where all phases conduct; fft.solve does the "
    "others on one machine"
)


def solve(
    scene: Scene,
    *,
    voxels: int | Sequence[int] | None = None,
    scheme: str = "cg",
    rule: str = "laminate",
    tolerance: float | None = None,
    max_iterations: int = 5000,
) -> Field:
    """Solve what `fft.solve` solves, in double precision, on all ranks of an MPI run.

    To be called by every rank with the same arguments; what it returns, too, is to be asked by all of them at the same
    time. Temperatures and fluxes at points are interpolated between voxels: fits reach beyond the planes of a rank.
    """
    knobs = checked(scheme, rule, "float64", tolerance, max_iterations, 1)
    grid, knobs = _planned(scene, voxels, knobs)
    comm = world()
    order = order_of(scene)
    box, shape = turned_scene(scene, order), tuple(grid[axis] for axis in order)
    check_grid(box, knobs.rule, shape)
    _check_ranks(shape, box, comm)
    ranks.check_fits("voxels", voxels or grid, needed(scene, grid), comm, power=3)
    costs, slab = ranks.Costs(comm), slab_of(shape, not box.periodic, comm)
    with costs.of("voxels"):
        held = painted(box, slab, laminate=LAMINATED[knobs.rule])
        if box.inclusions and comm.rank == 0:
            warn_of_thin(box, knobs.rule, shape)
    slope, level = linear_part(box)
    planes = slab.low - 1, shape[0]
    known = Grid(box, order=order, voxels=held, slope=slope, level=level, sharp=False, planes=planes)
    units = units_of(known)
    with costs.of("solve"):
        solution = _solution(known, units, knobs, slab)
    stats = {"ranks": comm.size, "solver": "mpi4py-fft"} | costs.stats()
    return _field(scene, (known, slab, units), solution, knobs, stats)


def world():
    """The communicator of all ranks."""
    return ranks.imported("mpi4py_fft", instead="fft.solve")[0].COMM_WORLD


def outlook(scene: Scene, *, voxels=None) -> str:
    """What a solve will take on this machine, in words."""
    grid = grid_shape(scene, voxels, USUAL)
    return f"{' x '.join(map(str, grid))} voxels, {ranks.outlook(needed(scene, grid), world())}"


def needed(scene: Scene, grid) -> float:
    """Bytes that a solve takes at its peak, of all ranks."""
    return float(math.prod(grid)) * (BYTES[not scene.periodic] + (OWN if scene.anisotropic else 0))


def _planned(scene, voxels, knobs):
    """Voxels along each side, and knobs with a rule that is known here."""
    check_load(scene)
    grid = grid_shape(scene, voxels, USUAL)
    knobs = rule_of(scene, grid, knobs)
    if knobs.scheme != "cg" or knobs.rule == "links":
        raise NotImplementedError(f"scheme {knobs.scheme!r}, rule {knobs.rule!r}: {KNOWS}")
    scene.require(KNOWS, pores=False, takes=("anisotropy", "image"))
    return grid, knobs


def _check_ranks(shape, box, comm):
    nodes = (shape[0] - 1, shape[1] + 1, shape[2] + 1) if not box.periodic else shape
    most = most_ranks(nodes, not box.periodic)
    if comm.size > most:
        raise ValueError(f"ranks = {comm.size}: {shape} voxels make so many slabs of planes; must be at most {most}")


def _solution(grid: Grid, units: Units, knobs: Knobs, slab: Slab):
    problem = problem_of(grid, units, knobs, Team(1))
    nodes = nodes_of(problem, slab.shape)
    system = SlabSystem(problem, slab, Pencils(nodes, problem.walls, slab.comm))
    try:
        return solved(problem, system)
    finally:
        system.transform.free()


def _field(scene, parts, solution, knobs, stats):
    """The solution in the user's units and axes; what is costly is made when asked for."""
    grid, slab, units = parts

    @cache
    def held():
        temperature, flux = solution.state()
        return grid._replace(temperature=temperature * units.temperature, flux=flux * -units.flux)

    def at(evaluate, points):
        """Each by the rank in whose slab it lies."""
        plane = np.floor(points[:, grid.order[0]] / grid.voxels.spacing[0]).astype(int)
        plane = plane % slab.shape[0] if grid.scene.periodic else np.clip(plane, 0, slab.shape[0] - 1)
        first = slab.low - slab.voxels.start
        own = np.flatnonzero((plane >= slab.voxels.start + first) & (plane < slab.voxels.stop + first))
        found = evaluate(held(), ask(held(), points[own]))
        values = np.zeros((len(points), *found.shape[1:]))
        values[own] = found
        return slab.comm.allreduce(values)

    shape = tuple(slab.shape[a] for a in np.argsort(grid.order))
    found = {"unknowns": solution.unknowns, "iterations": solution.iterations, **solution.errors, **solution.cost}
    asked = {name: value for name, value in knobs._asdict().items() if name not in UNSAID}
    same = {name: getattr(knobs, name) for name in ("scheme", "rule", "tolerance", "max_iterations")}
    return Field(
        scene=scene,
        mean_flux=mean_flux(grid, units, solution),
        fractions=grid.voxels.fractions,
        sampler=lambda: samples(_whole(held(), slab)),
        temperature_at=partial(at, temperature_at),
        flux_at=partial(at, flux_at),
        wall_temperature=scene.wall_temperatures,
        wall_heat=wall_heat(scene, units, solution),
        stats={**found, **asked, "voxels": shape, **stats},
        estimator=partial(estimated, solve=partial(solve, **same)),
    )


def _whole(grid, slab):
    """The grid of all ranks, gathered on each of them."""
    own = slab.voxels
    flux = np.stack([slab.gathered(each[own]) for each in grid.flux])
    voxels = grid.voxels._replace(phase=slab.gathered(grid.voxels.phase[own]))
    return grid._replace(voxels=voxels, temperature=slab.gathered(grid.temperature[own]), flux=flux, planes=None)
