"""Only here: fits across an interface or a wall, between particles; sections that lose heat."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import demheat
from demheat import Flux, Layer, Material, Scene, Sphere
from demheat.packing.base import make_packing
from demheat.packing.cache import relaxed
from demheat.sampling import reconstruct as module
from demheat.sampling.edges import Edges
from references import exact, multipole

ONE, FIVE = Material(1.0), Material(5.0)
BALL = Sphere((0.5,) * 3, 1 / 3, FIVE)
WALLS = {"y-": 0.0, "y+": 1.0}


def inside(number=400, seed=0):
    return np.random.default_rng(seed).random((number, 3))


def fitted_to(temperature, monkeypatch, *, steady):
    """The fit itself, without a solver and nearly without the ridge: from values at particles and any slopes."""
    name = "STEADY" if steady else "STORED"
    monkeypatch.setattr(module, name, getattr(module, name)._replace(ridge=1e-12))
    packing = relaxed(600, periodic=False, seed=2)
    field = demheat.solve(Scene(size=(1, 1, 1), matrix=ONE, walls=WALLS), packing=packing)
    network = caught(field).network
    rough = np.random.default_rng(0).standard_normal((len(network.centers), 3))
    none = Edges(np.zeros(601, dtype=int), *np.empty((2, 0, 3)), *np.empty((3, 0)))
    how = {"periodic": [False] * 3, "phase_at": field.scene.phase_at, "conductivity": np.full(600, 2.0)}
    values = temperature(network.centers)
    return module.Reconstruction(network, none, values, np.zeros(3), rough, **how, steady=steady)


def test_quadratic_temperatures_of_one_phase_are_exact(monkeypatch):
    curved = np.array([[1.0, 0.3, 0.0], [0.3, -2.0, 0.5], [0.0, 0.5, 0.7]])
    made = fitted_to(lambda x: np.einsum("ni,ij,nj->n", x, curved, x), monkeypatch, steady=False)
    points = inside()
    # Ridge times the error of the slopes, some 3, over the least eigenvalue of the fits, 1e-6.
    assert_allclose(made.temperature_at(points), np.einsum("ni,ij,nj->n", points, curved, points), atol=1e-7)
    assert_allclose(made.flux_at(points), -4.0 * points @ curved, atol=1e-5)


def test_harmonic_temperatures_of_third_order_are_exact_where_no_heat_is_stored(monkeypatch):
    made = fitted_to(lambda x: x[:, 0] ** 3 - 3 * x[:, 0] * x[:, 1] ** 2 + x[:, 1] * x[:, 2], monkeypatch, steady=True)
    # Off the walls: beside them few cells, and here no edges, leave a cubic open.
    points = 0.1 + 0.8 * inside()
    x, y, z = points.T
    # As above; cubics have eigenvalues ten times smaller still.
    assert_allclose(made.temperature_at(points), x**3 - 3 * x * y**2 + y * z, atol=1e-6)
    slope = np.column_stack([3 * x**2 - 3 * y**2, -6 * x * y + z, y])
    assert_allclose(made.flux_at(points), -2.0 * slope, atol=1e-4)


def caught(field):
    """The Reconstruction behind a field, caught when it is first made."""
    found = []
    keep = module.Reconstruction.__init__

    def spy(self, *args, **knobs):
        found.append(self)
        keep(self, *args, **knobs)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module.Reconstruction, "__init__", spy)
        field.temperature_at([[0.5, 0.5, 0.5]])
    return found[0]


def test_flux_beside_the_interface():
    """On both sides up to it: found 2.1 % rms with 3000 particles, 4.6 % from the cells' own fluxes there."""
    scene = Scene(size=(1, 1, 1), matrix=ONE, inclusions=[BALL], walls=WALLS)
    right, field = exact.solve(scene), demheat.solve(scene, particles=3000)
    rng = np.random.default_rng(1)
    way = rng.standard_normal((1000, 3))
    way /= np.linalg.norm(way, axis=1)[:, None]
    points = 0.5 + way * (1 / 3 + rng.uniform(-0.05, 0.05, 1000))[:, None]
    off = field.flux_at(points) - right.flux_at(points)
    assert np.sqrt((off**2).sum(axis=1).mean()) < 0.03 * abs(right.mean_flux[1])
    # On the interface itself both phases have one temperature: found 0.2 % of the span apart at most.
    inner, outer = (field.temperature_at(0.5 + way * (1 / 3 + shift)) for shift in (-1e-9, 1e-9))
    assert np.abs(inner - outer).max() < 5e-3


def test_held_walls_have_their_temperature():
    """Also at once after a jump, when no cell has felt it yet."""
    metal = Material(1.0, density=1.0, heat_capacity=1.0)
    scene = Scene(size=(1, 1, 1), matrix=metal, walls={"y+": 30.0}, initial=20.0)
    wall = inside(50) * [1, 0, 1] + [0, 1, 0]
    for field in demheat.evolve(scene, [0.0, 1e-3, 0.1], particles=3000):
        # A jump over a cell is no quadratic: found 1.1 K off at most.
        assert_allclose(field.temperature_at(wall), 30.0, atol=1.5)
        # It overshoots, most where the first layer of particles is one: found 5.8 K below among 4000 points, 4.1 here.
        assert field.temperature_at(inside()).min() > 20.0 - 6.0
    # Smooth by then.
    assert_allclose(field.temperature_at(wall), 30.0, atol=0.02)


def test_imposed_flux_is_met_at_its_wall():
    scene = Scene(size=(1, 1, 1), matrix=ONE, inclusions=[BALL], walls={"y-": 0.0, "y+": Flux(3.0)})
    field = demheat.solve(scene, particles=3000)
    wall = inside(200) * [1, 0, 1] + [0, 1, 0]
    # Down the gradient: into the body at y+. Elsewhere the flux differs by a factor of three.
    assert_allclose(field.flux_at(wall)[:, 1], -3.0, atol=0.1)


