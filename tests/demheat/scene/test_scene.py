"""Only here: inclusions that overlap or hide and are taken, phases painted in another order, images left out."""

from dataclasses import FrozenInstanceError

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from demheat import (
    Flux,
    Layer,
    Material,
    MovingCylinder,
    Scene,
    Sphere,
    UniformSource,
)

A, B = Material(1.0), Material(2.0)
BOX = (1.0, 1.0, 1.0)
WALLS = {"y-": 0.0, "y+": 1.0}
PERIODIC = {"gradient": (0, 1, 0)}


def scene(*inclusions, size=BOX, **load):
    return Scene(size, A, inclusions, **(load or {"walls": WALLS}))


def ball(x, y, z, radius, material=B):
    return Sphere((x, y, z), radius, material)


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: Scene(BOX, A, ball(0.5, 0.5, 0.5, 0.1), walls=WALLS), "must be a sequence of Sphere or Layer"),
        (lambda: Scene(BOX, A), "neither given; a scene needs exactly one load"),
        (lambda: Scene(BOX, A, walls=WALLS, gradient=(0, 1, 0)), "both given; a scene needs exactly one load"),
        (lambda: Scene(BOX, A, walls=[25.0, 35.0]), "Scene.walls = .*must map"),
    ],
)
def test_bad_scenes(make, match):
    with pytest.raises(ValueError, match=match):
        make()


@pytest.mark.parametrize(
    ("inclusions", "load", "match"),
    [
        ([ball(0.5, 0.5, 0.5, 0.51)], PERIODIC, "sphere of diameter 1.02 is larger than the box; must be <= 1.0 m"),
        ([ball(1.2, 0.5, 0.5, 0.1)], {}, "lies outside the box"),
        (
            [ball(0.3, 0.5, 0.5, 0.2), ball(0.6, 0.5, 0.5, 0.2)],
            {},
            r"\[0\] and \[1\] overlap partially: .*spheres of 0.75 times their radii would be$",
        ),
        # What touches another one from within would come out of it.
        (
            [ball(0.3, 0.5, 0.5, 0.2), ball(0.4, 0.5, 0.5, 0.1), ball(0.6, 0.5, 0.5, 0.15)],
            {},
            r"\[0\] and \[2\] .* fully nested$",
        ),
        ([ball(0.1, 0.5, 0.5, 0.2), ball(0.8, 0.5, 0.5, 0.2)], PERIODIC, r"\[0\] and \[1\] overlap partially"),
        ([ball(0.5, 0.5, 0.5, 0.1), ball(0.5, 0.5, 0.5, 0.2)], {}, r"\[0\] is hidden by inclusions\[1\]"),
        ([ball(0.5, 0.5, 0.5, 0.1), ball(0.5, 0.5, 0.5, 0.1)], {}, r"\[0\] is hidden by inclusions\[1\]"),
        ([Layer(0, -0.1, 0.2, B)], {}, "layer from -0.1 to 0.2 must lie in the box, 0 to 1.0"),
        ([Layer(0, 0.1, 0.4, B), Layer(0, 0.3, 0.6, B)], {}, r"\[0\] and \[1\] overlap partially"),
        ([Layer(0, 0.3, 0.6, B), Layer(0, 0.1, 0.4, B)], {}, r"\[0\] and \[1\] overlap partially"),
        ([Layer(0, 0.2, 0.3, B), Layer(0, 0.1, 0.4, B)], {}, r"\[0\] is hidden by inclusions\[1\]"),
        ([Layer(0, 0.2, 0.3, B), Layer(0, 0.2, 0.3, B)], {}, r"\[0\] is hidden by inclusions\[1\]"),
        ([Layer(0, 0.2, 0.3, B), Layer(1, 0.2, 0.3, B)], {}, "layers along different axes cross"),
        ([Layer(0, 0.2, 0.6, B), ball(0.6, 0.5, 0.5, 0.1)], {}, r"\[0\] and \[1\] overlap partially"),
        ([ball(0.6, 0.5, 0.5, 0.1), Layer(0, 0.2, 0.6, B)], {}, r"\[0\] and \[1\] overlap partially"),
        ([ball(0.4, 0.5, 0.5, 0.1), Layer(0, 0.2, 0.6, B)], {}, r"\[0\] is hidden by inclusions\[1\]"),
        # The image of a sphere across a periodic face counts, whichever of the two comes first.
        ([ball(0.05, 0.5, 0.5, 0.1), Layer(0, 0.9, 1.0, B)], PERIODIC, r"\[0\] and \[1\] overlap partially"),
        ([Layer(0, 0.9, 1.0, B), ball(0.05, 0.5, 0.5, 0.1)], PERIODIC, r"\[0\] and \[1\] overlap partially"),
        ([Layer(0, 0.0, 0.1, B), ball(0.95, 0.5, 0.5, 0.1)], PERIODIC, r"\[0\] and \[1\] overlap partially"),
        ([Layer(0, 0.0, 0.2, B), ball(0.05, 0.5, 0.5, 0.1)], PERIODIC, r"\[0\] and \[1\] overlap partially"),
    ],
)
def test_bad_geometry(inclusions, load, match):
    with pytest.raises(ValueError, match=match):
        scene(*inclusions, **load)


