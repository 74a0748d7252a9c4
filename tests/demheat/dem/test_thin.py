"""Only here: what is too thin for particles or voxels and nobody is told of, or told of in vain."""

import warnings

import numpy as np
import pytest
from numpy.testing import assert_allclose

import demheat
from demheat import Layer, Material, Scene, Sphere
from demheat.packing import make_packing
from demheat.scene.volumes import coats, extents
from references import fft

METAL, OTHER = Material(1.0), Material(5.0)
CUBE = {"size": (1.0, 1.0, 1.0), "matrix": METAL}


def crystal(number=6, periodic=True):
    x = (np.arange(number) + 0.5) / number
    sites = np.stack(np.meshgrid(x, x, x, indexing="ij"), axis=-1).reshape(-1, 3)
    return make_packing(sites, np.full(number**3, 0.5 / number), (1, 1, 1), periodic, {})


def cell(*inclusions):
    return Scene(**CUBE, inclusions=inclusions, gradient=(1.0, 0.0, 0.0))


def ball(radius, center=(0.5, 0.5, 0.5)):
    return Sphere(center, radius, OTHER)


def test_extents_and_coats():
    scene = cell(
        Layer(0, 0.0, 0.4, OTHER), Layer(0, 0.1, 0.3, METAL), ball(0.2, (0.7, 0.5, 0.5)), ball(0.15, (0.72, 0.5, 0.5))
    )
    assert_allclose(extents(scene), [0.4, 0.2, 0.4, 0.3])
    # The widest place of the coat is on the far side.
    assert_allclose(coats(scene), [0.1, np.inf, 0.07, np.inf])
    assert len(extents(cell())) == len(coats(cell())) == 0


def test_coats_by_the_nearest_image():
    scene = cell(ball(0.2, (0.0, 0.5, 1.0)), ball(0.19, (1.0, 0.5, 0.0)))
    assert_allclose(coats(scene), [0.01, np.inf])
    walled = Scene(
        **CUBE, inclusions=[ball(0.2, (0.0, 0.5, 0.5)), ball(0.1, (0.0, 0.5, 0.5))], walls={"x-": 0.0, "x+": 1.0}
    )
    assert_allclose(coats(walled), [0.1, np.inf])


@pytest.mark.parametrize("knobs", [{"conforming": False}, {"law": "platonic", "gap": 0.1}])
@pytest.mark.parametrize(
    "inclusions",
    [
        (Layer(0, 0.4, 0.6, OTHER),),
        (ball(0.1, (0.4167, 0.4167, 0.4167)),),
        (ball(0.44), ball(0.4)),
    ],
)
def test_the_dem_without_twins_says_so(inclusions, knobs):
    with pytest.warns(UserWarning, match=r"inclusions \[0\] are thin for particles of diameter 0.167 m"):
        demheat.solve(cell(*inclusions), packing=crystal(), **knobs)


def test_a_layer_that_cells_see_sixteen_times_too_thick_has_no_answer():
    """One plane of centres lies in it."""
    layer = Layer(0, 0.41, 0.42, Material(1e-3))
    with pytest.warns(UserWarning, match="thin for"), pytest.raises(RuntimeError, match="a surface is not where"):
        demheat.solve(cell(layer), packing=crystal(), conforming=False)


