"""Only here: what `evolve` takes or refuses of good values that do not go together, and of users' functions."""

import re
from dataclasses import replace

import numpy as np
import pytest
from transient_scenes import BOX, METAL, SLAB, last

from demheat import Flux, Material, Scene, Sphere, evolve
from demheat.packing.base import make_packing


def scattered(size, periodic):
    """A packing of a size that is not the scene's: tests are collected by each worker, which must not compile then."""
    centers = np.random.default_rng(0).random((100, 3)) * size
    return make_packing(centers, np.full(100, 1e-3), size, periodic, {})


BAD = [
    *(({"times": odd}, "times = ") for odd in ((t for t in [0.1]), [[0.1], [0.2, 0.3]])),
    ({"accuracy": 1.0}, "accuracy = 1.0"),
    ({"particles": 50}, "particles = 50"),
    ({"packing": scattered((0.1, 0.1, 0.2), periodic=False)}, "packing of size"),
    ({"packing": scattered(BOX, periodic=True)}, "packing of size"),
]


@pytest.mark.parametrize(("change", "words"), BAD)
def test_bad_input_before_any_work(change, words):
    knobs = {"times": [0.1]} | change
    with pytest.raises(ValueError, match=re.escape(words)):
        evolve(SLAB, knobs.pop("times"), **knobs)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"initial": None}, "Scene.initial = None"),
        ({"matrix": Material(1.0, density=1.0)}, "Material.heat_capacity = None"),
        ({"matrix": Material(1.0, heat_capacity=1.0)}, "Material.density = None"),
    ],
)
def test_scenes_that_lack_something(change, words):
    with pytest.raises(ValueError, match=re.escape(words)):
        evolve(replace(SLAB, **change), [0.1])


def test_numbers_of_other_types():
    knobs = {"step": np.float32(0.01), "accuracy": np.float64(1e-3), "integrator": "rkl2", "particles": np.int64(300)}
    (field,) = evolve(SLAB, np.array([1], dtype=np.int32), **knobs, conforming=np.bool_(False))
    # Of a hundredth; 32 bits hold it to 2e-8 from below, which takes no step more.
    assert field.time == 1.0 and 100 <= field.stats["steps"] <= 101
    assert next(iter(evolve(SLAB, range(1, 3), particles=300, step=np.int64(1), integrator="tr-bdf2"))).time == 1.0


@pytest.mark.parametrize("load", [lambda t: float("nan"), Flux(lambda t: "a")])
def test_a_load_that_is_no_number_names_wall_and_time(load):
    with pytest.raises(ValueError, match=re.escape("Scene.walls['y+'] at 0.0 s")):
        evolve(Scene(size=BOX, matrix=METAL, walls={"y+": load}, initial=25.0), [0.1])
    late = Scene(size=BOX, matrix=METAL, walls={"y+": lambda t: 1.0 if t < 0.05 else float("nan")}, initial=25.0)
    with pytest.raises(ValueError, match=re.escape("Scene.walls['y+'] at 0.05")):
        last(late, [0.1], particles=300)


@pytest.mark.parametrize(
    ("initial", "words"),
    [
        (lambda x: x, "Scene.initial: gives shape (3, 3) of float64"),
        (lambda x: x[:, 0] + 1j, "Scene.initial: gives shape (3,) of complex128"),
        (lambda x: x[:, 0] * np.nan, "Scene.initial = nan at [0.05, 0.05, 0.05] m: must be finite"),
    ],
)
def test_an_initial_temperature_that_is_no_number(initial, words):
    with pytest.raises(ValueError, match=re.escape(words)):
        evolve(Scene(size=BOX, matrix=METAL, walls={}, initial=initial), [0.1])


def test_what_is_not_supported_says_why():
    sphere = Scene(size=BOX, matrix=METAL, domain="sphere", walls={"round": 200.0}, initial=20.0)
    drum = replace(sphere, domain="cylinder-y")
    with pytest.raises(NotImplementedError, match="flat walls and that of a sphere"):
        evolve(drum, [1.0], law="calibrated", wall="surface")
    ball = Sphere((0.05, 0.05, 0.05), 0.01, METAL)
    with pytest.raises(NotImplementedError, match="conforming"):
        evolve(replace(sphere, inclusions=[ball]), [1.0])
    with pytest.raises(NotImplementedError, match="two held walls meet|held walls meet"):
        corner = Scene(size=BOX, matrix=METAL, walls={"x-": 1.0, "y-": 2.0}, initial=25.0)
        evolve(corner, [1.0], law="calibrated")