@pytest.mark.parametrize(
    ("inclusions", "load"),
    [
        ([ball(0.5, 0.5, 0.5, 0.5)], {}),
        ([ball(0.0, 0.0, 0.0, 0.5)], PERIODIC),
        # Touching, within the rounding of 0.1 + 0.2.
        ([ball(0.2, 0.5, 0.5, 0.1), ball(0.4, 0.5, 0.5, 0.1)], {}),
        ([ball(0.05, 0.5, 0.5, 0.1), ball(0.85, 0.5, 0.5, 0.1)], PERIODIC),
        ([ball(0.5, 0.5, 0.5, 0.4), ball(0.5, 0.5, 0.5, 0.2), ball(0.5, 0.5, 0.6, 0.1)], {}),
        ([ball(0.0, 0.5, 0.5, 0.3), ball(0.95, 0.5, 0.5, 0.1)], PERIODIC),
        ([ball(-0.05, 0.5, 0.5, 0.1), ball(1.05, 0.5, 0.5, 0.1)], {}),
        ([Layer(0, 0.0, 0.5, B), Layer(0, 0.5, 1.0, A)], {}),
        ([Layer(0, 0.2, 1.0 + 1e-15, B)], {}),
        ([Layer(0, 0.1, 0.9, B), Layer(0, 0.1, 0.3, A), ball(0.6, 0.5, 0.5, 0.2)], {}),
        ([Layer(0, 0.0, 0.2, B), ball(0.05, 0.5, 0.5, 0.1)], {}),
        ([Layer(0, 0.0, 0.2, B), ball(0.4, 0.5, 0.5, 0.2), ball(0.9, 0.5, 0.5, 0.1)], PERIODIC),
        ([Layer(0, 0.6, 0.8, B), ball(-1.6, 0.5, 0.5, 0.1)], PERIODIC),
        # A layer that fills the cell holds also a sphere that crosses its face.
        ([Layer(0, 0.0, 1.0, B), ball(0.05, 0.5, 0.5, 0.1, A)], PERIODIC),
    ],
)
def test_good_geometry(inclusions, load):
    assert len(scene(*inclusions, **load).materials) == len(inclusions) + 1


def test_layer_to_a_rounded_face():
    made = Scene((0.3, 1.0, 1.0), A, [Layer(0, 0.2, 0.1 + 0.2, B)], walls=WALLS)
    assert_array_equal(made.phase_at([[0.25, 0.5, 0.5], [0.15, 0.5, 0.5]]), [1, 0])


def test_phases_are_painted_in_order():
    made = scene(Layer(2, 0.0, 0.5, B), ball(0.5, 0.5, 0.25, 0.2), ball(0.5, 0.5, 0.25, 0.1, A))
    points = [[0.5, 0.5, 0.75], [0.1, 0.1, 0.25], [0.5, 0.65, 0.25], [0.5, 0.55, 0.25], [0.5, 0.5, 0.45]]
    assert_array_equal(made.phase_at(points), [0, 1, 2, 3, 2])
    assert_array_equal(made.conductivities, [1.0, 2.0, 2.0, 1.0])
    assert made.phase_at(np.empty((0, 3))).shape == (0,)


