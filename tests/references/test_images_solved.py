"""Images by voxels and elements: exact laminates, certain bounds, turned images, pores, edges."""

from itertools import product

import numpy as np
import pytest

from demheat import Image, Material, Scene
from demheat.tensor import conductivity_tensor
from references import bracket, fem, fft
from references.voxels.links import links
from references.voxels.paint import voxelise

K = {0: Material(1.0), 3: Material(5.0), 7: Material(0.2)}
VOXEL = (1e-3, 2e-3, 0.5e-3)
# Tolerances of the solvers, of the flux: 1e-5 of fft in the energy norm, of which the conductivity has the square.
SOLVED = 1e-9
WAYS = {
    "fft": lambda scene: fft.solve(scene, tolerance=1e-8),
    "links": lambda scene: fft.solve(scene, rule="links", tolerance=1e-8),
    "eyre-milton": lambda scene: fft.solve(scene, scheme="eyre-milton", tolerance=1e-9),
    "fem": lambda scene: fem.solve(scene, tolerance=1e-11),
}


def drawn(shape=(5, 6, 7), labels=(0, 3, 7), seed=3):
    return np.random.default_rng(seed).choice(labels, shape)


def periodic(labels, gradient=(0.0, 1.0, 0.0), voxel=VOXEL, materials=K):
    return Scene.of_image(Image(labels, voxel, materials), gradient=gradient)


def walled(labels, axis="y", voxel=VOXEL, materials=K):
    return Scene.of_image(Image(labels, voxel, materials), walls={axis + "-": 20.0, axis + "+": 30.0})


@pytest.mark.parametrize("name", WAYS)
@pytest.mark.parametrize("load", ["gradient", "walls"])
def test_a_laminate_is_exact(name, load):
    if name == "eyre-milton" and load == "walls":
        pytest.skip("along the walls its continuous operator knows a step between insulated ones by a series only")
    labels = np.zeros((4, 6, 5), int)
    labels[:, 2:4], labels[:, 5] = 3, 7
    k = np.array([K[label].conductivity for label in labels[0, :, 0]])
    for axis, expected in ((1, 1 / np.mean(1 / k)), (0, k.mean())):
        scene = periodic(labels, tuple(np.eye(3)[axis])) if load == "gradient" else walled(labels, "xyz"[axis])
        assert WAYS[name](scene).conductivity == pytest.approx(expected, rel=SOLVED)


# Links are differences, no energy of an admissible field: where every voxel is unlike its neighbours they are below.
@pytest.mark.parametrize("name", [name for name in WAYS if name != "links"])
@pytest.mark.parametrize("make", [periodic, walled])
def test_certain_bounds_hold_what_methods_find(name, make):
    """Trilinear elements attain the upper one: it is their energy."""
    labels = drawn()
    bound = bracket.voxels.solve(make(labels), tolerance=1e-8)
    found = WAYS[name](make(labels)).conductivity
    own = bound.upper if name == "fem" else found
    assert bound.lower <= found <= bound.upper * (1 + SOLVED)
    assert own == pytest.approx(found, rel=1e-6)  # the bound's own tolerance and what it gives up for rounding


def test_an_images_bounds_are_those_of_its_array():
    labels = drawn()
    values = np.vectorize(lambda label: K[label].conductivity)(labels)
    direct = bracket.voxels.bounds(values, VOXEL, gradient=(0, 1, 0))
    found = bracket.voxels.solve(periodic(labels))
    # In units of another power of two; nothing is rounded.
    assert (found.lower, found.upper) == pytest.approx((direct.lower, direct.upper), rel=1e-12)
    tensor = bracket.voxels.solve_tensor(periodic(labels))
    assert tensor.least[1, 1] <= direct.upper and direct.lower <= tensor.greatest[1, 1]


@pytest.mark.parametrize("solve_axes", [fft.solve_axes, fem.solve_axes])
def test_a_turned_image_has_the_turned_tensor(solve_axes):
    labels, order = drawn(), [2, 0, 1]
    image = Image(labels, VOXEL, K)
    tensors = [
        conductivity_tensor(solve_axes(Scene.of_image(each, gradient=(0, 1, 0)), tolerance=1e-10))
        for each in (image, image.turned(order))
    ]
    # Nine entries, none of them alike: an image of 210 random voxels is not isotropic.
    assert np.ptp(np.diag(tensors[0])) > 0.05
    np.testing.assert_allclose(tensors[1], tensors[0][np.ix_(order, order)], atol=1e-9 * tensors[0].max())
    np.testing.assert_allclose(tensors[0], tensors[0].T, atol=1e-8 * tensors[0].max())


