"""Interfaces with a resistance: every method knows what they do, or refuses them in one line."""

import math
from dataclasses import replace
from functools import cache, partial

import numpy as np
import pytest
from method_scenes import METHODS, allowed, answered
from numpy.testing import assert_allclose

import demheat
from demheat import Layer, Material, Scene, Sphere, dem, gallery
from demheat.dem.networks import network_of
from demheat.laws import Calibrated
from references import bracket, exact, fem, fft, multipole, series, zeta
from references.exact import lattice
from references.fem.lookup import NodalField
from references.fem.system import solve_nodes
from references.mesh import make, split

# Simple cubic array, contrast 10, fraction .2: conductivity over the matrix's, by R times that over the radius.
WITNESS = {0.05: 1.452510305, 0.2: 1.287801631, 0.5: 1.113182202, 2.0: 0.878144093}
CONTRAST, MATRIX, FRACTION = 10.0, 2.0, 0.2
RADIUS = lattice.radius("sc", FRACTION)
KNOWN = ("dem", "fem", "fem-straight", "fem-p1", "exact", "multipole", "fft")
WALLS = {"y-": 20.0, "y+": 50.0}
# Of equal spheres: at this one nothing outside is changed by them, wherever they are.
NEUTRAL = (CONTRAST - 1) / CONTRAST


def array(r, *, center=(0.5, 0.5, 0.5), contrast=CONTRAST, **load):
    """A sphere whose surface has the resistance r, in units of its radius over the matrix's conductivity."""
    own = Sphere(center, RADIUS, Material(contrast * MATRIX), resistance=r * RADIUS / MATRIX)
    return Scene((1.0, 1.0, 1.0), Material(MATRIX), [own], **(load or {"walls": WALLS}))


def crowd(gradient=(1.0, 2.0, -0.5)):
    """Equal spheres anywhere, some of them across faces of the cell, none of which changes anything outside."""
    cell = gallery.random_dispersion(4, fraction=0.2, gap=0.15, edge=1.0, seed=4)
    spheres = [
        Sphere(each.center, each.radius, Material(CONTRAST * MATRIX), resistance=NEUTRAL * each.radius / MATRIX)
        for each in cell.inclusions
    ]
    return Scene(cell.size, Material(MATRIX), spheres, gradient=gradient)


@cache
def small(name, make, *arguments, **load):
    return answered(METHODS[name], make(*arguments, **{key: dict(value) for key, value in load.items()}))


# ---------------------------------------------------------------- which methods


@pytest.mark.parametrize("name", METHODS)
def test_the_array_is_known_or_refused(name):
    scene = sheets(walls=WALLS) if "spheres" in METHODS[name].refuses else array(0.5)
    if name not in KNOWN:
        with pytest.raises(NotImplementedError, match=r"Scene.inclusions\[0\].resistance = ") as error:
            answered(METHODS[name], scene)
        assert "\n" not in str(error.value)
        return
    # Declared of scenes of the suite.
    assert_allclose(small(name, array, 0.5).conductivity / MATRIX, WITNESS[0.5], rtol=allowed(name, least=1e-9))


REFUSING = {
    "facets anywhere": lambda scene: demheat.solve(scene, particles=1000, conforming=False),
    "arithmetic mean": lambda scene: demheat.solve(scene, particles=1000, interface="arithmetic"),
    "contacts": lambda scene: demheat.solve(scene, particles=1000, law="calibrated", wall="surface"),
    "platonic axes": lambda scene: dem.solve_axes(scene, particles=1000, law="platonic"),
    "network": lambda scene: network_of(scene, None, Calibrated()),
    "plain voxels": lambda scene: fft.solve(scene, voxels=8, rule="plain"),
    "links": lambda scene: fft.solve(scene, voxels=8, rule="links"),
    "eyre-milton": lambda scene: fft.solve(scene, voxels=8, scheme="eyre-milton"),
    "links, axes": lambda scene: fft.solve_axes(scene, voxels=8, rule="links"),
    "bracket, tensor": lambda _: bracket.solve_tensor(array(0.5, gradient=(1.0, 0.0, 0.0))),
    "zeta by voxels": lambda _: zeta.zeta2(array(0.5, gradient=(1.0, 0.0, 0.0)), voxels=8),
    "zeta by multipoles": lambda _: multipole.zeta2(array(0.5, gradient=(1.0, 0.0, 0.0))),
}