def test_phases_of_a_periodic_cell_repeat():
    made = Scene((1.0, 2.0, 3.0), A, [ball(0.05, 1.9, 0.0, 0.3), Layer(2, 1.0, 1.4, B)], gradient=(1, 0, 0))
    points = np.random.default_rng(0).uniform(0, 1, size=(200, 3)) * made.size
    phases = made.phase_at(points)
    assert set(phases) == {0, 1, 2}
    for shift in ((1, 0, 0), (0, -2, 0), (-1, 2, 6)):
        assert_array_equal(made.phase_at(points + np.array(shift, dtype=float)), phases)
    assert_array_equal(made.phase_at([[0.9, 0.1, 2.9], [0.5, 1.0, 0.0]]), [1, 0])


def test_images_cover_the_phase():
    made = Scene(BOX, A, [ball(0.05, 0.95, 0.5, 0.2), ball(0.5, 0.5, 0.5, 0.1), ball(1.3, 2.4, 0.0, 0.1)], **PERIODIC)
    found = made.images()
    assert [phase for phase, _ in found].count(1) == 4
    assert [phase for phase, _ in found].count(2) == 1
    assert [phase for phase, _ in found].count(3) == 2
    points = np.random.default_rng(1).uniform(0, 1, size=(3000, 3))
    painted = np.zeros(len(points), dtype=int)
    for phase, sphere in found:
        painted[sphere.contains(points)] = phase
    assert_array_equal(painted, made.phase_at(points))
    # At an edge and at a corner bounds reach into the box where the sphere does not.
    assert len(scene(ball(0.08, 0.08, 0.08, 0.1), **PERIODIC).images()) == 4
    cut = scene(ball(-0.05, 0.5, 0.5, 0.1))
    assert_array_equal([phase for phase, _ in cut.images()], [1])


def test_load_and_its_axis():
    made = scene(walls={"z-": 25, "z+": Flux(100.0)})
    assert not made.periodic
    assert made.axis == 2
    assert made.wall_temperatures == {"z-": 25.0}
    assert made.wall_fluxes == {"z+": 100.0}
    assert made.volume == 1.0
    made.require(steady=True)
    cell = Scene((1.0, 2.0, 3.0), A, gradient=[0, 1, 2])
    assert cell.periodic
    assert cell.gradient == (0.0, 1.0, 2.0)
    assert_allclose(cell.volume, 6.0)
    assert cell.wall_temperatures == cell.wall_fluxes == {}
    cell.require(steady=True)


@pytest.mark.parametrize("walls", [{"x-": 1.0, "y+": 2.0}, {"x-": 1.0, "x+": 2.0, "y-": 3.0}])
def test_other_loads_have_no_axis(walls):
    with pytest.raises(ValueError, match="only two opposite loaded walls define an axis"):
        scene(walls=walls).axis  # noqa: B018


def test_fluxes_alone_fix_no_temperature():
    with pytest.raises(ValueError, match="needs at least one wall with a temperature"):
        scene(walls={"x-": Flux(1.0), "x+": Flux(-1.0)}).require(steady=True)


def test_scenes_are_values():
    walls = dict(WALLS)
    made = scene(ball(0.5, 0.5, 0.5, 0.2), walls=walls)
    walls["x-"] = 3.0
    assert made.walls == WALLS
    assert made == scene(Sphere([0.5, 0.5, 0.5], np.float64(0.2), B))
    assert Material(33) == Material(33.0)
    assert isinstance(Material(33).conductivity, float)
    with pytest.raises(FrozenInstanceError):
        made.matrix = B


STEEL = Material(33.0, density=7800.0, heat_capacity=0.9)


def transient(**more):
    return Scene(**({"size": (1.0, 2.0, 1.0), "matrix": STEEL, "initial": 25.0} | more))


def test_a_transient_may_do_without_walls():
    made = transient()
    made.require(steady=False)
    assert made.walls == {} and not made.periodic
    with pytest.raises(ValueError, match="at least one wall with a temperature"):
        made.require(steady=True)
    with pytest.raises(ValueError, match="neither given"):
        Scene(size=(1, 1, 1), matrix=STEEL)


