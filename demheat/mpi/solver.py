"""A scene solved by all ranks together: packing, cells, equations, field, each rank its slab."""

import warnings
from dataclasses import replace

import numpy as np

from demheat import dem
from demheat.beyond import ranks
from demheat.beyond.ranks import Costs, check_fits, cores, give_back, here
from demheat.conduction.balance import at_walls, linear_start, system_of
from demheat.conduction.steady import TOLERANCE, Solution, check_solver
from demheat.dem.estimate import estimator_of
from demheat.dem.options import Particles
from demheat.field import Field
from demheat.laws import Laguerre
from demheat.mpi.cells import cells_of, check_unknowns, part_of
from demheat.mpi.engines import petsc, world
from demheat.mpi.equations import Equations, solved
from demheat.mpi.field import field_of
from demheat.mpi.numbers import Ghosts, linked, numbers_of
from demheat.mpi.slabs import NOBODY, slabs_of
from demheat.runtime.threads import thread_limit
from demheat.scene import Scene, check_scene

# Least bytes that a particle takes at the peak, all ranks together, where they are many: about as many for what a rank
# sees as for solving for what it owns.
BYTES = 700
KNOWS = "demheat.mpi solves steady conduction in boxes without pores, by the discrete element method"


def solve(
    scene: Scene,
    *,
    law: Laguerre | None = None,
    particles: int = 1_000_000,
    seed: int = 0,
    tolerance: float = TOLERANCE,
    options: str = "",
    replicas: int | None = None,
    allow_few: bool = False,
) -> Field:
    """Steady conduction in a scene by the discrete element method, on all ranks of an MPI run.

    To be called by every rank with the same arguments; what it returns, too, is to be asked by all of them at the same
    time.
    """
    law = Laguerre() if law is None else law
    wanted = Particles(particles=particles, seed=seed, replicas=replicas, allow_few=allow_few)
    check(scene, law, wanted, tolerance)
    comm = world()
    slabs_of(scene, particles, comm.size, comm.rank)
    check_fits("particles", particles, BYTES * float(particles), comm)
    with thread_limit(max(1, cores() // here(comm))):
        return _answer(scene, law, wanted, comm, tolerance=tolerance, options=options)


def outlook(scene: Scene, *, particles: int = 1_000_000) -> str:
    """What a solve will take on this machine, in words."""
    return f"{particles} particles, {ranks.outlook(BYTES * float(particles), world())}"


def check(scene: Scene, law: Laguerre, wanted: Particles, tolerance: float) -> None:
    """Raise unless a scene can be solved slab by slab."""
    check_scene(scene)
    check_solver("auto", tolerance)
    if not isinstance(law, Laguerre):
        raise ValueError(f"law = {law!r}: must be a Laguerre, whose cells can be made by slabs")
    scene.require(KNOWS, steady=True, domain="box", pores=False, takes=("resistance", "exchange"))
    if scene.radiates:
        raise NotImplementedError(f"walls that radiate: {KNOWS}")
    law.check(scene)
    wanted.check(scene, law)


def _answer(scene, law, wanted, comm, **how):
    costs, slabs = Costs(comm), slabs_of(scene, wanted.particles, comm.size, comm.rank)
    with costs.of("packing"):
        made = [part_of(scene, law, wanted, slabs, comm)]
    with costs.of("cells"):
        # Handed over and not kept: what a rank sees of it is a copy.
        cells = cells_of(scene, law, made.pop(), slabs, comm)
        unknowns = check_unknowns(comm, cells.own)
    with costs.of("solve"):
        solution = _solved(scene, cells, slabs, comm, **how)
    stats = {"law": law.name, "calibration": 1.0, "packing": cells.packing, "ranks": comm.size, "solver": "petsc"}
    with costs.of("field"):
        estimator = estimator_of(law, wanted, lambda law, wanted: _coarser(scene, law, wanted, comm, **how))
        field = field_of(scene, cells, solution, slabs, comm, estimator=estimator)
    mean = comm.allreduce(float(cells.network.radii[: cells.own].sum())) / unknowns
    stats |= solution.stats | {"unknowns": unknowns, "mean_radius": mean} | costs.stats()
    if comm.rank == 0 and np.any(field.fractions == 0):
        lost = np.flatnonzero(field.fractions == 0) - 1
        warnings.warn(f"no particle lies in inclusions {lost[:8].tolist()}: use more particles", stacklevel=3)
    return replace(field, stats=stats)


def _solved(scene, cells, slabs, comm, *, tolerance, options):
    """Temperatures of all particles that a rank sees."""
    network, own, engine = cells.network, cells.own, petsc()
    reached = np.ones(len(network.volumes), dtype=bool)
    numbers = numbers_of(network, own, slabs, comm)
    system = system_of(network, scene, reached)
    # Iterations need what own rows link to, a third of what is seen of the neighbours or less.
    beside = Ghosts(np.where(linked(network, own), numbers, NOBODY), own, engine, comm)
    equations = Equations(system, beside, options, engine, comm)
    first = linear_start(network, scene, reached)[:own]
    x, iterations, size = solved(equations, system, beside, first, tolerance)
    equations.free()
    give_back()
    ghosts = Ghosts(numbers, own, engine, comm)
    if scene.periodic:
        x -= comm.allreduce(float(x @ network.volumes[:own])) / comm.allreduce(float(network.volumes[:own].sum()))
    temperature = ghosts.filled(x) + system.level
    stats = {"iterations": iterations, "residual": size}
    return Solution(temperature, system.gradient, *at_walls(system, scene, temperature), stats)


def _coarser(scene, law, wanted, comm, **how):
    """A run with fewer particles, for the error; on every rank by itself where there are too few for slabs."""
    try:
        slabs_of(scene, wanted.particles, comm.size, comm.rank)
    except ValueError:
        same = {"seed": wanted.seed, "allow_few": wanted.allow_few, "tolerance": how["tolerance"]}
        return dem.solve(scene, law=law, particles=wanted.particles, **same)
    return _answer(scene, law, wanted, comm, **how)