@pytest.mark.parametrize("what", REFUSING)
def test_what_cannot_says_so(what):
    with pytest.raises(NotImplementedError, match=r"Scene.inclusions\[0\].resistance = ") as error:
        REFUSING[what](array(0.5))
    assert "\n" not in str(error.value)
    # Laws of the DEM say which one can.
    laws = ("facets anywhere", "arithmetic mean", "contacts", "platonic axes", "network")
    assert ("only law 'laguerre' with conforming=True" in str(error.value)) == (what in laws)
    # Those on voxels why they cannot: it is not the load's fault.
    voxels = ("plain voxels", "links", "eyre-milton", "links, axes")
    assert ("use scheme 'cg' and rule 'laminate'" in str(error.value)) == (what in voxels)


@pytest.mark.parametrize("evolve", [partial(fem.evolve, elements="hexahedra"), series.evolve])
def test_transients_that_cannot_say_so(evolve):
    metal = Material(1.0, 1.0, 1.0)
    sheet = Layer(0, 0.2, 0.4, metal, resistance=1e-3)
    scene = Scene((1.0, 1.0, 1.0), metal, [sheet], walls={"x-": 0.0}, initial=1.0)
    with pytest.raises(NotImplementedError, match=r"Scene.inclusions\[0\].resistance = "):
        list(evolve(scene, [1.0]))


def test_beside_pores_elements_refuse_it():
    pore = Sphere((0.1, 0.1, 0.1), 0.05, Material(0.0))
    scene = Scene((1.0, 1.0, 1.0), Material(MATRIX), [*array(0.5).inclusions, pore], walls=WALLS)
    with pytest.raises(NotImplementedError, match="beside interfaces with a resistance"):
        fem.solve(scene)


# ---------------------------------------------------------------- what they find


@pytest.mark.parametrize("r", WITNESS)
def test_arrays_are_those_of_the_literature(r):
    assert_allclose(lattice.conductivity("sc", CONTRAST, FRACTION, resistance=r), WITNESS[r], rtol=1e-9)  # as printed
    aside = array(r, center=(0.07, 0.45, 0.98), gradient=(0.0, 1.0, 0.0))
    assert_allclose(exact.solve(aside).conductivity / MATRIX, WITNESS[r], rtol=1e-9)
    # As accurate as is asked for: 1e-5.
    assert_allclose(multipole.solve(array(r)).conductivity / MATRIX, WITNESS[r], rtol=1e-5)


@pytest.mark.parametrize("contrast", [0.0, 0.3, math.inf])
def test_other_arrays_are_those_of_multipoles_and_limits(contrast):
    """Perfect conductors, and what a resistance beyond all numbers leaves: a pore."""
    pore = lattice.conductivity("sc", 0.0, FRACTION)
    # The rest goes with the inverse of the resistance.
    assert_allclose(lattice.conductivity("sc", contrast, FRACTION, resistance=1e12), pore, rtol=1e-11)
    of = min(contrast, 1e9)
    found = multipole.solve(array(0.7, contrast=of, gradient=(0.0, 1.0, 0.0)), order=11).conductivity / MATRIX
    # A finite conductor instead of a perfect one: 1e-9 of it is missing.
    expected = lattice.conductivity("sc", contrast, FRACTION, resistance=0.7, order=11)
    assert_allclose(found, expected, rtol=1e-8)


def test_forms_that_know_no_resistance_are_not_taken():
    # Of the matrix's own conductivity, and yet no homogeneous box.
    same = exact.solve(array(0.7, contrast=1.0))
    expected = lattice.conductivity("sc", 1.0, FRACTION, resistance=0.7)
    assert_allclose(same.conductivity / MATRIX, expected, rtol=1e-9)  # digits of the array
    assert same.stats["form"] == "sc array" and expected < 0.95
    coated = gallery.coated_sphere()
    outer, inner = coated.inclusions
    assert exact.solve(coated).stats["form"] == "neutral coated spheres"
    pair = gallery.body_centred(10.0, fraction=0.2)
    one, other = pair.inclusions
    for scene, inclusions in (
        (coated, (outer, replace(inner, resistance=1e-6))),
        (pair, (one, replace(other, resistance=1e-6))),
    ):
        with pytest.raises(NotImplementedError, match="no closed form"):
            exact.solve(replace(scene, inclusions=inclusions))


