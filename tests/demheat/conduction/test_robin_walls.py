"""Only here: films and radiating walls of the DEM against resistances in series and a quartic, to the solver."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq

from demheat import Convection, Flux, Material, Radiation, Scene, Sphere, referee, solve
from demheat.conduction.robin import RobinWalls, in_series, radiating_surface
from demheat.sampling.halo import halo_flux
from demheat.scene import STEFAN_BOLTZMANN, Layer
from references.exact.benchmarks import convecting_plate

ONE = Material(2.0)
BOX = (1.0, 2.0, 0.5)
FEW = {"particles": 300, "tolerance": 1e-12}
POINTS = np.random.default_rng(3).random((40, 3)) * BOX
POINTS[:8, 1], POINTS[8:16, 1] = 0.0, 2.0


def series_flux(walls):
    """Flux density up y of a slab of length 2 and conductivity 2, by resistances in series."""
    (low, a), (high, b) = ((0.0, w) if isinstance(w, float) else (1 / w.coefficient, w.temperature) for w in walls)
    return (a - b) / (low + 2.0 / 2.0 + high), a, low


@pytest.mark.parametrize(
    "walls",
    [(100.0, Convection(3.0, 20.0)), (Convection(0.1, 20.0), 100.0), (Convection(50.0, -5.0), Convection(0.3, 60.0))],
)
@pytest.mark.parametrize(
    "knobs", [{}, pytest.param({"law": "laguerre", "interface": "arithmetic", "solver": "amg"}, marks=pytest.mark.slow)]
)
def test_slab_with_convection_is_exact(walls, knobs):
    field = solve(Scene(BOX, ONE, walls=dict(zip(("y-", "y+"), walls, strict=True))), **FEW, **knobs)
    flux, hot, film = series_flux(walls)
    scale = abs(flux) + 100.0
    # Linear fields are exact on any packing: to the solver's tolerance, times n^(2/3) for its condition.
    assert_allclose(field.temperature_at(POINTS), hot - flux * (film + POINTS[:, 1] / 2.0), atol=1e-9 * scale)
    assert_allclose(field.flux_at(POINTS), np.tile([0.0, flux, 0.0], (40, 1)), atol=1e-8 * scale)
    assert_allclose(field.wall_temperature["y-"], hot - flux * film, atol=1e-9 * scale)
    assert_allclose([field.wall_heat["y-"], field.wall_heat["y+"]], [flux * 0.5, -flux * 0.5], atol=1e-9 * scale)
    assert_allclose(field.conductivity, 2.0, rtol=1e-9)
    assert_allclose(field.mean_flux, [0.0, flux, 0.0], atol=1e-8 * scale)
    # Mirrors in the walls continue what is even.
    assert_allclose(halo_flux(field, ratio=3.0, walls="mirror", at=POINTS[:20])[:, 1], flux, rtol=1e-7)


def test_points_on_a_wall_that_convects():
    """NAFEMS T4: a plate with its base at 100 C, films at its top and right edge."""
    film = Convection(750.0, 0.0)
    scene = Scene((0.6, 1.0, 0.2), Material(52.0), walls={"y-": 100.0, "x+": film, "y+": film})
    field = solve(scene, particles=1000)
    points = np.column_stack([np.full(400, 0.6), np.linspace(0.05, 1.0, 400), np.tile([0.05, 0.1, 0.15, 0.19], 100)])
    right = 100 * convecting_plate(points[:, 0], points[:, 1], width=0.6, height=1.0, film=750 / 52)
    # The film's own condition at the wall: found .25 K by harmonic cubics. By quadratics .19; with the surface's
    # temperature as what is known .55, with the slope that its heat makes .31.
    assert referee.rms(field.temperature_at(points) - right) < 0.28


@pytest.mark.parametrize("law", ["calibrated", "platonic"])
def test_contact_laws_with_temperatures_at_the_wall(law):
    walls = {"y-": 100.0, "y+": Convection(3.0, 20.0)}
    scene = Scene((1.0, 1.0, 1.0), ONE, walls=walls)
    field = solve(scene, law=law, wall="surface", particles=1000)
    # Whatever the network's own conductivity is, heat passes it and the film in series.
    film, whole = 1 / 3.0, 1 / field.conductivity
    assert_allclose(field.wall_heat["y-"], 80.0 / (whole + film), rtol=1e-6)
    assert_allclose(field.wall_temperature["y+"], 20.0 + film * 80.0 / (whole + film), rtol=1e-6)
    assert law == "platonic" or abs(field.conductivity / 2.0 - 1) < 0.02
    with pytest.raises(NotImplementedError, match="surface is left to exchange heat"):
        solve(scene, law=law)


def coated(k, walls):
    inclusions = [Sphere((0.5, 0.5, 0.5), 0.4, Material(20.0)), Sphere((0.5, 0.5, 0.5), 0.2, Material(k))]
    return Scene((1.0, 1.0, 1.0), ONE, inclusions, walls=walls)


@pytest.mark.parametrize("k", [0.0, 5.0])
def test_a_composite_keeps_its_heat(k):
    walls = {"x-": 100.0, "x+": Convection(3.0, 20.0), "y-": Flux(30.0), "z+": Convection(0.5, 40.0)}
    field = solve(coated(k, walls), particles=500, tolerance=1e-10)
    assert abs(sum(field.wall_heat.values())) < 1e-8 * field.wall_heat["x-"]
    for name in ("x+", "z+"):
        load = walls[name]
        through = load.coefficient * (load.temperature - field.wall_temperature[name])
        assert_allclose(field.wall_heat[name], through, rtol=1e-9)
    # A section carries what the walls behind it take.
    assert_allclose(field.heat_through(1, 0.0), 30.0, rtol=1e-8)


def quartic(k, length, hot, emissivity, around):
    """Surface temperature of a slab held at one wall that radiates at the other."""
    return brentq(
        lambda T: k * (hot - T) / length - emissivity * STEFAN_BOLTZMANN * (T**4 - around**4),
        0.0,
        1e4,
        xtol=1e-13,
        rtol=1e-15,
    )


@pytest.mark.parametrize(("hot", "around", "solver"), [(1000.0, 0.0, "cg"), (0.0, 900.0, "cg"), (3.0, 5000.0, "amg")])
def test_slab_that_radiates(hot, around, solver):
    scene = Scene((0.1, 0.1, 0.1), Material(55.563), walls={"x-": hot, "x+": Radiation(0.98, around)})
    field = solve(scene, solver=solver, **FEW)
    right = quartic(55.563, 0.1, hot, 0.98, around)
    # One equation of fourth degree; the tolerance of 1e-12 of the heat, times n^(2/3).
    assert_allclose(field.wall_temperature["x+"], right, rtol=1e-10)
    assert_allclose(field.wall_heat["x+"], 0.98 * STEFAN_BOLTZMANN * (around**4 - right**4) * 0.01, rtol=1e-9)
    assert field.stats["residual"] <= 1e-12 and 1 < field.stats["rounds"] <= 15
    flux = halo_flux(field, ratio=3.0, walls="mirror", at=[[0.1, 0.05, 0.05], [0.099, 0.01, 0.05]])
    assert_allclose(flux[:, 0], 555.63 * (hot - right), rtol=1e-6)


def test_what_is_asked_is_asked_of_the_fourth_powers():
    """Linear equations that are solved are not enough: one round of Newton's method is far off here."""
    scene = Scene((0.1, 0.1, 0.1), Material(0.5), walls={"x-": 1000.0, "x+": Radiation(0.98, 300.0)})
    field = solve(scene, particles=300, tolerance=1e-3)
    right = quartic(0.5, 0.1, 1000.0, 0.98, 300.0)
    # The tolerance, of the heat that passes, which goes with the fourth power.
    assert_allclose(field.wall_temperature["x+"], right, rtol=1e-3)
    assert field.stats["rounds"] > 2


