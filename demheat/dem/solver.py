"""The discrete element method: a packing, its network of conductances, and the field they give."""

import time
from dataclasses import replace
from functools import partial

import numpy as np

from demheat.conduction.good import good_bodies, solve_good
from demheat.conduction.perfect import check_perfect, solve_perfect
from demheat.conduction.steady import MOST_ITERATIONS, TOLERANCE, check_solver, solve_checked
from demheat.conduction.varying import solve_varying
from demheat.dem.estimate import check_contrast, estimator_of, extrapolator_of
from demheat.dem.gaps import reaching
from demheat.dem.networks import networks_of
from demheat.dem.options import MIB, Particles, check_fits, expected_bytes, expected_unknowns
from demheat.dem.warm import Helper, cells, parts_of
from demheat.field import Field
from demheat.laws import TWO_POINTS, Calibrated, Choices, Laguerre, Platonic
from demheat.packing.base import Packing
from demheat.runtime.deadline import budget
from demheat.runtime.progress import announced, stage
from demheat.sampling.field_of import field_of
from demheat.scene import Scene, check_scene
from demheat.scene.perfect import as_good
from demheat.tensor import axis_loads


def solve(
    scene: Scene,
    *,
    law: str | Laguerre | Calibrated | Platonic = "laguerre",
    particles: int = 100_000,
    seed: int = 0,
    solver: str = "auto",
    tolerance: float = TOLERANCE,
    seconds: float | None = None,
    conforming: bool | None = None,
    interface: str | None = None,
    gap_spacing: float | None = None,
    sparse: str | None = None,
    wall: str | None = None,
    coordination: float | None = None,
    gap: float | None = None,
    packing: Packing | None = None,
    replicas: int | None = None,
    allow_few: bool = False,
) -> Field:
    """Steady conduction in a scene by the discrete element method.

    Pores, of conductivity 0, have no flux and no temperature, see `demheat.field`.

    Parameters
    ----------
    scene : Scene
    law : Laguerre, Calibrated, Platonic or {"laguerre", "calibrated", "platonic"}
        Transmission surfaces: facets of the radical tessellation; or C_t pi R_m^2 between touching particles with C_t
        from a homogeneous solve (Haddad et al. 2021, eqs. 7-9); or faces of regular polyhedra, by the number of
        contacts of each particle (Terreros et al. 2013, section 4), whose volumes do not add up to that of the body.
    particles : int
        Number of particles before twins are added at interfaces; of conforming cells in a periodic box, which are cut
        by tiles, met within 3 % in cubes.
    seed : int
        Of the packing; how tiles are turned and shifted.
    solver : {"auto", "cg", "amg", "amg-single"}
        Of the equations: conjugate gradients preconditioned by the diagonal, or by multigrid, which "auto" takes for
        many; "amg-single" spares a tenth of the multigrid's memory and takes as many iterations.
    tolerance : float
        On the relative residual of the heat balance.
    seconds : float, s, optional
        That it may take, see `demheat.budget`; `Field.error` is not in it.
    conforming, interface, gap_spacing, sparse, wall, coordination, gap : bool, str, float, str, str, float, float
        Choices of a law that is given by its name; None is its own default, see `demheat.Laguerre`,
        `demheat.Calibrated` and `demheat.Platonic`.
    packing : Packing, optional
        Used instead of tiles or a relaxed one; must have the scene's box and periodicity. A copy is taken.
    replicas : int, optional
        Where there are no tiles, of a smaller relaxed packing, along the box's shortest side. By default more than
        2 million particles are replicas of 250 000 or fewer, which cost a few CPU-seconds instead of 90 for each
        million, and are as accurate. Between walls only with law "laguerre", and in boxes only.
    allow_few : bool, optional
        Accept fewer than 100 particles.

    Returns
    -------
    Field

    Raises
    ------
    ValueError
        If an argument is not as described, before any heavy work.
    NotImplementedError
        For temperatures on walls that meet, or heat exchanged with surroundings, with wall "center" and a law other
        than "laguerre"; for replicas between walls with such a law; for surfaces with a resistance, unless facets lie
        on them; for contrasts at which a trial with few particles drowns in rounding: from 1e8 or 1e9 on where walls
        radiate or conductivities follow the temperature.
    RuntimeError
        If the solver does not converge.
    TimeoutError
        If the seconds are over.

    Warns
    -----
    UserWarning
        If interfaces are so near to each other or to a wall that particles do not fit between them, an inclusion holds
        no particle, or is thin for particles without twins, or twins in narrow gaps are over five times as many as
        particles, or the spheres of a given packing are far apart.
    DeprecationWarning
        For replicas where tiles do: they will be refused there.

    Examples
    --------
    >>> from demheat import gallery, solve
    >>> field = solve(gallery.sphere_in_cube(5.0), particles=2000)
    >>> print(f"{field.conductivity:.1f} W/(m K)")  # exactly 42.640
    42.6 W/(m K)
    >>> field.error.lower < 42.6403 < field.error.upper
    True
    """
    check_scene(scene)
    check_solver(solver, tolerance)
    choices = Choices(
        conforming=conforming,
        interface=interface,
        gap_spacing=gap_spacing,
        sparse=sparse,
        wall=wall,
        coordination=coordination,
        gap=gap,
    )
    wanted = Particles(particles=particles, seed=seed, packing=packing, replicas=replicas, allow_few=allow_few)
    law = choices.law(law)
    check_fits(wanted, law)
    scene.require(TWO_POINTS, steady=True, takes=("resistance", "exchange", "dependence", "image", "perfect"))
    law.check(scene)
    check_perfect(scene)
    with budget(seconds):
        check_contrast(scene, wanted, tolerance, partial(_answer, scene, law, solver=solver))
        return _answer(scene, law, wanted, solver=solver, tolerance=tolerance)


