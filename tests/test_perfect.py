"""Perfect conductors: one convention for all who take them, stated in `demheat.field`; all others refuse."""

import math
import warnings
from dataclasses import replace

import numpy as np
import pytest
from method_scenes import METHODS, answered
from numpy.testing import assert_allclose
from perfect_bodies import MATRIX, MIDDLE, body

from demheat import Cylinder, Image, Laguerre, Layer, Material, Scene, Sphere, damage, evolve, gallery, orthotropic
from demheat.dem.networks import network_of
from demheat.gate import hashin_shtrikman, wiener
from demheat.io import scenes
from demheat.packing.relax import relax
from demheat.scene.edges import edge_order
from demheat.scene.negligible import negligible
from demheat.scene.perfect import INFINITE, touching_spheres
from demheat.scene.shapes import Box
from demheat.terminal.commands.bounds import bounds_of
from references import bracket, exact, multipole, walkers
from references.exact import lattice

PERFECT, LARGE = math.inf, 1e15
X, Y, CELL = {"walls": {"x-": 0.0, "x+": 1.0}}, {"walls": {"y-": 0.0, "y+": 1.0}}, {"gradient": (1.0, 0.0, 0.0)}
POINTS = np.random.default_rng(0).random((300, 3))
# Of a gradient of 1 in a matrix of 2: s differs from its limit by 1e-15, and its sums round some hundred times as much.
SAME = {"rtol": 0, "atol": 1e-12}


