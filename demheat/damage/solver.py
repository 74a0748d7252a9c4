"""Steady conduction in a damaged body by the discrete element method."""

import time
from collections.abc import Sequence

from demheat.conduction.steady import TOLERANCE, check_solver, solve_checked
from demheat.damage.cracks import Disc, Rectangle, check_cracks, cracked, seamed, warn_of_small
from demheat.damage.inclusions import drawn
from demheat.damage.links import without_links
from demheat.dem.networks import network_of
from demheat.dem.options import Particles, check_fits
from demheat.field import Field
from demheat.laws import Calibrated, Choices, Laguerre, Platonic
from demheat.packing.base import Packing
from demheat.runtime.deadline import budget
from demheat.runtime.progress import stage
from demheat.sampling.field_of import field_of
from demheat.scene import Scene, check_scene
from demheat.scene.inputs import whole


def solve(
    scene: Scene,
    *,
    removed: float = 0.0,
    draw: int = 0,
    cracks: Sequence[Disc | Rectangle] = (),
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
    """Steady conduction in a scene some of whose links are gone, or that has insulated cracks.

    Parameters
    ----------
    scene : Scene
        For inclusions that have come off see `demheat.damage.debonded`: any method solves such a scene.
    removed : float
        Share of the links between particles that conduct nothing, drawn at random among those that cracks leave.
    draw : int
        Seed of that draw.
    cracks : sequence of Disc and Rectangle
        In a periodic cell their images count. With facets on interfaces, law "laguerre", particles are mirrored in
        their planes; in any case links that cross them conduct nothing.
    law, particles, seed, solver, tolerance, seconds
        As those of `demheat.solve`.
    conforming, interface, gap_spacing, sparse, wall, coordination, gap, packing, replicas, allow_few : optional
        As those of `demheat.solve`.

    Returns
    -------
    Field
        It knows no error of itself. Where no heat can pass the conductivity is exactly 0. Near cracks temperatures are
        those of cells and their slopes, which know a crack only by the links that it cuts.

    Raises
    ------
    ValueError, NotImplementedError, RuntimeError
        As `demheat.solve`; ValueError also if the damage is not as described, before any heavy work.

    Warns
    -----
    UserWarning
        As `demheat.solve`, and if cracks are small for the particles.

    Examples
    --------
    >>> from demheat import Material, Scene, damage
    >>> from references.exact.cracks import discs
    >>> cell = Scene((1.0, 1.0, 1.0), Material(1.0), gradient=(0, 0, 1))
    >>> crack = damage.Disc(center=(0.5, 0.5, 0.5), radius=0.35, normal=(0, 0, 1))
    >>> field = damage.solve(cell, cracks=[crack], particles=2000)
    >>> print(f"{field.conductivity:.2f} {discs(0.35).conductivity:.2f}")
    0.88 0.89
    """
    check_scene(scene)
    check_solver(solver, tolerance)
    cracks = check_cracks(cracks)
    drawn(0, removed, whole("draw", draw, "an integer >= 0", lambda v: v >= 0), "removed")
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
    scene.require(steady=True, takes=("resistance", "exchange"))
    law.check(scene)
    with budget(seconds):
        network, spent = _network(scene, law, wanted, cracks)
        network = without_links(network, removed, seed=draw)
        begun = time.perf_counter()
        solution = solve_checked(network, scene, solver=solver, tolerance=tolerance)
        spent["solve_s"] = time.perf_counter() - begun
        with stage("field"):
            # What is broken may conduct as little as it likes.
            return field_of(scene, network, solution, stats=spent, slack=(1.0, 0.0))


def _network(scene, law, wanted, cracks):
    """The network of a body with cracks, and what its packing took."""
    begun = time.perf_counter()
    wanted.check(scene, law)
    packing = wanted.packed(scene, law)
    spent = {"packing_s": time.perf_counter() - begun}
    warn_of_small(packing, cracks)
    if cracks and law.conforming:
        packing = seamed(packing, cracks)
    return cracked(network_of(scene, packing, law, seed=wanted.seed), cracks), spent