def solve_axes(
    scene: Scene,
    *,
    law: str | Laguerre | Calibrated | Platonic = "laguerre",
    particles: int = 100_000,
    seed: int = 0,
    solver: str = "auto",
    tolerance: float = TOLERANCE,
    seconds: float | None = None,
    conforming: bool | None = None,
    interface: str | None = None,
    gap_spacing: float | None = None,
    sparse: str | None = None,
    wall: str | None = None,
    coordination: float | None = None,
    gap: float | None = None,
    packing: Packing | None = None,
    replicas: int | None = None,
    allow_few: bool = False,
) -> tuple[Field, Field, Field]:
    """Steady conduction along x, y and z in one body, for its conductivity tensor: packed and tessellated once.

    The fields are those that `solve` finds for the scenes of `demheat.tensor.axis_loads`, of one network, or of one for
    each load where a law is calibrated along it, and in a periodic cell without pores of one multigrid.

    Parameters
    ----------
    scene : Scene
        A periodic cell, or a box between two isothermal walls with four insulated faces.
    law, particles, seed, solver, tolerance, seconds
        As those of `solve`, which also says what is raised and warned of.
    conforming, interface, gap_spacing, sparse, wall, coordination, gap, packing, replicas, allow_few : optional
        As those of `solve`.

    Returns
    -------
    tuple of three Fields
        Under loads along x, y and z; `demheat.tensor.conductivity_tensor` takes them. Seconds in their `stats` but
        `solve_s` are those of what they share.

    Raises
    ------
    NotImplementedError
        If the load is another.

    Examples
    --------
    >>> from demheat import dem, gallery, tensor
    >>> fields = dem.solve_axes(gallery.laminate(), particles=1000)
    >>> tensor.conductivity_tensor(fields).diagonal().round(3)  # 33 and 165 W/(m K) in turn: along, across, along
    array([99., 55., 99.])
    """
    loads = axis_loads(scene)
    check_solver(solver, tolerance)
    choices = Choices(
        conforming=conforming,
        interface=interface,
        gap_spacing=gap_spacing,
        sparse=sparse,
        wall=wall,
        coordination=coordination,
        gap=gap,
    )
    wanted = Particles(particles=particles, seed=seed, packing=packing, replicas=replicas, allow_few=allow_few)
    law = choices.law(law)
    check_fits(wanted, law)
    law.check(scene)
    check_perfect(scene)
    with budget(seconds):
        check_contrast(scene, wanted, tolerance, partial(_answers, loads, law, solver=solver))
        return tuple(_answers(loads, law, wanted, solver=solver, tolerance=tolerance))


def _answers(scenes, law, wanted, *, solver, tolerance, max_iterations=MOST_ITERATIONS, change=None):
    """Solve scenes that differ in their loads only, as they were checked; `change` makes other networks of theirs."""
    wanted.check(scenes[0], law)
    begun, needed = time.perf_counter(), expected_bytes(expected_unknowns(scenes[0], law, wanted))
    with announced("DEM", needed), Helper(parts_of(law, wanted.particles)) as helper:
        packing = wanted.packed(scenes[0], law)
        spent = {"expected_mib": needed / MIB, "packing_s": time.perf_counter() - begun}
        helper.join(cells)
        how = {"seed": wanted.seed, "perfect": np.array([each.perfect for each in scenes[0].materials])}
        networks = networks_of([as_good(each) for each in scenes], packing, law, **how)
        del packing  # twins may have been added to a copy
        if change is not None:
            networks = [change(network, scene) for network, scene in zip(networks, scenes, strict=True)]
        helper.join()
    with announced("DEM", needed):
        how = {"solver": solver, "tolerance": tolerance, "max_iterations": max_iterations}
        return _fields(scenes, networks, law, wanted, spent, **how)


def _fields(scenes, networks, law, wanted, spent, *, solver, tolerance, max_iterations):
    """Solve networks; `spent` is of the fields' stats."""
    fields, kept = [], {}
    how = {"solver": solver, "tolerance": tolerance, "max_iterations": max_iterations}
    for scene, network in zip(scenes, networks, strict=True):
        connected = time.perf_counter()
        network, shown, solution = _conducting(network, scene, how, kept)
        took = spent | {"solve_s": time.perf_counter() - connected}
        answer = partial(_answer, scene, solver=solver, tolerance=tolerance)
        told = {
            "estimator": partial(reaching, estimator_of(law, wanted, answer), answer=partial(answer, law, wanted)),
            "extrapolator": extrapolator_of(law, wanted, answer),
        }
        with stage("field"):
            field = field_of(shown, network, solution, stats=took, **told)
            fields.append(field if shown is scene else replace(field, scene=scene))
    return fields


def _conducting(network, scene, how, kept):
    """The network and the scene that a solution is to be read with, and the solution."""
    if scene.perfect:
        return solve_perfect(network, scene, **how)
    if scene.varies:
        network, solution = solve_varying(network, scene, **how)
        return network, scene, solution
    good = None if scene.radiates else good_bodies(network, scene)
    found = None if good is None else solve_good(network, scene, good, **how)
    return found or (network, scene, solve_checked(network, scene, **how, kept=kept))


def _answer(scene, law, wanted, *, solver, tolerance, max_iterations=MOST_ITERATIONS, change=None):
    how = {"solver": solver, "tolerance": tolerance, "max_iterations": max_iterations, "change": change}
    return _answers([scene], law, wanted, **how)[0]
