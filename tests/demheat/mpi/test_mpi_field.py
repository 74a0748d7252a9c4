"""Only here: a Field of all ranks that is not that of one process, by threads in place of ranks."""

import numpy as np
import pytest
from ranks import on_ranks
from scipy.spatial import cKDTree

from demheat import Laguerre, Material, Scene, Sphere, solve
from demheat.conduction.balance import at_walls, system_of
from demheat.conduction.steady import Solution
from demheat.dem.options import Particles
from demheat.mpi.cells import cells_of, part_of
from demheat.mpi.field import field_of
from demheat.mpi.slabs import slabs_of

LAW = Laguerre()
SCENE = Scene(
    (2.0, 1.0, 1.0), Material(10.0), [Sphere((1.0, 0.4, 0.5), 0.3, Material(100.0))], walls={"x-": 300.0, "x+": 400.0}
)


def test_sums_and_points_of_all_ranks_are_those_of_one():
    wanted = Particles(particles=3000, seed=0)
    whole = solve(SCENE, particles=3000, tolerance=1e-13)
    points = np.random.default_rng(1).random((40, 3)) * SCENE.size
    nearest = cKDTree(whole.samples.points)

    def work(comm):
        slabs = slabs_of(SCENE, 3000, comm.size, comm.rank)
        cells = cells_of(SCENE, LAW, part_of(SCENE, LAW, wanted, slabs, comm), slabs, comm)
        temperature = whole.samples.temperature[nearest.query(cells.network.centers)[1]]
        system = system_of(cells.network, SCENE, np.ones(len(temperature), bool))
        solution = Solution(temperature, np.zeros(3), *at_walls(system, SCENE, temperature), {})
        field = field_of(SCENE, cells, solution, slabs, comm)
        at = field.temperature_at(points), field.flux_at(points), field.heat_through(0, 1.0)
        return field.conductivity, dict(field.wall_heat), dict(field.wall_temperature), field.fractions, *at

    for found in on_ranks(2, work):
        conductivity, heat, temperature, fractions, warm, flux, through = found
        assert conductivity == pytest.approx(whole.conductivity, rel=1e-9)  # cells at the cut differ by rounding
        assert heat == pytest.approx(dict(whole.wall_heat), rel=1e-9)
        assert temperature == pytest.approx(dict(whole.wall_temperature), rel=1e-12)
        np.testing.assert_allclose(fractions, whole.fractions, rtol=1e-9)
        np.testing.assert_allclose(warm, whole.temperature_at(points), rtol=1e-9)
        np.testing.assert_allclose(flux, whole.flux_at(points), rtol=1e-6, atol=1e-6 * np.abs(whole.mean_flux).max())
        assert through == pytest.approx(whole.heat_through(0, 1.0), rel=1e-7)
