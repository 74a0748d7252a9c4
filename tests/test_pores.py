"""Pores, phases of conductivity 0: one convention for all methods, stated in `demheat.field`."""

import numpy as np
import pytest
from method_scenes import ALIKE, METHODS, Estimated, allowed, answered, asked
from numpy.testing import assert_allclose, assert_array_equal

from demheat import Flux, Layer, Material, Scene, Sphere
from references import fft

PORE, METAL = Material(0.0), Material(2.0)
# No interface of the layers lies on a face of voxels, one layer cuts voxels only.
LAYER, THIN = Layer(1, 0.31, 0.55, PORE), Layer(1, 0.81, 0.93, PORE)
BALL = Sphere((0.07, 0.45, 0.98), 0.33, PORE)
X, Y, OBLIQUE = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (1.0, 2.0, 0.0)
WALLS = {"y-": 20.0, "y+": 50.0}
STEADY = [name for name, method in METHODS.items() if method.call != "evolve" and name not in ALIKE]
every = pytest.mark.parametrize("name", STEADY)


def cell(*inclusions, matrix=METAL, **load):
    return Scene((1.0, 1.0, 1.0), matrix, inclusions, **(load or {"gradient": Y}))


def swapped(shape):
    """The same shape of metal, for a matrix of pores."""
    kind = {"axis": shape.axis, "start": shape.start, "stop": shape.stop} if isinstance(shape, Layer) else {}
    return Layer(**kind, material=METAL) if kind else Sphere(shape.center, shape.radius, METAL)


BLOCKED = {
    "two layers across": cell(LAYER, THIN),
    "layers between walls": cell(LAYER, THIN, walls=WALLS),
    "a layer in a matrix of pores": cell(swapped(LAYER), matrix=PORE),
    "spheres in a matrix of pores": cell(swapped(BALL), matrix=PORE, gradient=OBLIQUE),
    "a sphere in a matrix of pores between walls": cell(Sphere((0.5, 0.5, 0.5), 0.33, METAL), matrix=PORE, walls=WALLS),
    "nothing but pores": cell(matrix=PORE),
}


def answer(name, scene, pores=False):
    """The method's field; skips if it refuses what else the scene asks for, and pores if these may be refused."""
    method = METHODS[name]
    try:
        return answered(method, scene)
    except NotImplementedError as error:
        reasons = [
            method.refuses[what] for what in asked(scene) & set(method.refuses) - set() if pores or what != "pores"
        ]
        assert any(words in str(error) for words in reasons), error
        pytest.skip(f"{name} refuses: {error}")


def solids(scene, count=300, seed=0):
    """Points in metal, and points in pores, none within a tenth of an interface's thickness of rounding."""
    points = np.random.default_rng(seed).random((count, 3)) * scene.size
    pore = scene.conductivities[scene.phase_at(points)] == 0
    return points[~pore], points[pore]


@every
@pytest.mark.parametrize("case", BLOCKED)
def test_what_pores_block_carries_exactly_nothing(name, case):
    scene = BLOCKED[case]
    field = answer(name, scene)
    assert field.conductivity == 0.0
    if isinstance(field, Estimated):
        return
    assert_array_equal(field.mean_flux, 0)
    assert_array_equal(list(field.wall_heat.values()), 0)
    assert field.stats["iterations"] == 0
    own, (metal, pores) = field.samples, solids(scene)
    assert_array_equal(own.flux, 0)
    assert_array_equal(field.flux_at(metal), 0)
    assert_array_equal(field.flux_at(pores), 0)
    assert np.all(np.isnan(field.temperature_at(pores)))
    assert np.all(np.isnan(own.temperature[scene.conductivities[own.phase] == 0]))
    assert_allclose(field.fractions.sum(), 1.0, rtol=1e-12)  # a sum of rounded numbers
    if scene.periodic:
        # Bodies have one temperature each; it goes on with the mean gradient in the next cell.
        assert np.all(np.isfinite(field.temperature_at(metal)))
        shift = np.array((1.0, -2.0, 0.0))
        change = field.temperature_at(metal + shift) - field.temperature_at(metal)
        assert_allclose(change, shift @ scene.gradient, rtol=1e-9)  # rounding


@every
def test_bodies_take_the_temperature_of_their_wall(name):
    field = answer(name, BLOCKED["layers between walls"])
    found = field.temperature_at([[0.4, y, 0.6] for y in (0.05, 0.15, 0.43, 0.7, 0.87, 0.98)])
    if "laminate" in METHODS[name].exceptions and "voxels" not in field.stats:
        found = np.delete(found, [2, 3, 4])  # their particles are as large as the thin layer
        assert_array_equal(found, [20.0, 20.0, 50.0])
        return
    # Rounding of the sum with the linear part.
    assert_allclose(found, [20.0, 20.0, np.nan, np.nan, np.nan, 50.0], rtol=1e-12)