def test_radiation_that_is_not_met_is_an_error(monkeypatch):
    monkeypatch.setattr("demheat.conduction.steady.ROUNDS", 1)
    scene = Scene((0.1, 0.1, 0.1), Material(55.563), walls={"x-": 1000.0, "x+": Radiation(0.98, 300.0)})
    with pytest.raises(RuntimeError, match="relative residual"):
        solve(scene, **FEW)


def test_a_body_at_rest_has_the_temperature_of_its_surroundings():
    """Behind a layer of pores it reaches one temperature alone."""
    layer = Layer(0, 0.4, 0.6, Material(0.0))
    for load in (Convection(3.0, 20.0), Radiation(0.5, 20.0)):
        field = solve(Scene((1.0, 1.0, 1.0), ONE, [layer], walls={"x-": 100.0, "x+": load}), particles=300)
        assert_allclose(field.temperature_at([[0.9, 0.5, 0.5], [0.1, 0.5, 0.5]]), [20.0, 100.0], rtol=1e-14)
        assert field.wall_heat == {"x-": 0.0, "x+": 0.0}
        assert_allclose(field.wall_temperature["x+"], 20.0, rtol=1e-14)


def test_the_error_of_such_a_field():
    scene = coated(5.0, {"x-": 400.0, "x+": Radiation(0.9, 300.0)})
    coarse, fine = (solve(scene, particles=number) for number in (600, 4800))
    found = coarse.error
    # The finer run is off itself by a quarter.
    assert found.how == "fewer particles" and found.lower < fine.conductivity < found.upper
    at = np.random.default_rng(0).random((200, 3))
    off = referee.temperature_error(coarse, fine, at).rms * 100.0
    assert off < 2 * found.temperature


def test_films_in_series():
    own, film = np.array([2.0, 2.0, 0.0, 2.0, 0.0]), np.array([np.inf, 6.0, 6.0, 0.0, np.inf])
    robin = RobinWalls(film, np.array([10.0, 10.0, 10.0, np.nan, 10.0]))
    assert_allclose(robin.ties(own), [2.0, 1.5, 0.0, 0.0, 0.0])
    assert_allclose(robin.surface(own, np.full(5, 2.0)), [10.0, 8.0, 2.0, 2.0, 10.0])
    assert_allclose(in_series(film, own), robin.ties(own))


def test_surfaces_that_radiate():
    rng = np.random.default_rng(0)
    own, black, inside = 10 ** rng.uniform(-6, 3, 500), 10 ** rng.uniform(-14, -6, 500), rng.uniform(0, 3000, 500)
    for around in (0.0, 300.0, 4000.0):
        surface = radiating_surface(own, black, inside, around)
        lost = black * (around**4 - surface**4) + own * (inside - surface)
        # Rounding of the terms.
        assert np.all(np.abs(lost) <= 1e-13 * (black * (around**4 + surface**4) + own * (inside + surface)))