def test_nothing_is_fitted_across_an_interface():
    """A laminate is linear in each layer: exact up to the interfaces, on their right sides."""
    scene = Scene(size=(1, 1, 1), matrix=ONE, inclusions=[Layer(1, 0.3, 0.5, FIVE)], walls=WALLS)
    field = demheat.solve(scene, particles=2000, tolerance=1e-12)
    flux = -1 / (0.2 / 5 + 0.8)
    points = inside()
    points[:100, 1] = 0.3 - 1e-9
    points[100:200, 1] = 0.5 - 1e-9
    y = points[:, 1]
    rise = np.where(y < 0.3, y, np.where(y < 0.5, 0.3 + (y - 0.3) / 5, 0.34 + y - 0.5)) * -flux
    # Solver tolerance.
    assert_allclose(field.temperature_at(points), rise, atol=1e-9)
    assert_allclose(field.flux_at(points), np.tile([0.0, flux, 0.0], (400, 1)), atol=1e-7)


def test_weights_of_a_fit_are_flat_where_they_begin_and_where_they_end():
    step = np.array([1e-2, 1e-3, 1e-4])
    # (1 - r^2)^2: 1 - 2 r^2 at first, 4 (1 - r)^2 at last, to the next order.
    assert_allclose(1 - module._weight(step), 2 * step**2, rtol=1e-3)
    assert_allclose(module._weight(1 - step), 4 * step**2, rtol=2e-2)
    assert np.all(module._weight(np.array([1.0, 1.5, np.inf])) == 0.0)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_every_section_carries_the_same_heat(axis):
    letter = "xyz"[axis]
    walled = Scene(size=(1, 1.2, 0.8), matrix=ONE, inclusions=[BALL], walls={letter + "-": 0.0, letter + "+": 1.0})
    periodic = Scene(size=(1, 1.2, 0.8), matrix=ONE, inclusions=[BALL], gradient=(1.0, -2.0, 0.5))
    for scene, law in ((walled, "laguerre"), (periodic, "laguerre"), (periodic, "calibrated")):
        field = demheat.solve(scene, particles=600, law=law, tolerance=1e-12)
        area = np.prod(scene.size) / scene.size[axis]
        heat = [field.heat_through(axis, at * scene.size[axis]) for at in (0.0, 0.13, 0.5, 0.77, 0.999)]
        # Solver tolerance, times a few for sums over a section.
        assert_allclose(heat, field.mean_flux[axis] * area, rtol=1e-9)


def test_what_heat_through_refuses():
    scene = Scene(size=(1, 1, 1), matrix=ONE, inclusions=[BALL], walls=WALLS)
    field = demheat.solve(scene, particles=300)
    with pytest.raises(ValueError, match="position = 1.5"):
        field.heat_through(1, 1.5)
    with pytest.raises(NotImplementedError, match="only the DEM"):
        exact.solve(scene).heat_through(1, 0.5)


def test_a_layer_one_cell_thick_keeps_the_slope_of_its_cells():
    centers = np.stack(np.meshgrid(*[np.arange(n) + 0.5 for n in (6, 6, 1)], indexing="ij"), axis=-1).reshape(-1, 3)
    packing = make_packing(centers, np.full(36, 0.5), (6, 6, 1), False, {})
    scene = Scene(size=(6, 6, 1), matrix=ONE, walls={"z-": 0.0, "z+": 1.0})
    field = demheat.solve(scene, packing=packing, allow_few=True, tolerance=1e-13)
    points = inside() * [6, 6, 1]
    # Solver tolerance.
    assert_allclose(field.temperature_at(points), points[:, 2], atol=1e-9)


@pytest.mark.filterwarnings("ignore:.*do not fit into gaps")
def test_a_fit_bends_no_slope_beside_a_point_of_contact():
    """Few edges of a ball that touches a wall made its flux 5 times the largest that there is."""
    scene = Scene((1, 1, 1), ONE, [Sphere((0.5, 0.5, 0.2), 0.2, Material(10.0))], walls={"z-": 0.0, "z+": 1.0})
    offset = np.random.default_rng(0).normal(size=(500, 3))
    offset *= 0.199 * np.random.default_rng(1).random((500, 1)) ** (1 / 3) / np.linalg.norm(offset, axis=1)[:, None]
    points = offset + (0.5, 0.5, 0.2)
    flux = demheat.solve(scene, particles=2000, seed=0).flux_at(points)
    true = multipole.solve(scene, accuracy=1e-4).flux_at(points)
    # Found: .11 of the rms flux, 1.4 before.
    assert np.sqrt(np.sum((flux - true) ** 2) / np.sum(true**2)) < 0.25


def test_the_last_points_are_fitted_once_and_kept_apart(monkeypatch):
    scene = Scene(size=(1, 1, 1), matrix=ONE, inclusions=[BALL], walls=WALLS)
    field, points, fits = demheat.solve(scene, particles=500), inside(50), []
    fitted = module.Reconstruction._fitted
    monkeypatch.setattr(module.Reconstruction, "_fitted", lambda self, x: fits.append(len(x)) or fitted(self, x))
    flux = field.flux_at(points)
    flux[:] = 0.0
    field.temperature_at(points)
    assert fits == [50] and np.abs(field.flux_at(points)).min(axis=0)[1] > 0.0
    points += 1e-3 * (0.5 - points)
    field.temperature_at(points)
    assert fits == [50, 50]
    assert field.temperature_at(np.empty((0, 3))).shape == (0,) and fits == [50, 50]
