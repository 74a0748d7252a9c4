"""A scene by finite elements on all ranks of an MPI run together: one mesh, which all hold, and equations in parts.

`mpiexec -n 2 python -m demheat.mpi scene.toml --method fem --size 0.002`; or, on every rank alike, `solve`. The first
rank makes the mesh and hands it on. Each assembles the elements that touch its nodes, so that its rows are whole, and
PETSc solves.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from demheat.beyond import ranks
from demheat.beyond.petsc import solver_of
from demheat.field import Field
from demheat.runtime.process_state import one_blas_thread
from demheat.scene import Scene, check_scene
from demheat.scene.inputs import finite
from references.fem.estimate import estimated
from references.fem.shares import assembled, shares_of, unknown_rows
from references.fem.solver import field_of, warn_of_gaps
from references.fem.system import Solved, at_walls, given_part
from references.mesh import make
from references.mesh.sizes import CELLS, checked_size

# Least bytes for a tetrahedron of either order, by count: of the mesh, which each rank holds; and of the equations,
# rows as they are, scaled, and PETSc's, with half as much again for multigrid.
HELD, SOLVED = {1: 35, 2: 90}, {1: 120, 2: 1500}
KNOWS = (
    "fem on ranks solves steady conduction in boxes and periodic cells where all phases conduct, with temperatures and "
    "fluxes on walls; fem.solve does the others on one machine"
)
ROUNDS, MOST = 3, 5000


def solve(
    scene: Scene,
    *,
    order: int = 2,
    size: float | None = None,
    curved: bool = True,
    tolerance: float = 1e-9,
    options: str = "",
) -> Field:
    """Solve a scene by finite elements, with equations in parts on all ranks of an MPI run.

    To be called by every rank with the same arguments. Each has the whole mesh, and of what is returned all of it.
    """
    _check(scene, order, size, tolerance)
    ranks.check_fits(
        "tetrahedra", round(_tetrahedra(scene, size, order)), needed(scene, order=order, size=size), world()
    )
    return _answer(scene, tolerance, options, size=size, order=order, curved=curved)


def world():
    """The communicator of all ranks."""
    return _both()[0].COMM_WORLD


def outlook(scene: Scene, *, order: int = 2, size: float | None = None) -> str:
    """What a solve will take on this machine, in words."""
    tetrahedra, bytes_needed = _tetrahedra(scene, size, order), needed(scene, order=order, size=size)
    return f"{tetrahedra:.2g} tetrahedra or more, {ranks.outlook(bytes_needed, world())}"


def needed(scene: Scene, *, order: int = 2, size: float | None = None) -> float:
    """Bytes that a solve takes at its peak, of all ranks."""
    return _tetrahedra(scene, size, order) * (HELD[order] * world().size + SOLVED[order])


def _tetrahedra(scene, size, order):
    """Of a uniform mesh; features make them more."""
    return CELLS * scene.volume / checked_size(scene, size, order) ** 3


def _both():
    return ranks.imported("petsc4py.PETSc", instead="fem.solve")


def _check(scene, order, size, tolerance):
    check_scene(scene)
    finite("tolerance", tolerance, "a number between 0 and 1", lambda v: 0 < v < 1)
    scene.require(KNOWS, steady=True, domain="box", pores=False, takes=("anisotropy",))
    edge = checked_size(scene, size, order)
    if order == 1:
        warn_of_gaps(scene, edge)


def _answer(scene, tolerance, options, **elements):
    comm = world()
    costs = ranks.Costs(comm)
    with costs.of("mesh"):
        mesh = _from_first(lambda: make(scene, **elements), comm)
        given = given_part(scene, mesh, np.ones(len(mesh.cells), dtype=bool))
        share = shares_of(mesh, given.shares > 0, comm)
    unit = scene.mean_conductivities[mesh.phase].max()
    with costs.of("assembly"):
        matrix, load = one_blas_thread()(assembled)(scene, mesh, share, given.lift, unit)
        for name, value in scene.wall_fluxes.items():
            load += value / unit * given.weights[name][share.own]
    with costs.of("solve"):
        correction, stats = _solved(matrix, load, share, tolerance, options)
        heat = share.whole(unit * (matrix @ correction - load))
    temperature = given.lift + correction[share.dof]
    temperature += given.level
    solved = Solved(temperature, *at_walls(scene, given, temperature, heat, {}), stats)
    kind = "linear" if elements["order"] == 1 else "curved" if elements["curved"] else "straight"
    again = partial(_again, scene, tolerance, options, elements)
    with costs.of("field"):
        field = field_of(scene, mesh, solved, tolerance, partial(estimated, again=again, kind=kind))
    return replace(field, stats=dict(field.stats) | {"ranks": comm.size, "solver": "petsc"} | costs.stats())


def _again(scene, tolerance, options, elements, **changed):
    """The same by other elements, of the same length if nothing else is said."""
    size = checked_size(scene, elements["size"], elements["order"])
    return _answer(scene, tolerance, options, **elements | {"size": size} | changed)


def _from_first(work, comm):
    """What the first rank makes, on all of them; what it raises, too."""
    found = None
    if comm.rank == 0:
        try:
            found = work()
        except (ValueError, NotImplementedError, RuntimeError, ImportError) as error:
            found = error
    found = comm.bcast(found, root=0)
    if isinstance(found, Exception):
        raise found
    return found


def _solved(matrix, load, share, tolerance, options):
    """Corrections at all nodes that are a row, and how they were found."""
    equations, root = unknown_rows(matrix, share)
    own = share.own[share.free]
    x, iterations, residual = _in_parts(equations, load[share.free] / root[own], root[own], tolerance, options)
    if not residual <= tolerance:
        raise RuntimeError(
            f"finite elements: residual {residual:.2e} > tolerance {tolerance:.2e} after {iterations} iterations on "
            f"{equations.shape[1]} unknowns"
        )
    found = np.zeros(len(share.own))
    found[share.free] = x / root[own]
    return share.whole(found), {"unknowns": equations.shape[1], "iterations": iterations, "residual": residual}


def _in_parts(rows, b, constant, tolerance, options):
    """Solve rows of all ranks; `constant` is what a constant temperature is in their scale."""
    (mpi, petsc), size = _both(), (len(b), rows.shape[1])
    comm = mpi.COMM_WORLD
    matrix = petsc.Mat().createAIJ((size, size), csr=(rows.indptr, rows.indices, rows.data), comm=comm)
    for option in (petsc.Mat.Option.SYMMETRIC, petsc.Mat.Option.SPD):
        matrix.setOption(option, True)
    known, right, x, step = (matrix.createVecRight() for _ in range(4))
    known.array[:], right.array[:], x.array[:] = constant, b, 0.0
    known.normalize()
    matrix.setNearNullSpace(petsc.NullSpace().create(vectors=[known], comm=comm))
    solver = solver_of(matrix, options, petsc, comm)
    whole, iterations, residual = right.norm(), 0, 0.0
    # Rounding can part the recursive residual from the true one: start again from there.
    for _ in range(ROUNDS if whole > 0 else 0):
        left = right - matrix * x
        residual = left.norm() / whole
        if residual <= tolerance or iterations >= MOST:
            break
        solver.setTolerances(rtol=1e-30, atol=0.9 * tolerance * whole, max_it=MOST - iterations)
        solver.solve(left, step)
        x += step
        iterations += solver.its
    else:
        residual = (right - matrix * x).norm() / whole if whole > 0 else 0.0
    found = x.array_r.copy()
    for each in (solver, matrix, known, right, x, step):
        each.destroy()
    return found, iterations, residual