@pytest.mark.parametrize(("core", "told"), [(40.0, False), (60.0, True), (0.6, False), (0.4, True)])
def test_coats_unlike_their_cores_are_told(core, told):
    """A coat of .12, of conductivity 5, for particles of .167."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        scene = cell(ball(0.4), Sphere((0.5, 0.5, 0.5), 0.28, Material(core)))
        demheat.solve(scene, packing=crystal(), conforming=False)
    assert ["inclusions [0] are thin for particles" in str(each.message) for each in caught] == [True] * told


@pytest.mark.parametrize("law", [{"conforming": False}])
@pytest.mark.parametrize(
    ("gap", "contrast", "told"),
    [(0.1, 1e3, True), (0.149, 1e3, True), (0.151, 1e3, False), (0.149, 7.5, True), (0.149, 6.5, False)],
)
def test_short_cuts_without_twins_are_told(law, gap, contrast, told):
    """Particles of diameter .1 on either side of a gap below one and a half of them, between good conductors."""
    pair = [Sphere((x, 0.5, 0.5), 0.15, Material(contrast)) for x in (0.35 - gap / 2, 0.65 + gap / 2)]
    scene = Scene(**CUBE, inclusions=pair, walls={"y-": 0.0, "y+": 1.0})
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        demheat.solve(scene, packing=crystal(10, periodic=False), **law)
    said = [str(each.message) for each in caught]
    assert [words for words in said if "gaps beside inclusions [0, 1]" in words] == (said if told else [])
    assert bool(said) == told


@pytest.mark.parametrize("rule", ["plain", "laminate", "links"])
@pytest.mark.parametrize(("voxels", "told"), [(23, True), (24, False), (9, True)])
def test_gaps_narrower_than_a_voxel_are_told(rule, voxels, told):
    """A gap of .06 is less than 1.4 of 12 or 23 voxels, or than two of fewer than ten, but more than 1.4 of 24."""
    pair = [Sphere((x, 0.5, 0.5), 0.2, Material(30.0)) for x in (0.27, 0.73)]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        fft.solve(cell(*pair), voxels=voxels, rule=rule)
    assert ["gaps beside inclusions [0, 1]" in str(each.message) for each in caught] == [True] * told
    if voxels < 10:
        weak = [Sphere(each.center, 0.2, Material(2.5)) for each in pair]
        with pytest.warns(UserWarning, match="gaps beside"):
            fft.solve(cell(*weak), voxels=voxels, rule=rule)
    # Laminates are exact for layers.
    if rule == "laminate":
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            layers = [Layer(0, *ends, Material(30.0)) for ends in ((0.1, 0.4), (0.41, 0.7))]
            fft.solve(cell(*layers), voxels=voxels, rule=rule)


def test_twins_and_thick_inclusions_are_not_warned_of():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        demheat.solve(cell(Layer(0, 0.3, 0.6, OTHER)), packing=crystal(), conforming=False)
        demheat.solve(cell(ball(0.4), ball(0.25)), packing=crystal(), conforming=False)
        demheat.solve(cell(Layer(0, 0.41, 0.5, OTHER)), packing=crystal())


def test_many_more_twins_than_particles():
    """A gap of a fourth of a particle, of uneven width, is followed by twins as close as that."""
    with pytest.warns(UserWarning, match=r"^[0-9]+ twins at interfaces, .* stand beside 216 particles: memory"):
        field = demheat.solve(cell(ball(0.4), Sphere((0.501, 0.5, 0.5), 0.379, OTHER)), packing=crystal())
    assert field.stats["unknowns"] > 6 * 216


def test_layers_that_a_laminate_does_not_see():
    """Thinner than a billionth of a voxel, but with all the resistance."""
    foil = Layer(0, 0.5, 0.5 + 1e-11, demheat.Material(1e-10))
    with pytest.warns(UserWarning, match=r"inclusions \[0\] are smaller than a voxel .* misses layers"):
        fft.solve(cell(foil), voxels=8)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        fft.solve(cell(Layer(0, 0.5, 0.5 + 1e-6, demheat.Material(1e-6))), voxels=8)


@pytest.mark.filterwarnings("ignore:gaps beside inclusions")
def test_coats_thinner_than_a_voxel():
    """A coat that nothing outside notices was 2 % off."""
    words = r"inclusions \[0\] are coats thinner than a voxel of 0.125 m, down to 0.1 m: errors may be percents"
    with pytest.warns(UserWarning, match=words):
        fft.solve(cell(ball(0.4), ball(0.3)), voxels=8)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        fft.solve(cell(ball(0.4), ball(0.3)), voxels=12)
    # Of no conductivity it should stop all that would pass the ball in it.
    stopped = Layer(0, 0.2, 0.8, demheat.Material(0.0))
    with pytest.warns(UserWarning, match="heat leaks through and the conductivity may be off many times"):
        fft.solve(cell(stopped, ball(0.29)), voxels=8)