def test_loads_in_time():
    made = transient(walls={"y-": lambda time: 20.0 + time, "y+": Flux(lambda time: 2.0 * time), "x-": 3.0})
    then = made.at(5.0)
    assert then.wall_temperatures == {"y-": 25.0, "x-": 3.0} and then.wall_fluxes == {"y+": 10.0}
    assert then.at(7.0) is then
    with pytest.raises(ValueError, match=r"\['y-', 'y\+'\] depend on time"):
        made.require(steady=True)
    with pytest.raises(ValueError, match="y-.*at 1.0 s = nan"):
        transient(walls={"y-": lambda time: float("nan")}).at(1.0)


def test_bodies_inscribed_in_the_box():
    for domain, size, share, names in (
        ("sphere", (2, 2, 2), np.pi / 6, ["round"]),
        ("cylinder-y", (1, 5, 1), np.pi / 4, ["y-", "y+", "round"]),
        ("box", (1, 2, 3), 1.0, ["x-", "x+", "y-", "y+", "z-", "z+"]),
    ):
        made = transient(size=size, domain=domain, walls=dict.fromkeys(names, 1.0))
        assert made.volume == pytest.approx(share * np.prod(size), rel=1e-15)
        if domain != "box":
            with pytest.raises(NotImplementedError, match=domain):
                made.require(steady=True)
    with pytest.raises(ValueError, match="x-"):
        transient(size=(1, 1, 1), domain="sphere", walls={"x-": 1.0})


def test_a_moving_source():
    source = MovingCylinder(axis=2, diameter=0.008, power_density=1e11, start=(0.02, 0.015), velocity=(0.0033, 0.0))
    assert source.position(2.0) == pytest.approx((0.0266, 0.015), rel=1e-14)
    made = transient(sources=[source, UniformSource(5.0)])
    assert made.sources == (source, UniformSource(5.0))
    with pytest.raises(NotImplementedError, match="heat sources"):
        made.require(steady=True)


class TestExtremes:
    """What floating point cannot hold is refused: it gave zeros and not-a-number without a word."""

    @pytest.mark.parametrize("walls", [(1e15, 1e15 + 0.25), (-1e308, 1e308), (0.0, 1e-60)])
    def test_walls(self, walls):
        with pytest.raises(ValueError, match="Scene.walls"):
            Scene((1, 1, 1), STEEL, walls=dict(zip(("x-", "x+"), walls, strict=True)))

    @pytest.mark.parametrize("walls", [(1e15, 1e15), (-1e50, 1e50), (0.0, 1e-50), (300.0, 300.0 + 1e-7)])
    def test_walls_that_pass(self, walls):
        Scene((1, 1, 1), STEEL, walls=dict(zip(("x-", "x+"), walls, strict=True)))

    @pytest.mark.parametrize("size", [1e-51, 1e51])
    def test_sizes(self, size):
        for gradient in ((size, 0, 0), (0, -size, 0)):
            with pytest.raises(ValueError, match="Scene.gradient = .*must be from 1e-50 to 1e[+]?50"):
                Scene((1, 1, 1), STEEL, gradient=gradient)
        with pytest.raises(ValueError, match="Material.conductivity = "):
            Material(size)
        with pytest.raises(ValueError, match="Scene.size = .*must be from"):
            Scene((1, 1, size), STEEL, gradient=(1, 0, 0))
        with pytest.raises(ValueError, match="Flux.value = "):
            Flux(size)


@pytest.mark.parametrize(
    "make, match",
    [
        (lambda: transient(domain="sphere"), "must be equal"),
        (lambda: Scene(size=(1, 1, 1), matrix=STEEL, gradient=(0, 1, 0), domain="sphere"), "only a box"),
        (
            lambda: Scene(size=(1, 1, 1), matrix=STEEL, gradient=(0, 1, 0), initial=1.0).require(steady=False),
            "gradient",
        ),
    ],
)
def test_bad_transients(make, match):
    with pytest.raises(ValueError, match=match):
        make()
