"""Our network as equations: what its temperatures are worth, and solvers of others where they are installed."""

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from demheat.conduction.steady import solve_steady
from studies.peers import given, networks
from studies.peers.outside import Found
from studies.peers.programs import ours, petsc, pyamg


@pytest.fixture(scope="module")
def equations():
    return networks.system(given.scene("sphere 10"), 200)


def test_conductivity_is_that_of_the_heat_through_the_walls(equations):
    x = spsolve(equations.a.tocsc(), equations.b)
    solution = solve_steady(equations.network, equations.scene, tolerance=1e-12)
    heat = solution.wall_heat[equations.network.wall_side == 0].sum()
    assert equations.residual(x) < 1e-13
    assert equations.conductivity(x) == pytest.approx(heat, rel=1e-10)
    assert equations.start[0] == pytest.approx(1.0 - equations.network.centers[0, 0])


def test_temperatures_that_do_not_solve_are_found_out(equations):
    with pytest.raises(RuntimeError, match="residual"):
        networks.judged(equations, equations.start, Found(None, {}))


def test_pores_are_refused():
    with pytest.raises(NotImplementedError, match="pores"):
        networks.system(given.scene("pore"), 200)


@pytest.mark.parametrize("program", (petsc, pyamg, ours), ids=lambda program: program.TITLE)
def test_every_solver_finds_the_same(equations, program):
    if program.missing():
        pytest.skip(program.missing())
    for solver in {case["solver"] for case in program.CASES}:
        found = program.solve(equations.scene, particles=200, solver=solver)
        x = spsolve(equations.a.tocsc(), equations.b)
        # Residuals of 1e-10, by a condition of some hundreds.
        assert found.conductivity == pytest.approx(equations.conductivity(x), rel=1e-8)
        assert found.unknowns == len(x) and 0 < found.iterations < 200
    assert np.isfinite(found.cost["cpu_s"])
