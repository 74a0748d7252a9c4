"""Only here: calibrations of contacts between walls, choices of laws at work, warnings of what particles do not see."""

import time

import numpy as np
import pytest
from numpy.testing import assert_allclose

import demheat
from demheat import Layer, Material, Scene, Sphere
from demheat.dem.calibration import LOADINGS, calibration
from demheat.dem.networks import network_of
from demheat.laws import Calibrated, Laguerre
from demheat.packing.cache import relaxed
from demheat.packing.neighbours import contacts

ONE, TEN = Material(1.0), Material(10.0)
RADIUS = 1 / 3


def ball(k=10.0, *, periodic=False, radius=RADIUS):
    load = {"gradient": (0, 1, 0)} if periodic else {"walls": {"y-": 0.0, "y+": 1.0}}
    return Scene(size=(1, 1, 1), matrix=ONE, inclusions=[Sphere((0.5,) * 3, radius, Material(k))], **load)


@pytest.mark.parametrize("knobs", [{"sparse": "keep"}, {"sparse": "drop"}, {"wall": "surface"}])
def test_calibrated_law_is_exact_where_homogeneous_with_every_choice(knobs):
    scene = Scene(size=(1, 1, 1), matrix=TEN, walls={"z-": 0.0, "z+": 1.0})
    field = demheat.solve(scene, particles=1500, law="calibrated", **knobs)
    # All links, those to walls too, scale with C_t; both solves have a tolerance of 1e-8 on each particle's balance.
    assert_allclose(field.conductivity, 10.0, rtol=1e-4)
    own = field.samples
    assert_allclose(own.volumes.sum(), 1.0, rtol=1e-12)
    if knobs.get("sparse") == "drop":
        assert 1450 < len(own.volumes) < 1500
        assert np.isfinite(own.temperature).all()


@pytest.fixture(scope="module")
def between_walls():
    """A periodic packing and one with walls along y whose bulk is in the same state: a wall takes 0.27 mean radii."""
    return relaxed(3000, seed=0), relaxed(3000, periodic=(True, False, True), phi=0.628, seed=0)


def homogeneous(packing):
    load = {"gradient": (0, 1, 0)} if packing.periodic.all() else {"walls": {"y-": 0.0, "y+": 1.0}}
    return Scene(size=tuple(packing.size), matrix=ONE, **load)


def uncalibrated(packing, **knobs):
    """The contact network with C_t = 1 of a packing."""
    return network_of(homogeneous(packing), packing, Calibrated(factor=1.0, **knobs))


def test_calibration_with_links_at_the_wall_is_that_of_the_periodic_cell(between_walls):
    found = {}
    for wall in ("center", "surface"):
        found[wall] = [calibration(uncalibrated(p, wall=wall), homogeneous(p)) for p in between_walls]
    periodic, surface = found["surface"]
    # The two packings differ by their sampling: 0.3 % between seeds at 1e4 particles. Centres held at the walls'
    # temperatures take two radii off the length, 5 %.
    assert_allclose(surface, periodic, rtol=0.01)
    assert found["center"][1] < 0.97 * periodic


def test_calibration_by_a_flux_is_that_by_temperatures_up_to_the_ends(between_walls):
    network, scene = uncalibrated(between_walls[1], wall="surface"), homogeneous(between_walls[1])
    held, heated = (calibration(network, scene, loading=loading) for loading in LOADINGS)
    # Two loads of one resistor differ by how they share the heat among the particles at the wall.
    assert held != heated
    assert_allclose(held, heated, rtol=0.03)
    # Of all ways to spread a heat flow over the wall the isothermal one takes the least power (Thomson's principle).
    assert heated > held


def test_kept_particles_carry_no_steady_heat(between_walls):
    """Dead ends and islands conduct nothing between periodic images: without them C_t is the same."""
    packing = between_walls[0]
    networks = (uncalibrated(packing, sparse=sparse) for sparse in ("keep", "drop", "nearest"))
    kept, dropped, joined = (calibration(network, homogeneous(packing)) for network in networks)
    # Solver tolerance, 1e-8 on each particle's balance.
    assert_allclose(kept, dropped, rtol=1e-6)
    assert joined < kept * (1 - 1e-4)


def test_walls_that_nobody_touches(between_walls):
    packing = between_walls[1]
    hollow = packing._replace(centers=packing.centers * [1, 0.8, 1] + [0, 0.1, 0])
    with pytest.raises(ValueError, match="no heat passes"):
        calibration(uncalibrated(hollow), homogeneous(packing))


