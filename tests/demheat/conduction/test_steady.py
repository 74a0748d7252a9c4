"""Only here: steady equations solved otherwise than directly, heat that passes particles, islands."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.sparse.linalg import spsolve

from demheat import Flux, Material, Scene, Sphere
from demheat.conduction.balance import at_walls, system_of, throughput
from demheat.conduction.steady import matrix, solve_steady
from demheat.dem.networks import network_of
from demheat.laws import Laguerre
from demheat.network.base import row_numbers
from demheat.packing.cache import relaxed

# Networks are solved here, not judged: how near the ball is to its walls for their particles does not matter.
pytestmark = pytest.mark.filterwarnings("ignore:gaps beside inclusions")

ONE = Material(1.0)


def built(scene, *, number=800, seed=2):
    packing = relaxed(number, size=scene.size, periodic=scene.periodic, seed=seed)
    return network_of(scene, packing, Laguerre(conforming=False))


def ball(k, **load):
    return Scene(size=(1, 1, 1), matrix=ONE, inclusions=[Sphere((0.5, 0.5, 0.5), 0.3, Material(k))], **load)


WALLS = {"walls": {"y-": 25.0, "y+": 35.0}}
PERIODIC = {"gradient": (0.0, 2.0, 0.0)}


@pytest.mark.parametrize(
    ("solver", "load", "k"),
    [("cg", WALLS, 1e-3), ("cg", PERIODIC, 100.0), ("amg", PERIODIC, 1e-3), ("amg-single", WALLS, 100.0)],
)
def test_against_a_direct_solver(solver, load, k):
    scene = ball(k, **load)
    network = built(scene)
    solution = solve_steady(network, scene, solver=solver, tolerance=1e-11)
    system = system_of(network, scene, np.ones(len(network.volumes), bool))
    a, b = matrix(network, system.diagonal).tolil(), system.heat.copy()
    if scene.periodic:  # the level is free: hold one particle
        a[0, :], b[0] = 0.0, 0.0
        a[0, 0] = 1.0
    x = spsolve(a.tocsc(), b) + system.level
    if scene.periodic:
        x -= np.average(x, weights=network.volumes)
    # tolerance 1e-11 of the heat passing times the condition of the system (about n^(2/3) times the contrast).
    assert_allclose(solution.temperature, x, atol=1e-6 * np.ptp(x), rtol=0)
    assert solution.stats["residual"] <= 1e-11 and solution.stats["solver"] == solver


def test_heat_that_passes_a_particle_is_what_enters_and_what_leaves_it():
    """Twice what enters, through walls as well as links: nothing is stored."""
    scene = ball(10.0, **WALLS)
    network = built(scene, number=200)
    solution = solve_steady(network, scene, tolerance=1e-12)
    system = system_of(network, scene, np.ones(len(network.volumes), bool))
    row, x = row_numbers(network.indptr), solution.temperature
    flows = network.conductance * (x[network.indices] - x[row])
    _, walls = at_walls(system, scene, x)
    entering = np.bincount(row, np.maximum(flows, 0.0), len(x))
    entering += np.bincount(network.wall_particle, np.maximum(walls, 0.0), len(x))
    # The solver's tolerance of the heat that passes all particles, over that of the least.
    assert_allclose(throughput(system, x - system.level), 2 * entering, rtol=1e-8)


@pytest.mark.parametrize("load", [WALLS, PERIODIC])
def test_islands_are_reported_and_left_without_a_temperature(load):
    scene = ball(0.0, **load)
    network = built(scene)
    solution = solve_steady(network, scene)
    inside = scene.phase_at(network.centers) == 1
    assert solution.stats["islands"] == inside.sum() > 50
    assert np.array_equal(np.isnan(solution.temperature), inside)


def test_conductances_are_left_as_they_were():
    scene = ball(0.0, **WALLS)
    network = built(scene)
    before = {name: part.copy() for name, part in network._asdict().items() if isinstance(part, np.ndarray)}
    assert {"conductance", "wall_conductance", "volumes"} <= set(before)
    solve_steady(network, scene)
    assert all(np.array_equal(part, getattr(network, name)) for name, part in before.items())


def test_flux_into_an_island_is_refused():
    corner = Sphere((0.5, 1.0, 0.5), 0.3, Material(0.0))
    scene = Scene(size=(1, 1, 1), matrix=ONE, inclusions=[corner], walls={"y-": 0.0, "y+": Flux(1.0)})
    with pytest.raises(ValueError, match="cut off from every wall temperature"):
        solve_steady(built(scene), scene)


@pytest.mark.parametrize("solver", ["cg", "amg"])
def test_no_convergence_is_an_error(solver):
    scene = ball(100.0, **WALLS)
    with pytest.raises(RuntimeError, match="relative residual"):
        solve_steady(built(scene), scene, solver=solver, tolerance=1e-10, max_iterations=3)


def test_high_contrast_asks_for_a_looser_tolerance():
    scene = ball(1e12, **WALLS)
    network = built(scene, number=300)
    with pytest.raises(
        RuntimeError, match=r"at a contrast of 1\.0e\+12: must be tolerance = 1e-06, which is mostly met"
    ):
        solve_steady(network, scene)
    assert solve_steady(network, scene, tolerance=1e-6).stats["residual"] <= 1e-6
    # A failure at a mild contrast is another matter.
    with pytest.raises(RuntimeError, match=r"asked for 1\.0e-08$"):
        solve_steady(network, ball(10.0, **WALLS), max_iterations=1)
