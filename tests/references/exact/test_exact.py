"""What scenes get which closed form, in their own units and places: by hand, as printed; all else is refused."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from demheat import Flux, Layer, Material, Scene, Sphere, gallery
from references import exact
from references.exact import lattice

A, B, C = Material(2.0), Material(6.0), Material(1.0)
BOX = (1.0, 2.0, 3.0)
OBLIQUE = (1.0, -2.0, 0.5)
# Layers: matrix 2 on [0, 0.5], 6 on [0.5, 1.0], 1 on [1.0, 1.6] and matrix again to 2.0, along y.
LAYERS = [Layer(1, 0.5, 1.0, B), Layer(1, 1.0, 1.6, C)]
HARMONIC = 2.0 / (0.9 / 2 + 0.5 / 6 + 0.6 / 1)
ARITHMETIC = (0.9 * 2 + 0.5 * 6 + 0.6 * 1) / 2.0


def random_points(scene, count=200, seed=0):
    return np.random.default_rng(seed).uniform(0, 1, size=(count, 3)) * scene.size


@pytest.mark.parametrize(
    ("low", "high", "flux"),
    [(25.0, 35.0, -10.0), (35.0, 25.0, 10.0), (25.0, Flux(7.0), -7.0), (Flux(7.0), 25.0, 7.0), (25.0, Flux(0.0), 0.0)],
)
def test_homogeneous_between_walls(low, high, flux):
    scene = Scene(BOX, A, walls={"y-": low, "y+": high})
    field = exact.solve(scene)
    assert_allclose(field.mean_flux, [0, flux, 0], rtol=1e-14, atol=1e-14)
    assert_allclose(field.wall_heat["y-"], flux * 3.0, rtol=1e-14)
    assert_allclose(field.wall_heat["y+"], -flux * 3.0, rtol=1e-14)
    start = 25.0 + flux if isinstance(low, Flux) else low  # L/k = 1
    assert_allclose(field.wall_temperature["y-"], start, rtol=1e-14)
    assert_allclose(field.wall_temperature["y+"], start - flux, rtol=1e-14)
    assert_allclose(field.temperature_at([[0.3, 0.5, 0.1]]), start - 0.25 * flux, rtol=1e-14)


def test_laminate_across_by_hand():
    scene = Scene(BOX, A, LAYERS, walls={"y-": 10.0, "y+": 30.0})
    field = exact.solve(scene)
    flux = -HARMONIC * 10.0
    assert_allclose(field.conductivity, HARMONIC, rtol=1e-14)
    assert_allclose(field.mean_flux, [0, flux, 0], rtol=1e-14)
    ends = np.array([[0.1, y, 0.2] for y in (0.0, 0.5, 1.0, 1.6, 2.0)])
    rises = -flux * np.cumsum([0.0, 0.5 / 2, 0.5 / 6, 0.6 / 1, 0.4 / 2])
    assert_allclose(field.temperature_at(ends), 10.0 + rises, rtol=1e-14)
    assert_allclose(field.flux_at(random_points(scene)), np.tile([0, flux, 0], (200, 1)), rtol=1e-14)
    assert_allclose(field.fractions, [0.45, 0.25, 0.3], rtol=1e-14)


def test_laminate_along_by_hand():
    scene = Scene(BOX, A, LAYERS, walls={"x-": 10.0, "x+": 30.0})
    field, points = exact.solve(scene), random_points(scene)
    assert_allclose(field.conductivity, ARITHMETIC, rtol=1e-14)
    assert_allclose(field.temperature_at(points), 10.0 + 20.0 * points[:, 0], rtol=1e-14)
    assert_allclose(field.flux_at(points)[:, 0], -20.0 * scene.conductivities[scene.phase_at(points)], rtol=1e-14)
    assert_allclose(sum(field.wall_heat.values()), 0, atol=1e-12)


def test_laminate_in_a_periodic_cell():
    scene = Scene(BOX, A, LAYERS, gradient=OBLIQUE)
    field, points = exact.solve(scene), random_points(scene)
    expected = -np.array(OBLIQUE) * [ARITHMETIC, HARMONIC, ARITHMETIC]
    assert_allclose(field.mean_flux, expected, rtol=1e-14)
    for shift in np.array([[1, 0, 0], [0, 2, 0], [-1, -4, 3]]):
        jump = field.temperature_at(points + shift) - field.temperature_at(points)
        assert_allclose(jump, shift @ np.array(OBLIQUE), atol=1e-13)
        assert_array_equal(field.flux_at(points + shift), field.flux_at(points))
    assert_allclose(field.temperature_at([[0, 0, 0], [1.0, 2.0, 3.0]]), [0, np.dot(OBLIQUE, BOX)], atol=1e-14)


def test_both_faces_of_a_layer_that_resists_count_in_a_periodic_cell():
    """Also where one of them is the face of the cell."""
    for start in (0.0, 0.3):
        layer = Layer(1, start, start + 0.5, B, resistance=0.7)
        field = exact.solve(Scene(BOX, A, [layer], gradient=(0.0, 1.0, 0.0)))
        assert_allclose(field.conductivity, 2.0 / (1.5 / 2 + 0.5 / 6 + 2 * 0.7), rtol=1e-14)


def test_a_sphere_s_resistance_is_in_units_of_the_matrix():
    sphere = Sphere((0.5, 0.5, 0.5), 0.3, Material(20.0), resistance=0.06)
    field = exact.solve(Scene((1.0, 1.0, 1.0), A, [sphere], gradient=(0.0, 1.0, 0.0)))
    known = lattice.conductivity("sc", 10.0, 4 / 3 * math.pi * 0.3**3, resistance=0.06 * 2.0 / 0.3)
    assert_allclose(field.conductivity, 2.0 * known, rtol=1e-12)


def test_flux_wall_across_layers_and_side_wall_mean():
    scene = Scene(BOX, A, LAYERS, walls={"y-": Flux(4.0), "y+": 0.0, "x-": Flux(0.0)})
    field = exact.solve(scene)
    assert_allclose(field.wall_temperature["y-"], 4.0 * 2.0 / HARMONIC, rtol=1e-14)
    y = (np.arange(100_000) + 0.5) / 50_000
    mean = field.temperature_at(np.stack([0 * y, y, 0 * y + 1.0], axis=1)).mean()
    # The midpoint rule is exact but for the cells that hold an interface: here none.
    assert_allclose(field.wall_temperature["x-"], mean, rtol=1e-10)
    assert field.wall_heat["x-"] == 0.0


def test_nested_layers_and_insulating_layers():
    nested = [Layer(0, 0.2, 0.8, B), Layer(0, 0.4, 0.5, C)]
    field = exact.solve(Scene((1.0, 1.0, 1.0), A, nested, gradient=(1, 0, 0)))
    assert_allclose(field.conductivity, 1 / (0.4 / 2 + 0.5 / 6 + 0.1 / 1), rtol=1e-14)
    assert_allclose(field.fractions, [0.4, 0.5, 0.1], rtol=1e-14)
    pore = [Layer(0, 0.2, 0.4, Material(0.0)), Layer(0, 0.5, 0.7, Material(0.0))]
    field = exact.solve(Scene((1.0, 1.0, 1.0), A, pore, gradient=(1, 2, 0)))
    assert_allclose(field.mean_flux, [0, -2 * 0.6 * 2, 0], atol=1e-14)
    # Bodies between the insulating layers have their mean place's temperature; one goes on through the face.
    points = [[0.1, 0, 0], [0.3, 0, 0], [0.45, 0, 0], [0.9, 0, 0]]
    assert_allclose(field.temperature_at(points), [-0.05, np.nan, 0.45, 0.95], atol=1e-14)


def test_no_steady_state_through_an_insulator():
    scene = Scene(BOX, Material(0.0), walls={"y-": 1.0, "y+": Flux(1.0)})
    with pytest.raises(ValueError, match="cannot pass a body of no conductivity"):
        exact.solve(scene)
    assert exact.solve(replace(scene, walls={"y-": 1.0, "y+": 2.0})).conductivity == 0.0
    with pytest.raises(ValueError, match="at least one wall with a temperature"):
        exact.solve(Scene(BOX, A, walls={"y-": Flux(1.0)}))


def test_haddad_cube_as_printed():
    field = exact.solve(gallery.sphere_in_cube())
    points = np.array([[0.5, 0.5, 0.5], [0.08, 0.5, 0.5], [0.5, 0.92, 0.5]]) * 0.1
    # Half a unit of the last digits printed.
    assert_allclose(-field.flux_at(points)[:, 1], [7767.43, 2309.24, 6433.60], atol=5e-3)
    assert_allclose(field.temperature_at(points), [30, 30, 33.511132], atol=5e-7)
    assert_allclose(-field.mean_flux, [0, 4264.0335, 0], atol=5e-5)
    assert_allclose(field.wall_heat["y+"], 42.640335, atol=5e-7)
    assert_allclose(field.fractions[1], 4 * math.pi / 81, rtol=1e-14)
    assert field.stats["digits"] >= 9


@pytest.mark.parametrize(
    ("make", "kind"),
    [(gallery.simple_cubic, "sc"), (gallery.body_centred, "bcc"), (gallery.face_centred, "fcc")],
)
def test_cubic_cells_anywhere_and_in_any_order(make, kind):
    scene = make(contrast=10.0, fraction=0.2)
    field = exact.solve(scene)
    assert_allclose(field.conductivity / 33.0, lattice.conductivity(kind, 10.0, 0.2), rtol=1e-14)
    shift = np.array([0.03, -0.21, 0.055])
    moved = [replace(s, center=tuple(np.array(s.center) + shift)) for s in scene.inclusions[::-1]]
    other = exact.solve(replace(scene, inclusions=moved))
    points = random_points(scene, 50)
    # Rounding of coordinates, near interfaces a flux of 1e4 W/m2 turns over within 1e-2 m.
    assert_allclose(other.flux_at(points + shift), field.flux_at(points), atol=1e-6)
    rise = other.temperature_at(points + shift) - field.temperature_at(points)
    assert_allclose(rise, rise[0], atol=1e-10)
    assert field.stats["form"] == f"{kind} array"


def test_pores_and_insulating_matrix():
    pore = exact.solve(gallery.sphere_in_cube(0.0, fraction=0.2))
    assert_allclose(pore.conductivity / 33.0, lattice.conductivity("sc", 0.0, 0.2), rtol=1e-14)
    assert_array_equal(pore.flux_at([[0.05, 0.05, 0.05]]), 0)
    scene = gallery.sphere_in_cube(fraction=0.2)
    scene = replace(scene, matrix=Material(0.0))
    dead = exact.solve(scene)
    assert dead.conductivity == 0.0
    points = random_points(scene, 50)
    # No wall reaches the sphere.
    assert np.all(np.isnan(dead.temperature_at(points)))
    assert_array_equal(dead.flux_at(points), 0)


@pytest.mark.parametrize("scene", [gallery.coated_sphere(), gallery.coated_sphere(core=0.0, shell=2.0, periodic=True)])
def test_coated_sphere_meets_the_interface_conditions(scene):
    field = exact.solve(scene)
    outer, inner = scene.inclusions
    normals = np.random.default_rng(1).normal(size=(40, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    for radius in (outer.radius, inner.radius):
        sides = [np.array(outer.center) + normals * radius * (1 + s * 1e-12) for s in (-1, 1)]
        warm = [field.temperature_at(points) for points in sides]
        # Rounding and the step of 1e-12 across; fluxes are of order 1e3 W/m2.
        if radius == outer.radius or inner.material.conductivity > 0:  # a pore has no temperature
            assert_allclose(warm[0], warm[1], atol=1e-9)
        through = [np.sum(field.flux_at(points) * normals, axis=1) for points in sides]
        assert_allclose(through[0], through[1], atol=1e-7)
    # In the coat the flux is minus k times the slope of the temperature, by central differences.
    h, points = 1e-6, np.array(outer.center) + normals * (outer.radius + inner.radius) / 2
    slope = [(field.temperature_at(points + h * e) - field.temperature_at(points - h * e)) / (2 * h) for e in np.eye(3)]
    assert_allclose(field.flux_at(points), -outer.material.conductivity * np.stack(slope, axis=1), atol=1e-3)


def test_coated_sphere_leaves_the_outside_linear():
    scene = gallery.coated_sphere(center=(0.4, 0.5, 0.6))
    field = exact.solve(scene)
    points = random_points(scene)
    outside = points[scene.phase_at(points) == 0]
    assert_allclose(field.temperature_at(outside), 25.0 + 100.0 * outside[:, 1], rtol=1e-14)
    assert_allclose(field.conductivity, scene.matrix.conductivity, rtol=1e-14)
    f = 4 / 3 * math.pi * 0.027
    assert_allclose(field.fractions, [1 - f, 0.6 * f, 0.4 * f], rtol=1e-12)
    # The mean over samples converges to the stated mean flux: midpoints of 24^3 cells miss interfaces by O(1/24)^1.5.
    assert_allclose(field.samples.flux.mean(axis=0), field.mean_flux, atol=5e-3 * abs(field.mean_flux[1]))


def test_many_coated_spheres_in_any_box_under_any_load():
    small, large = gallery.coated_sphere(radius=0.1), gallery.coated_sphere(radius=0.2)
    box, spheres = (0.2, 0.1, 0.1), []
    for source, shift in ((small, (0.1, 0.03, 0.0)), (large, (-0.02, 0.0, 0.01))):
        spheres += [replace(s, center=tuple(np.array(s.center) + shift)) for s in source.inclusions]
    spheres = [spheres[0], spheres[2], spheres[1], spheres[3]]
    k = small.matrix.conductivity
    heated = exact.solve(Scene(box, small.matrix, spheres, walls={"x-": 25.0, "x+": Flux(1000.0)}))
    assert_allclose(heated.wall_temperature["x+"], 25.0 + 1000.0 * 0.2 / k, rtol=1e-14)
    cell = exact.solve(Scene(box, small.matrix, spheres, gradient=OBLIQUE))
    assert_allclose(cell.mean_flux, -k * np.array(OBLIQUE), rtol=1e-14)
    assert_allclose(cell.fractions.sum(), 1.0, rtol=1e-14)


CUBE = gallery.sphere_in_cube()
BALL = CUBE.inclusions[0]
COATED = gallery.coated_sphere()
PAIR = gallery.body_centred()
BEAD = replace(COATED.inclusions[1], radius=0.001, center=(0.01, 0.01, 0.01))


def _in_core(scene):
    """A poor sphere in the core, with which that would leave the matrix unmoved if it were a coat itself."""
    core, own = scene.inclusions[1], scene.matrix.conductivity / 10
    k = core.material.conductivity
    ratio = scene.matrix.conductivity / k
    part = (ratio - 1) * (own + 2 * k) / ((own - k) * (2 + ratio))
    return replace(core, material=Material(own), radius=core.radius * part ** (1 / 3))


@pytest.mark.parametrize(
    "scene",
    [
        gallery.random_dispersion(2, fraction=0.1),
        replace(CUBE, size=(0.1, 0.1, 0.11)),
        replace(CUBE, inclusions=[replace(BALL, center=(0.05, 0.051, 0.05))]),
        replace(CUBE, walls={"y-": 25.0, "y+": Flux(100.0)}),
        replace(PAIR, inclusions=[PAIR.inclusions[0], replace(PAIR.inclusions[1], material=B)]),
        replace(PAIR, inclusions=[PAIR.inclusions[0], replace(PAIR.inclusions[1], center=(0.075, 0.075, 0.076))]),
        replace(PAIR, gradient=None, walls={"y-": 25.0, "y+": 35.0}),
        replace(gallery.laminate(direction="along"), walls={"y-": 25.0, "y+": Flux(100.0)}),
        replace(COATED, matrix=Material(COATED.matrix.conductivity * (1 + 1e-9))),
        replace(COATED, inclusions=[COATED.inclusions[0], replace(COATED.inclusions[1], center=(0.05, 0.05, 0.051))]),
        replace(COATED, inclusions=[replace(s, center=(0.02, 0.05, 0.05)) for s in COATED.inclusions]),
        replace(COATED, inclusions=[*COATED.inclusions, _in_core(COATED), BEAD]),
    ],
)
def test_refuses_what_has_no_closed_form(scene):
    with pytest.raises(NotImplementedError, match="no closed form") as error:
        exact.solve(scene)
    assert len(str(error.value)) < 180  # to be read at a glance


def test_refuses_spheres_too_close_for_the_series(monkeypatch):
    monkeypatch.setattr(lattice, "HIGHEST_ORDER", 59)
    with pytest.raises(NotImplementedError, match="no closed form to six digits: .* nearly touching"):
        exact.solve(gallery.sphere_in_cube(1e6, fraction=0.5235))