def test_rotating_the_scene_and_its_packing_rotates_the_flux():
    packing = relaxed(1500, periodic=False, seed=5)
    turned = packing._replace(centers=np.ascontiguousarray(packing.centers[:, [2, 0, 1]]))
    values = []
    for pack, letter, center in ((packing, "y", (0.4, 0.5, 0.45)), (turned, "z", (0.45, 0.4, 0.5))):
        scene = Scene(
            size=(1, 1, 1),
            matrix=ONE,
            inclusions=[Sphere(center, 0.3, TEN)],
            walls={letter + "-": 0.0, letter + "+": 1.0},
        )
        values.append(demheat.solve(scene, packing=pack, conforming=False, tolerance=1e-12).conductivity)
    assert_allclose(*values, rtol=1e-9)


@pytest.mark.parametrize(
    "change, words",
    [
        ({"law": "calibrated", "conforming": True}, "conforming = True"),
        ({"particles": 99}, "particles = 99"),
        ({"wall": "surface"}, "wall = 'surface'"),
    ],
)
def test_bad_input_before_heavy_work(change, words, monkeypatch):
    def heavy(*args, **kwargs):
        raise AssertionError("heavy work was begun")

    monkeypatch.setattr("demheat.dem.solver.networks_of", heavy)
    with pytest.raises(ValueError, match=words):
        demheat.solve(ball(), **{"particles": 200} | change)


def test_gaps_that_particles_do_not_resolve_are_warned_of():
    with pytest.warns(UserWarning, match="do not fit into gaps"):
        demheat.solve(ball(radius=0.4995), particles=1000)


FILM, SPECK = Layer(1, 0.5, 0.50005, TEN), Sphere((0.5, 0.5, 0.5), 5e-4, TEN)


@pytest.mark.parametrize("tiny, knobs", [(SPECK, {}), (FILM, {"conforming": False}), (FILM, {"law": "calibrated"})])
def test_an_inclusion_without_particles_is_warned_of(tiny, knobs):
    film = Scene(size=(1, 1, 1), matrix=ONE, inclusions=[tiny], walls={"y-": 0.0, "y+": 1.0})
    with pytest.warns(UserWarning) as caught:
        demheat.solve(film, particles=500, **knobs)
    words = [str(each.message) for each in caught]
    assert any("no particle lies in inclusions [0]" in each for each in words)
    # Twins do not fit into the speck either.
    assert all("no particle lies" in each or "do not fit into gaps" in each for each in words)


def test_calibrated_law_refuses_held_walls_that_meet():
    scene = Scene(size=(1, 1, 1), matrix=ONE, walls={"x-": 1.0, "y-": 0.0})
    with pytest.raises(NotImplementedError, match="two held walls meet"):
        demheat.solve(scene, particles=500, law="calibrated")
    # Walls met at their surface have no such trouble: what enters at one leaves at the other.
    field = demheat.solve(scene, particles=3000, law="calibrated", wall="surface")
    assert field.wall_heat["x-"] > 0
    assert_allclose(field.wall_heat["x-"], -field.wall_heat["y-"], rtol=1e-5)  # solver tolerance


def test_packing_of_another_box_is_refused():
    with pytest.raises(ValueError, match="packing of size"):
        demheat.solve(ball(), packing=relaxed(200, seed=0))


def test_a_gap_takes_the_place_of_a_number_of_contacts():
    scene = ball(periodic=True)
    packing = relaxed(500, seed=0)
    gap = contacts(packing, coordination=7.0)[2]
    by_number, by_gap = (
        demheat.solve(scene, packing=packing, law="calibrated", **knob).conductivity
        for knob in ({"coordination": 7.0}, {"gap": gap})
    )
    assert by_gap == by_number
    # A sheet two particles thick has none away from its walls: only a gap says who is in contact.
    sheet = Scene(size=(1, 1, 0.2), matrix=ONE, walls={"x-": 0.0, "x+": 1.0})
    with pytest.raises(ValueError, match="margin = 4.0"):
        demheat.solve(sheet, particles=300, law="calibrated")
    assert_allclose(demheat.solve(sheet, particles=300, law="calibrated", gap=0.1).conductivity, 1.0, rtol=1e-6)


def test_calibration_in_a_round_body():
    """The tessellation of a cylinder conducts exactly between its ends; its round wall is insulated."""
    packing = relaxed(300, size=(2.0, 1.0, 1.0), periodic=False, domain="cylinder-x", seed=0)
    ends = Scene(size=(2, 1, 1), matrix=ONE, walls={"x-": 0.0, "x+": 1.0})
    # What is compared with has the area of the packing's own ends; the solver leaves 1e-8.
    assert_allclose(calibration(network_of(ends, packing, Laguerre()), ends), 1.0, rtol=1e-7)


def test_what_was_spent_is_within_the_whole():
    begun = time.perf_counter()
    field = demheat.solve(ball(), particles=300)
    whole = time.perf_counter() - begun
    spent = field.stats["packing_s"], field.stats["solve_s"]
    assert min(spent) > 0 and sum(spent) < whole
