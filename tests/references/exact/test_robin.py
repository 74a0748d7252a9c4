"""Slabs whose faces exchange heat, in time: against the series of held and insulated faces, and against themselves."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import Convection, Flux, Material, Scene, UniformSource
from references import series
from references.exact.responses import response
from references.exact.robin import EARLIEST, Face, roots, settled, slab

X = np.linspace(0.0, 1.0, 21)
METAL = Material(2.0, 3.0, 4.0)
INSULATED, HELD = Face(0.0, 0.0, 0.0), Face(math.inf, 0.0, 0.0)


@pytest.mark.parametrize("biot", [1e-10, 0.1, 1.0, 100.0, 1e8])
def test_roots_of_one_biot_number(biot):
    m = roots(Face(biot, 0.0, 0.0), INSULATED, 30)
    # Carslaw and Jaeger's m tan m = B, written without the poles; rounding of m.
    assert_allclose(m * np.sin(m) - biot * np.cos(m), 0.0, atol=1e-13 * (biot + m[-1]))
    assert np.all((m > np.pi * np.arange(30)) & (m < np.pi * (np.arange(30) + 0.5)))


def test_known_roots():
    """Carslaw and Jaeger, appendix IV, table I: of m tan m = 1."""
    assert_allclose(roots(Face(1.0, 0.0, 0.0), INSULATED, 3), [0.8603, 3.4256, 6.4373], atol=5e-5)
    # Alike at both faces: half the slab is one with the other face insulated.
    both = roots(Face(2.0, 0.0, 0.0), Face(2.0, 0.0, 0.0), 5)
    assert_allclose(both[::2] / 2, roots(Face(1.0, 0.0, 0.0), INSULATED, 3), rtol=1e-14)


@pytest.mark.parametrize("fourier", [1e-4, 0.01, 0.3, 5.0])
@pytest.mark.parametrize(("drive", "far"), [("temperature", "held"), ("temperature", "insulated"), ("flux", "held")])
def test_without_films_it_is_the_known_series(drive, far, fourier):
    near = Face(math.inf, 1.0, 0.0) if drive == "temperature" else Face(0.0, 0.0, 1.0)
    for found, right in zip(
        slab(X, fourier, near, HELD if far == "held" else INSULATED, 0.0), response(X, fourier, drive, far), strict=True
    ):
        # Rounding of some hundred terms of up to a hundred.
        assert_allclose(found, right, atol=1e-12)


def residuals(near, far, heating, fourier):
    """What equation and faces lack, by differences."""
    h, dt = 1e-3, 1e-4 * fourier
    x = np.array([0.3 - h, 0.3, 0.3 + h])
    below, here, above = (slab(x, fourier + k * dt, near, far, heating)[0] for k in (-1, 0, 1))
    equation = (above[1] - below[1]) / (2 * dt) - (here[0] - 2 * here[1] + here[2]) / h**2 - heating
    (first, last), (up, down) = slab(np.array([0.0, 1.0]), fourier, near, far, heating)
    return (
        equation,
        up - near.biot * (first - near.outside) + near.flux,
        down + far.biot * (last - far.outside) - far.flux,
    )


@pytest.mark.parametrize("fourier", [0.01, 0.2])
@pytest.mark.parametrize(
    "faces", [(Face(3.0, 2.0, 0.0), Face(0.5, -1.0, 0.0)), (Face(0.0, 0.0, 0.7), Face(5.0, 1.0, 0.0))]
)
def test_the_equation_and_its_faces(faces, fourier):
    equation, near, far = residuals(*faces, 1.5, fourier)
    # Differences of h = 1e-3, of fourth derivatives of about 1/fourier^2 and less; the faces are exact.
    assert abs(equation) < 2e-2 and abs(near) < 1e-11 and abs(far) < 1e-11


def test_it_starts_at_rest_and_settles():
    faces = Face(3.0, 2.0, 0.0), Face(0.5, -1.0, 0.0)
    # Away from the faces nothing has come by then: erfc(.3 / (2 sqrt(1e-4))) < 1e-90.
    assert_allclose(slab(np.array([0.3, 0.7]), 1e-4, *faces, 0.0)[0], 0.0, atol=1e-13)
    assert_allclose(slab(X, 100.0, *faces, 1.5)[0], settled(X, *faces, 1.5)[0], atol=1e-13)


def test_a_scene_with_convection():
    scene = Scene(
        (1.5, 1.0, 2.0),
        METAL,
        walls={"x-": Convection(4.0, 50.0), "x+": 20.0},
        initial=10.0,
        sources=[UniformSource(7.0)],
    )
    first, then, end = series.evolve(scene, [0.0, 2.0, 2000.0], points_per_axis=2)
    assert first.wall_heat["x-"] == 4.0 * 40.0 * 2.0 and first.temperature_at([0.5, 0.5, 0.5]) == 10.0
    assert then.stats["series"] == "modes"
    assert_allclose(then.wall_heat["x-"], 4.0 * 2.0 * (50.0 - then.wall_temperature["x-"]), rtol=1e-14)
    assert_allclose(then.flux_at([0.0, 0.5, 0.5])[0, 0] * 2.0, then.wall_heat["x-"], rtol=1e-11)
    # In the end what comes in and is made goes out: resistances in series, half of the source each way and more.
    assert_allclose(sum(end.wall_heat.values()) + 7.0 * 3.0, 0.0, atol=1e-11)
    assert_allclose(end.wall_heat["x-"] / 2.0, (30.0 - 7.0 * 1.5**2 / 4.0) / (1 / 4.0 + 1.5 / 2.0), rtol=1e-11)


def test_a_slab_turned_round():
    here, there = ({"y" + side: Convection(4.0, 50.0), "y" + other: Flux(3.0)} for side, other in ("-+", "+-"))
    one, other = (
        next(series.evolve(Scene((1, 1, 1), METAL, walls=walls, initial=10.0), [0.7])) for walls in (here, there)
    )
    points = np.random.default_rng(0).random((20, 3))
    turned = points * [1, -1, 1] + [0, 1, 0]
    assert_allclose(one.temperature_at(points), other.temperature_at(turned), atol=1e-12)


def test_what_has_no_series():
    scene = Scene((1, 1, 1), METAL, walls={"x-": Convection(4.0, 50.0)}, initial=10.0)
    with pytest.raises(NotImplementedError, match="too many modes"):
        list(series.evolve(scene, [1e-9 * EARLIEST]))
    ball = Scene((1, 1, 1), METAL, walls={"round": Convection(4.0, 50.0)}, initial=10.0, domain="sphere")
    with pytest.raises(NotImplementedError, match="convection at a round wall"):
        list(series.evolve(ball, [1.0]))