@pytest.mark.parametrize("name", WAYS)
def test_fields_of_an_image(name):
    """Linear in a homogeneous one; samples that integrate to the mean flux, in their own voxels."""
    plain = WAYS[name](walled(np.zeros((3, 4, 5), int)))
    points = np.random.default_rng(0).random((40, 3)) * plain.scene.size
    np.testing.assert_allclose(plain.temperature_at(points), 20 + 10 * points[:, 1] / plain.scene.size[1], rtol=1e-9)
    np.testing.assert_allclose(plain.flux_at(points), [[0, -10 / plain.scene.size[1], 0]] * 40, atol=1e-4)
    field = WAYS[name](periodic(drawn()))
    samples = field.samples
    assert samples.volumes.sum() == pytest.approx(field.scene.volume)
    assert np.array_equal(samples.phase, field.scene.phase_at(samples.points))
    mean = samples.volumes @ samples.flux / field.scene.volume
    np.testing.assert_allclose(mean, field.mean_flux, atol=1e-6 * np.linalg.norm(mean))
    np.testing.assert_allclose(field.fractions, field.scene.image.fractions)
    moved = field.temperature_at(points + [0, field.scene.size[1], 0]) - field.temperature_at(points)
    np.testing.assert_allclose(moved, field.scene.size[1], rtol=1e-9)
    error = field.error
    assert error.lower < field.conductivity < error.upper and error.how == "voxels split in two"


def test_split_voxels_close_in_on_the_image():
    """Trilinear elements are too stiff: from above, and never below the certain lower bound."""
    scene = periodic(drawn((3, 4, 3)), voxel=1.0)
    found = [fem.solve(scene, size=1 / parts).conductivity for parts in (1, 2, 4)]
    assert found[0] > found[1] > found[2] > bracket.voxels.solve(scene).lower
    assert fem.solve(scene, size=5.0).conductivity == found[0]


@pytest.mark.parametrize("make", [periodic, walled])
def test_links_of_an_image(make):
    """Halves of both voxels, one by one."""
    labels = drawn((3, 4, 2))
    scene = make(labels)
    k = np.vectorize(lambda label: K[label].conductivity)(labels)
    found = links(scene, labels.shape, phase=voxelise(scene, labels.shape, laminate=False).phase)
    for axis in range(3):
        n = labels.shape[axis]
        for place in product(*(range(m + (a == axis)) for a, m in enumerate(labels.shape))):
            upper, lower = list(place), list(place)
            upper[axis], lower[axis] = place[axis] % n, (place[axis] - 1) % n
            expected = 2 / (1 / k[tuple(upper)] + 1 / k[tuple(lower)])
            if not scene.periodic and place[axis] in (0, n):
                inner = upper if place[axis] == 0 else lower
                expected = k[tuple(inner)] if axis == scene.axis else 0.0
            assert found[axis][place] == pytest.approx(expected, rel=1e-14)


PORES = {0: Material(0.0), 1: Material(2.0)}


def grains():
    """A bar along y, a grain that touches nothing, and a stub on the wall y = 0; all else pore."""
    labels = np.zeros((6, 4, 4), int)
    labels[0, :, 0], labels[2, 1:3, 2], labels[4, 0, 2] = 1, 1, 1
    return labels


@pytest.mark.parametrize("name", ["fft", "fem"])
def test_pores_of_an_image(name):
    field = WAYS[name](walled(grains(), voxel=1.0, materials=PORES))
    assert field.conductivity == pytest.approx(2.0 / 24, rel=1e-9)  # the bar alone
    points = np.array([[0.5, 1, 0.5], [2.5, 1.5, 2.5], [4.5, 0.5, 2.5], [3.5, 2.5, 1.5]])
    found = field.temperature_at(points)
    assert found[0] == pytest.approx(22.5) and np.isnan(found[1]) and found[2] == 20.0 and np.isnan(found[3])
    assert np.all(field.flux_at(points)[1:] == 0)
    cell = WAYS[name](periodic(grains(), voxel=1.0, materials=PORES))
    assert cell.conductivity == pytest.approx(2.0 / 24, rel=1e-9)
    # Each body's temperature less that of the mean gradient has no mean: the grain is at its middle's.
    assert cell.temperature_at(points[1:2])[0] == pytest.approx(2.0)
    still = WAYS[name](periodic(grains(), (1.0, 0.0, 0.0), voxel=1.0, materials=PORES))
    assert still.conductivity == 0.0 and np.all(still.samples.flux == 0)


def test_elements_join_over_an_edge():
    """Two bars that share an edge only: heat passes their nodes, and no face of a voxel."""
    labels = np.zeros((2, 2, 2), int)
    labels[0, 0], labels[1, 1] = 1, 1
    scene = walled(labels, voxel=1.0, materials=PORES)
    assert fft.solve(scene).conductivity == 0.0 < fem.solve(scene).conductivity


def test_what_elements_of_an_image_refuse():
    from demheat import Convection

    scene = Scene.of_image(Image(drawn(), VOXEL, K), walls={"x-": 1.0, "x+": Convection(5.0, 3.0)})
    with pytest.raises(NotImplementedError, match="elements of an image know held temperatures and fluxes"):
        fem.solve(scene)
    with pytest.raises(ValueError, match="order = 3"):
        fem.solve(periodic(drawn()), order=3)
    heated = {label: Material(2.0, 1.0, 1.0) for label in np.unique(drawn())}
    still = Scene.of_image(Image(drawn(), VOXEL, heated), walls={"x-": 1.0}, initial=0.0)
    with pytest.raises(NotImplementedError, match="Scene.image.*: in time tetrahedra .* use elements='hexahedra'$"):
        fem.evolve(still, [1.0])
    with pytest.raises(NotImplementedError, match="links have a harmonic mean"):
        fft.solve(periodic(grains(), materials=PORES), rule="links")
    with pytest.raises(NotImplementedError, match="fill pores"):
        bracket.voxels.solve(periodic(grains(), materials=PORES))