def test_mirror_images_have_the_same_surfaces():
    """Spheres that mirror each other but for their resistance are not periodic as they stand."""
    found = []
    for shift in (0.0, 1e-9):
        one = Sphere((0.27 + shift, 0.5, 0.5), 0.2, Material(20.0), resistance=1.0)
        other = Sphere((0.73, 0.5, 0.5), 0.2, Material(20.0))
        field = multipole.solve(
            Scene((1.0, 1.0, 1.0), Material(1.0), [one, other], walls={"x-": 0.0, "x+": 1.0}), order=5
        )
        found.append((field.conductivity, field.temperature_at([0.5, 0.5, 0.5])[0]))
    # A billionth of the box moves it by about as much.
    assert_allclose(found[0], found[1], rtol=1e-7)
    assert abs(found[0][1] - 0.5) > 1e-2


def test_the_power_of_elements_counts_what_surfaces_take():
    """By the power answers at extreme contrasts are checked for rounding."""
    field = fem.solve(array(0.5, contrast=3e6), size=0.25)
    expected = lattice.conductivity("sc", 3e6, FRACTION, resistance=0.5) * MATRIX
    assert_allclose(field.conductivity, expected, rtol=allowed("fem"))
    # And at the faces of a cell, where the temperature rises by the mean gradient besides.
    scene = sheets(gradient=(0.0, 3.0, 0.0))
    parts = split(scene, make(scene, size=0.4, order=1))
    power = NodalField(scene, parts, solve_nodes(scene, parts, 1e-12).temperature).power()
    assert_allclose(power, 9 * exact.solve(scene).conductivity, rtol=1e-9)  # the solver's tolerance


@pytest.mark.parametrize("name", ["dem", "fem", "multipole"])
def test_neutral_spheres_change_nothing_outside(name):
    field, gradient = small(name, crowd), np.array(crowd().gradient)
    error = allowed(name, least=1e-9)
    assert_allclose(field.conductivity, MATRIX, rtol=error)
    assert_allclose(field.mean_flux, -MATRIX * gradient, rtol=0, atol=error * MATRIX * np.linalg.norm(gradient))
    points = np.random.default_rng(0).random((400, 3))
    points = points[field.scene.phase_at(points) == 0]
    rest = field.temperature_at(points) - points @ gradient
    # Declared of temperatures over the span: that of the gradient over the cell.
    assert np.std(rest) <= allowed(name, "temperature", 1e-9) * np.abs(gradient).sum()
    # Inside it is uniform, too: all of the matrix's flux goes through.
    center = np.array([each.center for each in field.scene.inclusions])
    inner = -MATRIX * gradient * np.ones((len(center), 1))
    atol = allowed(name, "flux", 1e-8) * MATRIX * np.linalg.norm(gradient)
    assert_allclose(field.flux_at(center), inner, rtol=0, atol=atol)


@pytest.mark.parametrize("name", ["dem", "fem", "multipole"])
def test_beyond_all_resistance_it_is_a_pore(name):
    pore = answered(METHODS[name], array(0.0, contrast=0.0))
    # What still passes goes with its inverse; beside it the tolerance of the solver at so stiff an interface.
    assert_allclose(small(name, array, 1e7).conductivity, pore.conductivity, rtol=1e-6)


