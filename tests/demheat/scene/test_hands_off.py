"""Only here: arrays and functions of users that change what was made or solved of them."""

import copy
import pickle

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import demheat
from demheat import Flux, Material, MovingCylinder, Scene, Sphere, referee
from demheat.packing import make_packing
from demheat.scene import Layer, Shape
from demheat.scene.frozen import ReadOnly, read_only
from demheat.terminal import slices
from references import exact, fem

METAL = Material(1.0, 1.0, 1.0)
WALLED = Scene((1.0, 1.0, 1.0), METAL, walls={"x-": 0.0, "x+": 1.0})


def in_place(points):
    points -= 0.5
    return points[:, 0]


def crystal(number=4):
    x = (np.arange(number) + 0.5) / number
    sites = np.stack(np.meshgrid(x, x, x, indexing="ij"), axis=-1).reshape(-1, 3)
    return make_packing(sites, np.full(number**3, 0.48 / number), (1, 1, 1), False, {})


def cooling(initial, walls=None):
    return Scene((1.0, 1.0, 1.0), METAL, walls={"x-": 0.0} if walls is None else walls, initial=initial)


def by_dem(scene):
    return list(demheat.evolve(scene, [0.01], packing=crystal()))[0]


def by_fem(scene):
    return list(fem.evolve(scene, [0.01], elements="hexahedra", size=0.25))[0]


@pytest.mark.parametrize("method", [by_dem, by_fem])
def test_an_initial_temperature_may_work_in_place(method):
    """The points were the engine's own: the network or the mesh moved."""
    at = np.random.default_rng(0).random((20, 3))
    found, right = (method(cooling(initial)) for initial in (in_place, lambda x: x[:, 0] - 0.5))
    assert_array_equal(found.temperature_at(at), right.temperature_at(at))


def test_masks_and_fluxes_may_work_in_place():
    field = exact.solve(WALLED, points_per_axis=3)
    error = referee.temperature_error(field, field, mask=lambda points: in_place(points) < 1)
    assert_array_equal(error.points, field.samples.points)
    points = slices.plane(WALLED, axis=2, at=0.5, n=3)[0]

    def flux(x):
        x *= 0.0
        return x

    picture = slices.on_plane(field, axis=2, at=0.5, n=3, flux_at=flux)
    assert picture.flux.max() == 0.0
    assert_array_equal(slices.plane(WALLED, axis=2, at=0.5, n=3)[0], points)


@pytest.mark.parametrize("method", [by_dem, by_fem])
@pytest.mark.parametrize("flux", [False, True])
def test_a_function_of_time_that_fails_is_named(method, flux):
    def load(time):
        return 1.0 if time < 1e-4 else 1.0 / 0.0

    scene = cooling(0.0, {"x-": 0.0, "y+": Flux(load) if flux else load})
    with pytest.raises(
        ValueError, match=r"Scene.walls\['y\+'\] at 0?.*s: the function raises ZeroDivisionError"
    ) as caught:
        method(scene)
    assert isinstance(caught.value.__cause__, ZeroDivisionError)


@pytest.mark.parametrize("method", [by_dem, by_fem])
def test_an_initial_temperature_that_fails_is_named(method):
    with pytest.raises(ValueError, match="Scene.initial: the function raises IndexError") as caught:
        method(cooling(lambda x: x[:, 7]))
    assert isinstance(caught.value.__cause__, IndexError)


SOLVED = {
    "dem": lambda: demheat.solve(WALLED, packing=crystal()),
    "exact": lambda: exact.solve(WALLED, points_per_axis=3),
}


@pytest.mark.parametrize("method", SOLVED)
def test_what_a_field_hands_out_cannot_be_written_to(method):
    """`field.samples.points *= 1000` made later temperatures wrong by thousands."""
    field = SOLVED[method]()
    at = np.random.default_rng(0).random((20, 3))
    arrays = [*field.samples, field.mean_flux, field.fractions]
    for array in arrays:
        with pytest.raises(ValueError, match="read-only"):
            array *= 1000
    for mapping in (field.wall_temperature, field.wall_heat, field.stats, field.scene.walls):
        with pytest.raises(TypeError, match="read-only"):
            mapping["x-"] = 1000.0
    assert abs(field.temperature_at(at) - at[:, 0]).max() < 0.02  # the crystal's cells are exact for a linear field
    field.temperature_at(at)[:] = 7.0
    assert field.temperature_at(at).max() < 1.0


