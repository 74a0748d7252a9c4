"""Only here: a conductivity that no body with these fractions can have, handed out as an answer."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import Convection, Dependence, Field, Image, Layer, Material, Scene, Sphere, damage, gallery, solve
from demheat.gate import check_bracket, check_tensor, hashin_shtrikman, isotropic, unseen, wiener
from demheat.tensor import conductivity_tensor
from references import bounds, fem, fft, multipole

UNIT = (1.0, 1.0, 1.0)
BALL = Sphere((0.5, 0.5, 0.5), 0.35, Material(20.0))
CELL = Scene(UNIT, Material(1.0), [BALL], gradient=(0, 1, 0))
SHARE = BALL.volume
GRID = {"unknowns": 48**3, "voxels": (48, 48, 48), "residual": 1e-6}
OWN = np.array([1 - SHARE, SHARE])


def field(scene, k, share=SHARE, stats=GRID, **more):
    """What a method would hand back that finds a conductivity of a cell along y, with so much of its one inclusion."""
    return Field(scene, np.array([0, -k, 0]), np.array([1 - share, share]), None, None, None, stats=stats, **more)


@pytest.mark.parametrize("k", [11.12, 5.0, 1.2])
def test_no_answer_beyond_the_bounds_of_its_own_fractions(k):
    # 11.12 was an answer of links to a distance cut off. 5 is above Voigt's 4.41, 1.2 above Reuss's 1.206 less a bit.
    with pytest.raises(RuntimeError, match="no answer: the conductivity found.* beyond"):
        field(CELL, k)


def test_bounds_of_isotropic_bodies_are_narrower():
    # Reuss's bound lets 1.35 pass, which laminates once found; Hashin and Shtrikman's at least 1.44 does not.
    assert wiener(CELL, OWN).lower < 1.35 < hashin_shtrikman(CELL, OWN).lower
    with pytest.raises(RuntimeError, match="Hashin and Shtrikman's"):
        field(CELL, 1.35)
    aside = Scene((1.0, 1.0, 1.01), Material(1.0), [BALL], gradient=(0, 1, 0))
    assert isotropic(CELL) and not isotropic(aside)
    assert field(aside, 1.35).conductivity == 1.35


def test_bounds_are_the_formulas():
    k = np.array([1.0, 20.0])
    assert_allclose(wiener(CELL, OWN)[:2], [bounds.reuss(k, OWN), bounds.voigt(k, OWN)], rtol=1e-14)
    assert_allclose(hashin_shtrikman(CELL, OWN)[:2], bounds.hashin_shtrikman(1.0, 20.0, SHARE), rtol=1e-14)


def test_a_pore_leaves_no_lower_bound_and_a_resistance_neither():
    for shape in (Sphere(BALL.center, 0.35, Material(0.0)), Sphere(BALL.center, 0.35, Material(20.0), resistance=1.0)):
        scene = Scene(UNIT, Material(1.0), [shape], gradient=(0, 1, 0))
        found = wiener(scene, OWN)
        assert found.lower == 0.0 < found.upper == 1 - SHARE + SHARE * shape.material.conductivity
        assert field(scene, 0.7).conductivity == 0.7
        with pytest.raises(RuntimeError, match="no answer"):
            field(scene, 1.1 * (found.upper + 0.3))


def test_tensors_count_along_the_load():
    material = Material(((4.0, 1.0, 0.0), (1.0, 2.0, 0.0), (0.0, 0.0, 1.0)))
    scene = Scene(UNIT, material, gradient=(0, 3, 0))
    # k e.e = 2, 1 / (k^-1 e.e) = 7 / 4.
    assert_allclose(wiener(scene, np.ones(1))[:2], [7 / 4, 2.0], rtol=1e-14)


def test_conductivities_that_follow_the_temperature_count_at_all_that_there_are():
    rising = Material(2.0, dependence=Dependence(((0.0, 1.0), (50.0, 3.0), (100.0, 2.0))))
    scene = Scene(UNIT, rising, walls={"y-": 20.0, "y+": 100.0})
    assert_allclose(wiener(scene, np.ones(1))[:2], [2 * 1.8, 2 * 3.0], rtol=1e-14)


def test_walls_that_exchange_heat_are_judged_too():
    layer = Layer(0, 0.0, 0.5, Material(100.0))
    scene = Scene(UNIT, Material(1.0), [layer], walls={"y-": 0.0, "y+": Convection(10.0, 1.0)})
    # Between both bounds, 1.98 and 50.5, far from either: the good half draws the heat of its own part of the wall.
    assert 10.0 < solve(scene, particles=1000).conductivity < 50.0
    with pytest.raises(RuntimeError, match="Wiener's"):
        held = {"y-": 0.0, "y+": 1.0}
        field(scene, 55.0, 0.5, {"unknowns": 10**6}, wall_temperature=held)


def test_fractions_must_be_those_of_the_body():
    # By half a voxel at each face, .03, and what sampling may be off, .02, more may be seen.
    assert field(CELL, 2.0, share=SHARE + 0.03).conductivity == 2.0
    with pytest.raises(RuntimeError, match=r"see -0.1[2-4].* of the body's volume more"):
        field(CELL, 2.5, share=SHARE + 0.13)
    # Fewer voxels may be that far off.
    assert field(CELL, 2.5, share=SHARE + 0.13, stats={"unknowns": 1000}).conductivity == 2.5


def test_elements_may_miss_half_of_one_at_a_surface():
    # Six faces of .7 by .7, half of 1/48.
    assert_allclose(unseen(CELL, GRID), [0, 6 * 0.49 / 96], rtol=1e-14)
    assert_allclose(unseen(CELL, {"unknowns": 1000}), [0, 6 * 0.49 / 20], rtol=1e-14)
    assert not unseen(CELL, {}).any()


@pytest.mark.filterwarnings("ignore:inclusions .* are smaller than a voxel")
def test_elements_may_hold_one_of_their_own_by_chance():
    # A speck in the very middle of a voxel: its links do not meet the speck, its phase does.
    speck = Scene(UNIT, Material(1.0), [Sphere((0.5, 0.5, 0.5), 1e-9, Material(100.0))], gradient=(0, 1, 0))
    assert_allclose(unseen(speck, {"voxels": (15, 15, 15)}), [0.0, 15**-3], rtol=1e-14)
    answer = fft.solve(speck, voxels=15)
    assert_allclose(answer.fractions[1], 15**-3, rtol=1e-14)
    # A link passes a billionth of it: a part of 1e-11 of one among 3375.
    assert_allclose(answer.conductivity, 1.0, rtol=1e-10)
    # A coarser run that catches the speck is still one to compare with.
    assert fft.solve(speck, voxels=24).error.upper < 1 + 1e-6


def test_images_are_judged_by_their_own_voxels():
    labels = np.zeros((4, 4, 4), int)
    labels[:2] = 1
    scene = Scene.of_image(Image(labels, 0.25, {0: Material(1.0), 1: Material(9.0)}), gradient=(0, 1, 0))
    assert_allclose(fft.solve(scene).conductivity, 5.0, rtol=1e-9)
    for k, share in ((5.2, 0.5), (1.7, 0.5), (3.0, 0.7)):
        with pytest.raises(RuntimeError, match="no answer"):
            field(scene, k, share, {"unknowns": 10**6})


def test_methods_that_are_off_by_their_nature_have_room():
    # Networks of contacts do not conserve what a body of one material conducts.
    assert solve(gallery.slab(), law="platonic", particles=1000).slack == (0.5, 0.5)
    assert field(CELL, 5.0, slack=(0.0, 0.5)).conductivity == 5.0


def test_what_is_broken_may_conduct_less_than_any_body():
    broken = damage.solve(Scene(UNIT, Material(1.0), gradient=(0, 1, 0)), removed=0.2, particles=1000)
    assert broken.conductivity < 0.9
    with pytest.raises(RuntimeError, match="Wiener's"):
        replace(broken, slack=(0.0, 0.0))


def test_tensors_and_brackets_are_judged():
    fields = fft.solve_axes(CELL, voxels=8)
    tensor = conductivity_tensor(fields)
    twisted = tensor + np.array([[0, 4.0, 0], [4.0, 0, 0], [0, 0, 0]])
    with pytest.raises(RuntimeError, match="no answer"):
        check_tensor(CELL, twisted, fields[0].fractions, GRID)
    check_bracket(CELL, 1.5, 1.6)
    for lower, upper in ((1.6, 1.5), (4.5, 5.0), (1.0, 1.2), (1.3, 1.4)):
        with pytest.raises(RuntimeError, match="nothing in common"):
            check_bracket(CELL, lower, upper)


def test_fields_in_time_and_without_a_conductivity_pass():
    walled = Scene(UNIT, Material(1.0), walls={"y-": 0.0, "y+": 1.0}, initial=0.0)
    of_walls = {"wall_temperature": {"y-": 0.0, "y+": 1.0}}
    Field(walled, np.array([0, -5.0, 0]), np.ones(1), None, None, None, time=1.0, stats=GRID, **of_walls)
    Field(walled, np.full(3, math.nan), np.ones(1), None, None, None, stats=GRID, **of_walls)
    with pytest.raises(RuntimeError, match="no answer"):
        Field(walled, np.array([0, -5.0, 0]), np.ones(1), None, None, None, stats=GRID, **of_walls)


@pytest.mark.parametrize(
    ("method", "module", "knobs"),
    [
        (fft.solve, "references.fft.solver", {"voxels": 8}),
        (solve, "demheat.sampling.field_of", {"particles": 1000}),
        (fem.solve, "references.fem.solver", {"size": 0.4}),
        (multipole.solve, "references.multipole.solver", {"order": 3}),
    ],
)
@pytest.mark.parametrize("times", [0.3, 9.0])
def test_every_method_passes_the_gate(monkeypatch, method, module, knobs, times):
    made = []

    def wrong(**parts):
        made.append(1)
        return Field(**parts | {"mean_flux": times * parts["mean_flux"]})

    monkeypatch.setattr(f"{module}.Field", wrong)
    with pytest.raises(RuntimeError, match="no answer: the conductivity found"):
        method(CELL, **knobs)
    assert made == [1]