@pytest.fixture(autouse=True)
def without_a_warning():
    """Infinity less infinity, and what else is no number, would be heard."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        yield


def spheres(*centers, radius=0.25, k=PERFECT, resistance=0.0, **load):
    return body(*(Sphere(each, radius, Material(k), resistance=resistance) for each in centers), **load)


def alike(method, scene_of):
    """The limit beside a contrast of 5e14: conductivity, temperature, and the flux, in the conductors, too."""
    perfect, large = (method(scene_of(k)) for k in (PERFECT, LARGE))
    assert_allclose(perfect.conductivity, large.conductivity, rtol=1e-12)
    assert_allclose(perfect.temperature_at(POINTS), large.temperature_at(POINTS), **SAME)
    assert_allclose(perfect.flux_at(POINTS), large.flux_at(POINTS), **SAME)
    assert perfect.error.lower <= perfect.conductivity <= perfect.error.upper
    return perfect


# What scenes take.


@pytest.mark.parametrize("value", [math.inf, np.inf, np.float32("inf")])
def test_a_material(value):
    material = Material(value)
    assert material.perfect
    assert material.isotropic
    assert not Material(1e50).perfect
    assert material.tensor.diagonal().tolist() == [math.inf] * 3


@pytest.mark.parametrize(
    ("make", "name"),
    [
        (lambda: Material(-math.inf), "Material.conductivity"),
        (lambda: Material("inf"), "Material.conductivity"),
        (lambda: Material(np.diag([math.inf] * 3)), "Material.conductivity"),
        (lambda: Material(orthotropic(1.0, math.inf, 1.0)), "k2"),
        (lambda: Material(math.inf, dependence=[(0.0, 1.0), (1.0, 2.0)]), "Material.dependence"),
        (lambda: body(matrix=math.inf, **X), "Material.conductivity = inf in all phases"),
        (lambda: spheres(MIDDLE, matrix=math.inf, **X), "Material.conductivity = inf in all phases"),
        (lambda: Image(np.indices((2, 2, 2))[0], 1.0, {0: Material(math.inf), 1: Material(1.0)}), "Image.materials"),
    ],
)
def test_what_is_no_perfect_conductor(make, name):
    with pytest.raises(ValueError, match=name) as error:
        make()
    assert "must" in str(error.value)
    assert "\n" not in str(error.value)


def test_a_file(tmp_path):
    scene = spheres(MIDDLE, **X)
    scenes.write(scene, tmp_path / "scene.toml")
    assert "conductivity = inf" in (tmp_path / "scene.toml").read_text(encoding="utf-8")
    assert scenes.read(tmp_path / "scene.toml") == scene
    assert "inf W/(m K)" in scene._repr_html_()


TAKES = ("dem", "exact", "fft", "fft-links", "fft-plain", "fem", "fem-p1", "fem-straight", "multipole")


@pytest.mark.parametrize("name", [name for name in METHODS if name not in TAKES])
def test_all_other_methods_refuse(name):
    with pytest.raises(NotImplementedError, match=r"^Material.conductivity in phase 1 is infinite: [^\n]*$"):
        answered(METHODS[name], spheres(MIDDLE, **X))


def heavy(scene):
    matrix, ball = (Material(k, density=1.0, heat_capacity=1.0) for k in (MATRIX, PERFECT))
    return replace(scene, initial=0.0, matrix=matrix, inclusions=[Sphere(MIDDLE, 0.25, ball)])


def beside(scene):
    """What is no method of the suite, nor in the table of the manual (`test_scenes_page`)."""
    return {
        "voxels": lambda: bracket.voxels.solve(scene, voxels=8),
        "walkers": lambda: walkers.solve(scene),
        "negligible": lambda: negligible(scene, 1e-3),
        "zeta2": lambda: multipole.zeta2(spheres(MIDDLE, **CELL)),
        "network_of": lambda: network_of(scene, relax(200, seed=0), Laguerre()),
        "evolve": lambda: list(evolve(heavy(scene), [0.1], particles=200)),
        "damage": lambda: damage.solve(scene, particles=200),
    }


@pytest.mark.parametrize("name", beside(None))
def test_all_else_refuses(name):
    with pytest.raises(NotImplementedError, match=r"^Material.conductivity in phase 1 is infinite: [^\n]*$"):
        beside(spheres(MIDDLE, **X))[name]()


def test_tensors_beside_are_refused():
    layers = Layer(0, 0.1, 0.3, Material(math.inf)), Layer(0, 0.5, 0.7, Material(orthotropic(1.0, 2.0, 3.0)))
    with pytest.raises(NotImplementedError, match="phase 1 is infinite"):
        exact.solve(body(*layers, **X))


# Exact forms.


# By lattice sums, independently of this code for the first.
@pytest.mark.parametrize(("resistance", "expected"), [(0.2, 1.898010589), (0.0, 3.262566264)])
@pytest.mark.parametrize("load", [X, CELL], ids=["walls", "cell"])
def test_a_cubic_array(load, resistance, expected):
    radius = lattice.radius("sc", 0.4)

    def scene_of(k):
        return spheres(MIDDLE, radius=radius, k=k, resistance=resistance * radius / MATRIX, **load)

    perfect = alike(exact.solve, scene_of)
    # Half a unit of the last digit.
    assert_allclose(perfect.conductivity / MATRIX, expected, rtol=0, atol=0.5e-9)
    # Multipoles keep fewer degrees: what the field lacks for it is the same for both, and 1e-5 asked for of k.
    assert_allclose(alike(multipole.solve, scene_of).conductivity / MATRIX, expected, rtol=1e-5)


@pytest.mark.parametrize("load", [X, CELL], ids=["walls", "cell"])
def test_spheres_without_symmetry(load):
    """Some resist, some do not: none of them is a source of heat."""

    def scene_of(k):
        places = ((0.3, 0.4, 0.5), 0.2, 0.0), ((0.7, 0.6, 0.3), 0.15, 0.05), ((0.65, 0.3, 0.75), 0.1, 0.0)
        return body(*(Sphere(at, radius, Material(k), resistance=film) for at, radius, film in places), **load)

    alike(multipole.solve, scene_of)


def test_one_temperature_and_a_flux_that_goes_on():
    field = multipole.solve(spheres((0.3, 0.4, 0.5), radius=0.2, **X), order=20)
    turns = POINTS - 0.5
    inside = (0.3, 0.4, 0.5) + 0.199 * turns / np.linalg.norm(turns, axis=1)[:, None]
    assert np.ptp(field.temperature_at(inside)) == 0
    # Through the surface and out again: as much on both sides of it, to what 20 degrees leave.
    normal = turns / np.linalg.norm(turns, axis=1)[:, None]
    near, far = (field.flux_at((0.3, 0.4, 0.5) + radius * normal) for radius in (0.2 - 1e-9, 0.2 + 1e-9))
    assert_allclose(np.sum(near * normal, axis=1), np.sum(far * normal, axis=1), rtol=0, atol=1e-4)


def test_layers():
    layer = Layer(0, 0.3, 0.7, Material(math.inf))
    field = exact.solve(body(layer, **X))
    assert_allclose(field.conductivity, MATRIX / 0.6, rtol=1e-14)
    assert_allclose(field.temperature_at([[0.35, 0.5, 0.5], [0.65, 0.5, 0.5]]), 0.5, rtol=1e-14)
    assert_allclose(field.flux_at(POINTS), np.tile(field.mean_flux, (len(POINTS), 1)), rtol=1e-14)
    film = Layer(0, 0.3, 0.7, Material(math.inf), resistance=0.1)
    assert_allclose(exact.solve(body(film, **CELL)).conductivity, 1 / (0.6 / MATRIX + 0.2), rtol=1e-14)
    # A matrix of it, and no heat along it.
    assert_allclose(exact.solve(body(Layer(0, 0.3, 0.7, Material(4.0)), matrix=math.inf, **X)).conductivity, 10.0)


def test_a_coated_sphere():
    def scene_of(k):
        large = gallery.coated_sphere(core=LARGE, shell=1.0, edge=1.0, temperatures=(0.0, 1.0))
        outer, inner = large.inclusions
        # 1 + 2 f over 1 - f, f = .4: the same matrix to rounding.
        core = Sphere(inner.center, inner.radius, Material(k))
        return Scene(large.size, Material(3.0), [outer, core], walls=large.walls)

    assert_allclose(alike(exact.solve, scene_of).conductivity, 3.0, rtol=1e-14)


def test_fibres():
    alike(exact.solve, lambda k: body(Cylinder(MIDDLE, 0.3, (0, 0, 1), Material(k)), **X))


# What is infinite is said.


@pytest.mark.parametrize(
    "scene",
    [
        body(Layer(0, 0.3, 0.7, Material(math.inf)), **Y),
        body(Layer(0, 0.3, 0.7, Material(math.inf)), gradient=(1.0, 1.0, 0.0)),
        body(Layer(0, 0.0, 1.0, Material(math.inf)), **X),
        body(Cylinder(MIDDLE, 0.3, (0, 0, 1), Material(math.inf)), gradient=(0.0, 0.0, 1.0)),
        spheres(MIDDLE, radius=0.5, **X),
        spheres(MIDDLE, radius=0.5, **CELL),
        body(Sphere(MIDDLE, 0.3, Material(1.0)), matrix=math.inf, **X),
    ],
    ids=["along", "oblique", "all of it", "fibre", "walls", "cell", "matrix"],
)
def test_exact_forms_say_infinite(scene):
    with pytest.raises(ValueError, match=INFINITE):
        exact.solve(scene)


@pytest.mark.parametrize("load", [X, CELL], ids=["walls", "cell"])
def test_a_chain_that_spans_is_infinite(load):
    chain = (0.25, 0.5, 0.5), (0.75, 0.5, 0.5)
    for method in (touching_spheres, multipole.solve):
        with pytest.raises(ValueError, match=INFINITE):
            method(spheres(*chain, **load))
    # One that resists parts it: the series ends.
    assert touching_spheres(spheres(*chain, resistance=0.1, **load)) is None


def test_a_chain_through_faces_of_a_cell():
    """Far from where it starts a chain comes back to itself: not along the load, along it, and broken."""
    chain = [(x % 1, 0.9, 0.1) for x in (0.9, 1.1, 1.3, 1.5, 1.7)]
    # Centres may lie in any of the cells.
    for shifts in ((0, 0, 0, 0, 0), (0, 1, -1, 2, 0)):
        moved = [(x + shift, y - shift, z) for (x, y, z), shift in zip(chain, shifts, strict=True)]
        with pytest.raises(ValueError, match=INFINITE):
            touching_spheres(spheres(*moved, radius=0.1, **CELL))
        assert touching_spheres(spheres(*moved, radius=0.1, gradient=(0.0, 1.0, 0.0))) is not None
    assert touching_spheres(spheres(*chain[:4], radius=0.1, **CELL)) == (0, 1)
    assert touching_spheres(spheres(*chain[::2], radius=0.099, **CELL)) is None


def test_a_body_that_is_held():
    held = spheres((0.0, 0.5, 0.5), (0.6, 0.5, 0.5), **X)
    assert touching_spheres(held) is None
    field = multipole.solve(held, order=16)
    assert_allclose(field.temperature_at([[0.1, 0.5, 0.5], [0.2, 0.6, 0.5]]), 0.0, rtol=0, atol=1e-12)
    assert touching_spheres(spheres((0.25, 0.5, 0.5), **X)) == (0, 0)
    # An insulated wall is a mirror, and nothing flows between the two.
    assert touching_spheres(spheres((0.25, 0.5, 0.5), **Y)) is None


def test_touching_is_refused_by_a_series():
    with pytest.raises(NotImplementedError, match="perfect conductors touch") as error:
        multipole.solve(spheres((0.25, 0.5, 0.5), (0.75, 0.5, 0.5), **Y))
    assert "\n" not in str(error.value)


# Bounds.


def test_bounds_below_hold_and_there_are_none_above():
    scene = spheres(MIDDLE, radius=0.3, **X)
    fractions = np.array([1 - 4 / 3 * math.pi * 0.3**3, 4 / 3 * math.pi * 0.3**3])
    narrow, wide = hashin_shtrikman(scene, fractions), wiener(scene, fractions)
    # Maxwell's sum with beta = 1.
    assert_allclose(narrow.lower, MATRIX * (1 + 2 * fractions[1]) / (1 - fractions[1]), rtol=1e-14)
    assert_allclose(wide.lower, MATRIX / fractions[0], rtol=1e-14)
    assert narrow.upper == wide.upper == math.inf
    assert [(each.lower, each.upper) for each in bounds_of(scene)] == [
        (pytest.approx(wide.lower), math.inf),
        (pytest.approx(narrow.lower), math.inf),
    ]
    # What elements may not see widens below alone.
    moved = np.array([0.0, 0.01])
    assert wiener(scene, fractions, moved).upper == math.inf
    assert 0 < wiener(scene, fractions, moved).lower < wide.lower
    # None of it seen: the bounds of the matrix alone.
    assert wiener(scene, np.array([1.0, 0.0])).upper == MATRIX


def test_the_gate_still_refuses_what_is_below():
    scene = spheres(MIDDLE, radius=0.3, **X)
    field = exact.solve(scene)
    with pytest.raises(RuntimeError, match="no answer"):
        type(field)(
            **{name: getattr(field, name) for name in TAKEN}, stats=FINE, mean_flux=np.array([-MATRIX, 0.0, 0.0])
        )


TAKEN = ("scene", "fractions", "sampler", "temperature_at", "flux_at", "wall_temperature", "wall_heat")
FINE = {"unknowns": 10**9}


def test_edges_are_those_of_a_large_contrast():
    of = [edge_order(body(Box(MIDDLE, (0.5,) * 3, Material(k)), **X)) for k in (PERFECT, MATRIX * 1e12)]
    assert of[0] == of[1] < 2
