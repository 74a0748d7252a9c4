"""Only here: labels of an image that lie in other voxels, or images that nobody can tell apart."""

import pickle
from dataclasses import replace

import numpy as np
import pytest

from demheat import Image, Layer, Material, Scene
from demheat.scene import image as module
from references import bounds, bracket, exact, fft, multipole, zeta

GOOD, POOR, PORE = Material(10.0), Material(1.0), Material(0.0)


def drawn(shape=(4, 5, 6), labels=(0, 1), seed=0):
    return np.random.default_rng(seed).choice(labels, shape)


def test_an_image_is_a_body():
    labels = drawn(labels=(3, -2, 700))
    image = Image(labels, (1.0, 2.0, 0.5), {700: GOOD, -2: PORE, 3: POOR, 9: GOOD})
    assert image.size == (4.0, 10.0, 3.0) and image.shape == (4, 5, 6)
    # In ascending order of the labels that there are.
    assert list(image.materials) == [-2, 3, 700] and image.phases == (PORE, POOR, GOOD)
    assert image.labels.dtype == np.int16 and image.phase.dtype == np.uint8
    assert np.array_equal(image.phase, np.searchsorted([-2, 3, 700], labels))
    assert image.fractions.tolist() == [np.mean(labels == each) for each in (-2, 3, 700)]
    scene = Scene.of_image(image, gradient=(1, 0, 0))
    assert scene.materials == image.phases and scene.size == image.size
    assert scene.resistances.tolist() == [0.0] * 3 and scene.images() == []


def test_what_is_kept_cannot_be_changed():
    labels = drawn()
    image = Image(labels, 1.0, {0: POOR, 1: GOOD})
    labels[:] = 7
    assert image.labels.max() == 1 and image.labels.dtype == np.uint8
    with pytest.raises(ValueError, match="read-only"):
        image.labels[0] = 1


@pytest.mark.parametrize("slab", [1, 40, 10**6])
def test_slabs_make_no_difference(monkeypatch, slab):
    labels = drawn((7, 3, 5), labels=(0, 2, 1000))
    materials = {0: POOR, 2: GOOD, 1000: PORE}
    whole = Image(labels, 1.0, materials)
    monkeypatch.setattr(module, "SLAB", slab)
    parted = Image(labels, 1.0, materials)
    assert parted == whole and parted.digest == whole.digest
    assert np.array_equal(parted.phase, whole.phase) and np.array_equal(parted.fractions, whole.fractions)


