"""Conductivities that differ with direction, or follow the temperature: which method takes them, all others say so."""

from functools import partial

import numpy as np
import pytest
from method_scenes import METHODS, allowed, answered
from numpy.testing import assert_allclose
from spared import slow_but

import demheat
from demheat import Dependence, Layer, Material, Scene, Sphere, dem, orthotropic
from demheat.conduction.steady import solve_steady
from demheat.dem.networks import network_of
from demheat.laws import Laguerre
from demheat.scene.negligible import negligible
from demheat.scene.symmetry import reduced
from demheat.terminal.commands.bounds import bounds_of
from references import bracket, exact, fem, fft, multipole, zeta

TENSOR = orthotropic(1, 2, 4, rotation=(0.0, 0.5, 0.0))
RISING = Dependence.linear(0.01, 0.0, (0.0, 100.0))
WALLS = {"y-": 20.0, "y+": 50.0}
TENSORS = ("fem", "fem-straight", "fem-p1", "exact", "fft", "fft-plain")
VARYING = ("dem", "fem", "fem-straight", "fem-p1", "exact")


def bent(**load):
    """Layers of tensors turned about their normal's axis alone: heat across them runs straight."""
    return Scene((1.0, 1.0, 1.0), Material(TENSOR), [Layer(1, 0.25, 0.5, Material(5.0))], **(load or {"walls": WALLS}))


def warm(**load):
    own = Material(2.0, dependence=RISING)
    return Scene(
        (1.0, 1.0, 1.0), own, [Layer(1, 0.25, 0.5, Material(5.0, dependence=RISING))], **(load or {"walls": WALLS})
    )


# Elements of other kinds stand on the same space.
@pytest.mark.parametrize("name", slow_but(METHODS.keys() - {"fem-p1", "fem-straight"}, METHODS))
@pytest.mark.parametrize(
    ("scene", "knowing", "words"),
    [
        (bent(), TENSORS, "Material.conductivity in phase 0 is a tensor"),
        (warm(), VARYING, "Material.dependence in phase 0"),
    ],
    ids=["tensor", "dependence"],
)
def test_every_method_takes_it_or_says_so(name, scene, knowing, words):
    if name in knowing:
        # Declared of scenes of the suite.
        found = answered(METHODS[name], scene).conductivity
        assert_allclose(found, exact.solve(scene).conductivity, rtol=allowed(name, least=1e-9))
        return
    with pytest.raises(NotImplementedError, match=words) as error:
        answered(METHODS[name], scene)
    assert "\n" not in str(error.value)


CELL = {"gradient": (1.0, 0.0, 0.0)}
# What the table of docs/scenes.md and the methods above do not ask.
REFUSING = {
    "axes of the dem": lambda scene, _: dem.solve_axes(scene, particles=1000, law="platonic"),
    "network": lambda scene, _: solve_steady(None, scene),
    "negligible": lambda scene, _: negligible(scene, 1e-3),
    "reduced": lambda scene, _: reduced(scene),
    "bricks": lambda _, heated: list(fem.evolve(heated, [1.0], elements="hexahedra")),
}


@pytest.mark.parametrize("what", REFUSING)
@pytest.mark.parametrize("which", ["tensor", "dependence"])
def test_what_cannot_says_so(what, which):
    extra = {"conductivity": TENSOR} if which == "tensor" else {"conductivity": 2.0, "dependence": RISING}
    own = Material(**extra, density=1.0, heat_capacity=1.0)
    ball = Sphere((0.5, 0.5, 0.5), 0.2, Material(5.0, 1.0, 1.0))
    scene, heated = (
        Scene((1.0, 1.0, 1.0), own, shapes, walls=WALLS, **more)
        for shapes, more in (([ball], {}), ([], {"initial": 0.0}))
    )
    words = "is a tensor" if which == "tensor" else "Material.dependence in phase 0"
    with pytest.raises(NotImplementedError, match=words) as error:
        REFUSING[what](scene, heated)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    "call",
    [
        partial(bracket.solve_tensor),
        partial(zeta.zeta2, voxels=8),
        multipole.zeta2,
        lambda scene: network_of(scene, None, Laguerre()),
    ],
)
def test_cells_of_tensors_are_refused(call):
    scene = Scene((1.0, 1.0, 1.0), Material(TENSOR), [Sphere((0.5,) * 3, 0.2, Material(5.0))], **CELL)
    with pytest.raises(NotImplementedError, match="Material.conductivity in phase 0 is a tensor"):
        call(scene)


def test_the_dem_says_why():
    with pytest.raises(
        NotImplementedError, match="two particles tell the flux through their facet only where its normal"
    ):
        demheat.solve(bent(), particles=1000)


@pytest.mark.slow
def test_between_walls_elements_and_voxels_agree():
    """A turned tensor alone: insulated sides bend the flux, edges of the walls are singular; both share nothing."""
    own = orthotropic(1, 4, 9, rotation=(0.3, -0.5, 0.8))
    scene = Scene((1.0, 1.2, 0.8), Material(own), walls={"y-": 1.0, "y+": 3.0})
    one, other = fem.solve(scene, size=0.25), fft.solve(scene, voxels=12)
    # The edges cost elements .4 to .9 % at edges of .15 to .3, voxels a tenth of that.
    assert_allclose(one.conductivity, other.conductivity, rtol=0.01)
    assert one.error.lower <= other.error.upper and other.error.lower <= one.error.upper
    assert one.conductivity < np.array(own)[1, 1]
    points = np.random.default_rng(0).random((50, 3)) * scene.size
    assert np.sqrt(np.mean((one.temperature_at(points) - other.temperature_at(points)) ** 2)) < 0.01
    # No heat leaves through the sides.
    sides = points.copy()
    sides[:, 0] = 0.0
    across = np.abs(one.flux_at(sides)[:, 0]).mean() / np.abs(one.mean_flux[1])
    assert across < 0.1 and abs(np.array(own)[0, 1] / np.array(own)[1, 1]) > 0.1


def test_no_bounds_are_claimed():
    assert bounds_of(bent()) == [] and bounds_of(warm()) == []