@every
def test_a_sphere_apart_has_the_mean_temperature_of_its_place(name):
    scene = BLOCKED["spheres in a matrix of pores"]
    field = answer(name, scene)
    if isinstance(field, Estimated):
        return
    metal, _ = solids(scene)
    away = metal - BALL.center
    centers = metal - (away - np.round(away))
    # The sphere as the method has it: particles, voxels and chords have their own middle.
    assert_allclose(field.temperature_at(metal), centers @ scene.gradient, atol=0.02)


@every
@pytest.mark.parametrize("matrix", ["metal", "pores"])
def test_heat_along_a_layer(name, matrix):
    layer = cell(LAYER, gradient=X) if matrix == "metal" else cell(swapped(LAYER), matrix=PORE, gradient=X)
    field = answer(name, layer, pores=True)
    metal = field.fractions @ (layer.conductivities > 0)
    # Contacts conduct in their own way near a layer.
    rounding = "laminate" not in METHODS[name].exceptions or "voxels" in field.stats
    assert_allclose(field.conductivity, 2.0 * metal, rtol=1e-9 if rounding else 0.3)
    points, pores = solids(layer)
    assert_array_equal(field.flux_at(pores), 0)
    assert np.all(np.isnan(field.temperature_at(pores)))
    assert np.all(np.isfinite(field.temperature_at(points))) and np.all(np.isfinite(field.flux_at(points)))
    own = field.samples
    assert_array_equal(np.isnan(own.temperature), layer.conductivities[own.phase] == 0)
    if rounding:
        whole = points[np.min(np.abs(points[:, 1:2] - [LAYER.start, LAYER.stop]), axis=1) > 0.1]
        rest = field.temperature_at(whole) - whole[:, 0]
        assert_allclose(rest, 0, atol=1e-6)  # the solvers' tolerance


@every
def test_an_insulating_sphere(name):
    if "pores" in METHODS[name].exceptions:
        pytest.skip(METHODS[name].exceptions["pores"])
    scene = cell(BALL, gradient=X)
    field, right = answer(name, scene, pores=True), answered(METHODS["exact"], scene)
    assert_allclose(field.conductivity, right.conductivity, rtol=2 * allowed(name, least=1e-9))
    if isinstance(field, Estimated):
        return
    metal, pores = solids(scene)
    assert_array_equal(field.flux_at(pores), 0)
    assert np.all(np.isnan(field.temperature_at(pores)))
    error = field.temperature_at(metal) - right.temperature_at(metal)
    assert np.std(error) < 2 * allowed(name, "temperature", least=1e-6)
    own = field.samples
    assert_array_equal(np.isnan(own.temperature), scene.conductivities[own.phase] == 0)
    assert np.all(np.isfinite(own.flux))


@every
@pytest.mark.parametrize("load", [{"gradient": X}, {"walls": {"x-": 20.0, "x+": 50.0}}])
def test_an_island_beside_what_conducts(name, load):
    """A layer and a ball of metal in pores: the layer carries heat, the ball none."""
    scene = cell(swapped(LAYER), Sphere((0.5, 0.78, 0.5), 0.14, METAL), matrix=PORE, **load)
    if name == "exact":
        pytest.skip("it has no closed form")
    field = answer(name, scene, pores=True)
    ball = np.array([0.5, 0.78, 0.5]) + np.array([(0.0, 0.0, 0.0), (0.03, 0.0, 0.0), (0.0, 0.0, -0.03)])
    assert_array_equal(field.flux_at(ball), 0)
    found = field.temperature_at(ball)
    if scene.periodic:
        assert_allclose(found, 0.5, atol=0.03)  # its own middle, of particles, voxels or elements
        assert np.ptp(found) < 1e-9
    else:
        assert np.all(np.isnan(found))
        # Within two voxels of the layer's ends both count.
        inside = field.temperature_at([[0.25, 0.43, 0.5], [0.75, 0.43, 0.5]])
        assert np.all(np.isfinite(inside)) and inside[0] < 35 < inside[1]
    assert field.conductivity > 0.2


def test_poor_conductors_are_no_pores():
    """What conducts little is solved, beside a pore as well."""
    layer, ball = Layer(1, 0.31, 0.55, Material(1e-5)), Sphere((0.5, 0.8, 0.5), 0.1, PORE)
    found = fft.solve(cell(layer, ball), voxels=10, rule="plain", threads=1)
    # Two planes of voxels of ten have the layer's conductivity.
    assert_allclose(found.conductivity, 1e-5 / found.fractions[1], rtol=1e-3)


@pytest.mark.parametrize("name", ["dem", "fem", "exact"])
def test_a_wall_that_no_temperature_reaches_has_none(name):
    field = answered(METHODS[name], cell(LAYER, walls={"y-": 20.0, "y+": Flux(0.0)}))
    assert field.wall_temperature["y-"] == 20.0 and np.isnan(field.wall_temperature["y+"])
    assert field.wall_heat == {"y-": 0.0, "y+": 0.0}