def test_phases_lie_in_their_voxels():
    labels = drawn()
    spacing = np.array([1e-3, 2e-3, 5e-4])
    image = Image(labels, tuple(spacing), {0: POOR, 1: GOOD})
    points = np.random.default_rng(1).random((500, 3)) * image.size
    expected = labels[tuple((points // spacing).astype(int).T)]
    periodic, walled = (Scene.of_image(image, **load) for load in ({"gradient": (1, 0, 0)}, {"walls": {"x-": 1.0}}))
    for scene in (periodic, walled):
        assert np.array_equal(scene.phase_at(points), expected)
    # Repeated all round; on an upper wall, and rounding beyond it, the last voxel.
    shifted = points + np.array([1, -2, 3]) * image.size
    assert np.array_equal(periodic.phase_at(shifted), expected)
    assert walled.phase_at(np.array([image.size]) * (1 + 1e-12)) == labels[-1, -1, -1]


def test_equal_images_are_equal():
    one, same = (Image(drawn(), 1.0, {0: POOR, 1: GOOD}) for _ in range(2))
    assert one == same and one.digest == same.digest and hash(one) == hash(same)
    others = [replace(one, voxel=2.0), replace(one, materials={0: GOOD, 1: GOOD}), replace(one, labels=1 - one.labels)]
    assert all(one != other for other in others) and one != "image"
    assert one.digest != others[-1].digest
    assert Scene.of_image(one, gradient=(1, 0, 0)) == pickle.loads(
        pickle.dumps(Scene.of_image(same, gradient=(1, 0, 0)))
    )


def test_a_turned_image():
    image = Image(drawn(), (1.0, 2.0, 3.0), {0: POOR, 1: GOOD})
    turned = image.turned((2, 0, 1))
    assert turned.voxel == (3.0, 1.0, 2.0) and turned.shape == (6, 4, 5)
    assert turned.labels[5, 2, 3] == image.labels[2, 3, 5]


@pytest.mark.parametrize(
    "change, words",
    [
        ({"labels": np.zeros((2, 2, 2))}, "labels of type float64: must be whole numbers"),
        # As int64 it would be a label below zero.
        ({"labels": np.full((2, 2, 2), 2**63 + 5, np.uint64)}, "9223372036854775813 is the largest; must be at most"),
        ({"labels": np.zeros((2, 0, 2), int)}, "labels of shape (2, 0, 2): must be (nx, ny, nz), of one voxel or more"),
        ({"labels": [[[0, 1]], [[0]]]}, "rows of unlike lengths"),
        (
            {"labels": np.arange(27).reshape(3, 3, 3)},
            "one for each; grey values ask for a threshold first, such as threshold = 13, from which on",
        ),
        ({"labels": np.arange(41**3).reshape(41, 41, 41)}, "68921 different ones; must be at most 65536"),
        ({"voxel": 0.0}, "Image.voxel = 0.0: all edges must be > 0 m"),
        ({"voxel": 1e300}, "sides of the image must be from 1e-50 to 1e+50 m"),
        ({"materials": {0: POOR, 1: 5.0}}, "materials[1] = 5.0: must be a Material"),
        ({"materials": {0: POOR, "1": GOOD}}, "label '1' must be a whole number"),
    ],
)
def test_bad_images(change, words):
    with pytest.raises(ValueError) as caught:
        Image(**{"labels": drawn((2, 2, 2)), "voxel": 1.0, "materials": {0: POOR, 1: GOOD}} | change)
    told = str(caught.value)
    assert words in told and told.startswith("Image.") and "\n" not in told


IMAGE = Image(drawn(), 0.25, {0: POOR, 1: GOOD})
CUBE = Image(drawn((3, 3, 3)), 1.0, {0: POOR, 1: GOOD})
LOAD = {"gradient": (1.0, 0.0, 0.0)}


@pytest.mark.parametrize(
    "make, words",
    [
        (lambda: Scene.of_image(drawn(), **LOAD), "must be an Image"),
        (lambda: Scene(IMAGE.size, POOR, image=drawn(), **LOAD), "must be an Image or None"),
        (lambda: Scene((1, 1, 1), POOR, image=IMAGE, **LOAD), "must be those of the image"),
        (lambda: Scene(IMAGE.size, Material(7.0), image=IMAGE, **LOAD), "must be those of the image"),
        (lambda: Scene(IMAGE.size, POOR, [Layer(0, 0, 0.5, GOOD)], image=IMAGE, **LOAD), "Scene.inclusions: with an"),
        (
            lambda: Scene(CUBE.size, CUBE.phases[0], image=CUBE, walls={"x-": 1.0}, initial=0.0, domain="sphere"),
            "domain = 'sphere': with",
        ),
        (lambda: Scene.of_image(IMAGE), "neither given"),
        (lambda: fft.solve(Scene.of_image(IMAGE, **LOAD), voxels=16), "must be those of the image, (4, 5, 6)"),
        (lambda: bracket.voxels.solve(Scene.of_image(IMAGE, **LOAD), voxels=(4, 5, 5)), "must be those of the image"),
    ],
)
def test_bad_scenes(make, words):
    with pytest.raises(ValueError) as caught:
        make()
    assert words in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "solve",
    [exact.solve, multipole.solve, bounds.estimate, bracket.solve, zeta.zeta2],
    ids=lambda each: f"{each.__module__}.{each.__name__}",
)
def test_what_cannot_take_an_image_says_so(solve):
    with pytest.raises(NotImplementedError, match="^Scene.image: .*images are for FFT, finite elements") as caught:
        solve(Scene.of_image(IMAGE, **LOAD))
    assert "\n" not in str(caught.value)


def test_a_plot_of_an_image():
    figure = Scene.of_image(IMAGE, **LOAD).plot(pixels=12)
    assert [axes.get_title() for axes in figure.axes[:3]] == ["x = 0.5 m", "y = 0.625 m", "z = 0.75 m"]