@pytest.mark.parametrize("name", KNOWN)
def test_the_temperature_jumps_by_the_flux_times_the_resistance(name):
    field = small(name, array, 0.5)
    normals = np.random.default_rng(1).normal(size=(200, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    surface = 0.5 + RADIUS * normals
    out, into = surface + 1e-7 * normals, surface - 1e-7 * normals
    flux = exact.solve(array(0.5)).flux_at(into)
    jump = field.scene.inclusions[0].resistance * np.einsum("ij,ij->i", flux, normals)
    found = field.temperature_at(into) - field.temperature_at(out)
    # Twice the error of a temperature, one from either side, in the mean: the largest jump is a fifth of the span.
    error = 2 * allowed(name, "temperature", 1e-6) * 30.0
    # Voxels beside the surface tell of both sides by their one flux.
    error *= 2 if name.startswith("fft") else 1
    assert np.sqrt(np.mean((found - jump) ** 2)) <= error
    assert 5 * error < np.abs(jump).max()


# Layers that touch, one in another that ends with it, one that ends at the face of the cell where the first begins.
SHEETS = [(0.0, 0.2, 5.0, 0.3), (0.2, 0.5, 10.0, 0.04), (0.3, 0.5, 0.5, 0.007), (0.8, 1.0, 20.0, 0.5)]


def sheets(**load):
    layers = [Layer(1, start, stop, Material(k), resistance=r) for start, stop, k, r in SHEETS]
    return Scene((1.0, 1.0, 1.0), Material(1.0), layers, **load)


@pytest.mark.parametrize("load", [{"walls": {"y-": 20.0, "y+": 50.0}}, {"gradient": (0.0, 3.0, 0.0)}])
@pytest.mark.parametrize("name", ["dem", "fem", "fem-p1", "exact", "fft"])
def test_layers_and_their_surfaces_are_in_series(name, load):
    whole = 0.2 / 5 + 0.1 / 10 + 0.2 / 0.5 + 0.3 / 1 + 0.2 / 20
    met = (0.3 + 0.04) + 0.007 + (0.007 + 0.04) + 0.5
    met += 0.8 if "gradient" in load else 0.0
    scene = sheets(**load)
    field = answered(METHODS[name], scene)
    assert_allclose(field.conductivity, 1 / (whole + met), rtol=1e-8)  # solvers' tolerances
    points = np.column_stack([np.full(9, 0.4), [0.1, 0.15, 0.25, 0.28, 0.4, 0.6, 0.7, 0.85, 0.95], np.full(9, 0.6)])
    expected = exact.solve(scene).temperature_at(points)
    found = field.temperature_at(points)
    if "gradient" in load:
        expected, found = expected - expected.mean(), found - found.mean()
    # The DEM's fits between its cells; voxels that a face cuts have one slope for both its sides.
    assert_allclose(found, expected, rtol=0, atol=(2e-4 if name == "fft" else 1e-5) * np.ptp(expected))
    flux = np.tile([0.0, -(30.0 if "walls" in load else 3.0) / (whole + met), 0.0], (9, 1))
    assert_allclose(field.flux_at(points), flux, rtol=0, atol=1e-4 * abs(flux[0, 1]))


def test_a_sheet_along_the_load_does_not_matter():
    scene = Scene((1.0, 1.0, 1.0), Material(1.0), [Layer(0, 0.2, 0.6, Material(3.0), resistance=5.0)], walls=WALLS)
    for name in ("dem", "fem", "exact", "fft"):
        assert_allclose(answered(METHODS[name], scene).conductivity, 0.6 + 0.4 * 3, rtol=1e-8)  # solvers' tolerances


def test_nested_surfaces_and_walls_that_cut_them():
    """A shell that resists, in halves at a wall: elements find what those of the whole do, and the DEM does."""
    made = []
    for center, size in (((0.5, 0.5, 0.5), 1.0), ((0.0, 0.5, 0.5), 0.5)):
        shell = Sphere(center, 0.4, Material(3.0), resistance=0.05)
        core = Sphere(center, 0.22, Material(10.0), resistance=0.2)
        made.append(Scene((size, 1.0, 1.0), Material(1.0), [shell, core], walls=WALLS))
    found = [answered(METHODS["fem"], scene).conductivity for scene in made]
    assert_allclose(found[1], found[0], rtol=2 * allowed("fem"))
    assert_allclose(answered(METHODS["dem"], made[1]).conductivity, found[0], rtol=allowed("dem") + allowed("fem"))


SLOW = {"dem": (demheat.evolve, {"particles": 1000}, 1e-2), "fem": (fem.evolve, {"size": 0.3, "accuracy": 2e-4}, 2e-3)}


@pytest.mark.parametrize("name", SLOW)
def test_a_sphere_behind_a_resistance_warms_at_its_own_pace(name):
    """So much that it has one temperature: then it tends to that of the walls within capacity a R/3."""
    metal, radius, resistance = Material(1.0, 1.0, 1.0), 0.3, 1000.0
    inner = Sphere((0.5, 0.5, 0.5), radius, metal, resistance=resistance)
    walls = dict.fromkeys(("x-", "x+", "y-", "y+", "z-", "z+"), 1.0)
    scene = Scene((1.0, 1.0, 1.0), metal, [inner], walls=walls, initial=0.0)
    pace = radius * resistance / 3
    evolve, knobs, rtol = SLOW[name]
    (field,) = evolve(scene, [0.5 * pace], **knobs)
    # Besides the surface heat meets the sphere, radius/5, and the matrix, at most the radius: .04 %; the matrix itself
    # takes some .03 of 50 seconds to warm up: .06 %; surface over volume of coarse elements .1 %, of the polyhedron
    # that has the sphere's volume, with so few facets, .7 %.
    assert_allclose(field.temperature_at([0.5, 0.5, 0.5]), 1 - math.exp(-field.time / pace), rtol=rtol)