def test_a_field_keeps_copies_of_what_it_is_given():
    given = {"x-": 0.0, "x+": 1.0}
    flux, scene = np.array([-1.0, 0.0, 0.0]), Scene((1, 1, 1), METAL, walls=given)
    field = demheat.Field(scene, flux, np.ones(1), None, None, None, wall_temperature=given)
    flux[0], given["x+"] = 5.0, 9.0
    assert field.conductivity == 1.0 and scene.walls["x+"] == 1.0


def test_read_only():
    mapping = ReadOnly({"a": 1})
    for change in (
        lambda: mapping.update(a=2),
        lambda: mapping.pop("a"),
        lambda: mapping.setdefault("b", 1),
        lambda: mapping.clear(),
        lambda: mapping.popitem(),
        lambda: mapping.__delitem__("a"),
        lambda: mapping.__ior__({"b": 1}),
    ):
        with pytest.raises(TypeError, match="read-only"):
            change()
    assert mapping == {"a": 1} and type(mapping | {"b": 2}) is dict
    for twin in (pickle.loads(pickle.dumps(mapping)), copy.deepcopy(mapping), copy.copy(mapping)):
        assert twin == mapping and type(twin) is ReadOnly
    assert pickle.loads(pickle.dumps(WALLED)) == WALLED
    array = np.zeros(3)
    with pytest.raises(ValueError, match="read-only"):
        read_only(array)[0] = 1.0
    array[0] = 1.0  # its owner may


def test_a_sphere_with_another_geometry_is_refused():
    """One method asked its `contains`, another read its radius."""
    with pytest.raises(TypeError, match="class Half changes contains of Sphere"):

        class Half(Sphere):
            def contains(self, points, *, period=None):
                return super().contains(points, period=period) & (points[:, 0] < 0.5)

    with pytest.raises(TypeError, match="class Thick changes bounds, distance of Layer"):

        class Thick(Layer):
            def distance(self, points, *, period=None):
                return 0.0

            def bounds(self):
                return 0.0

    class Named(Sphere):
        """What adds to a shape may."""

        name = "mine"

    ball = Named((0.5, 0.5, 0.5), 0.2, METAL)
    assert ball.name == "mine" and issubclass(Named, Shape)


@pytest.mark.parametrize("domain", ["cylinder-z", "sphere"])
def test_inclusions_outside_a_round_body(domain):
    out = Sphere((0.05, 0.05, 0.5), 0.04, METAL)
    with pytest.raises(ValueError, match=r"Scene.inclusions\[1\]: .* lies outside the " + domain):
        Scene((1, 1, 1), METAL, [Sphere((0.5, 0.5, 0.5), 0.1, METAL), out], domain=domain, initial=0.0)
    # Cut by the round wall.
    Scene((1, 1, 1), METAL, [Sphere((0.05, 0.5, 0.5), 0.1, METAL)], domain=domain, initial=0.0)


def source(start, velocity=(0.0, 0.0)):
    return MovingCylinder(2, 0.2, 1.0, start, velocity, clip=True)


@pytest.mark.parametrize("domain", ["box", "cylinder-z"])
def test_sources_that_never_meet_the_body(domain):
    body = {"size": (1, 1, 1), "matrix": METAL, "initial": 0.0, "domain": domain}
    for lost in (source((2, 0.5)), source((2, 0.5), (1, 0)), source((2, 2), (-1, 0)), source((-3, 0.5), (0, 9))):
        with pytest.raises(ValueError, match=r"Scene.sources\[1\] = .*: after time 0 never meets the " + domain):
            Scene(sources=[source((0.5, 0.5)), lost], **body)
    for met in (source((2, 0.5), (-1, 0)), source((-0.05, 0.5)), source((0.5, 0.5), (9, 0))):
        Scene(sources=[met], **body)
