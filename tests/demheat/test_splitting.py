"""Only here: an image's error read off another body, or off a block in its corner."""

import numpy as np
import pytest

from demheat import Image, Material, Scene, solve
from demheat.splitting import block_of
from references import bracket, fem, fft


def cell(contrast=10.0, shape=(6, 6, 6), **load):
    labels = np.random.default_rng(7).random(shape) < 0.4
    load = load or {"gradient": (0.0, 1.0, 0.0)}
    return Scene.of_image(Image(labels, 0.5, {0: Material(1.0), 1: Material(contrast)}), **load)


def test_split_voxels_are_the_same_body():
    scene = cell(shape=(3, 4, 5))
    twice = scene.image.labels.repeat(2, axis=0).repeat(3, axis=1).repeat(2, axis=2)
    edges = (0.25, 0.5 / 3, 0.25)
    finer = Scene.of_image(Image(twice, edges, scene.image.materials), gradient=scene.gradient)
    for rule in ("plain", "links"):
        one, other = fft.solve(scene, voxels=(6, 12, 10), rule=rule), fft.solve(finer, rule=rule)
        assert one.conductivity == pytest.approx(other.conductivity, rel=1e-12)
    both = [bracket.voxels.solve(scene, voxels=(6, 12, 10)), bracket.voxels.solve(finer)]
    assert both[0].lower == pytest.approx(both[1].lower, rel=1e-9)
    with pytest.raises(ValueError, match=r"voxels = 7: must be those of the image, \(3, 4, 5\), or split each"):
        fft.solve(scene, voxels=7)


def test_a_block_is_out_of_the_middle():
    scene = cell(shape=(8, 6, 3), walls={"x-": 0.0, "x+": 1.0})
    assert block_of(scene, 200) is scene
    block = block_of(scene, 60)
    assert block.image.shape == (4, 3, 3) and block.walls == scene.walls
    assert np.array_equal(block.image.labels, scene.image.labels[2:6, 1:4])


@pytest.mark.parametrize("contrast", [0.01, 100.0])
def test_intervals_hold_the_image(contrast):
    scene = cell(contrast)
    right = fft.solve(scene, voxels=48).conductivity
    for field in (fft.solve(scene), fft.solve(scene, voxels=12), fem.solve(scene), solve(scene, particles=1000)):
        error = field.error
        assert error.lower < right < error.upper, error
        assert error.flux >= (error.upper - error.lower) / 2 * (1 - 1e-9)
    # Twice as fine, less than .7 of the width: errors go with the first order.
    widths = [np.ptp(fft.solve(scene, voxels=n).error[1:3]) for n in (6, 12)]
    assert widths[1] < 0.7 * widths[0]


def blocks(plane, conductivity, gradient):
    """An image of four by four blocks, each four voxels wide, four voxels deep."""
    labels = np.kron(plane, np.ones((4, 4), np.uint8))[:, :, None].repeat(4, axis=2)
    return Scene.of_image(Image(labels, 1 / 16, {0: Material(1.0), 1: Material(conductivity)}), gradient=gradient)


@pytest.mark.parametrize("seed", range(2))
def test_of_layers_along_the_heat_the_dem_knows_that_both_its_means_err_downwards(seed):
    # A quarter conducts 100 times as well: both means are below 25.75 by 2000 to 8000 particles.
    scene = blocks([[1] * 4, *[[0] * 4] * 3], 100.0, (0.0, 1.0, 0.0))
    error = solve(scene, particles=4000, seed=seed).error
    assert error.lower < 25.75 < error.upper


def test_where_blocks_meet_as_on_a_checkerboard_rings_know_what_they_miss():
    # Keller's duality gives the root of the contrast; a third is missed, 4.5 times what split voxels change.
    squares = np.kron([[0, 1], [1, 0]], np.ones((2, 2), int))
    error = fft.solve(blocks(squares, 100.0, (1.0, 0.0, 0.0)), scheme="eyre-milton").error
    assert error.lower < 10.0 < error.upper


@pytest.mark.parametrize("width", [1, 3])
def test_on_boards_of_high_contrast_split_voxels_count_as_little_as_they_tell(width):
    """Of contrast 1000 they change a seventeenth of what is left: three methods are off by factors, and say so."""
    squares = np.kron([[0, 1], [1, 0]], np.ones((width, width), np.uint8))[:, :, None].repeat(2, axis=2)
    image = Image(squares, 1.0, {0: Material(1.0), 1: Material(1000.0)})
    scene = Scene.of_image(image, gradient=(1.0, 0.0, 0.0))
    for field in (fft.solve(scene), fft.solve(scene, scheme="eyre-milton"), fem.solve(scene)):
        error = field.error
        assert error.lower < 1000**0.5 < error.upper, error


def test_a_block_counts_in_parts(monkeypatch):
    monkeypatch.setattr("references.fft.estimate.SPLIT", fft_rule(3**3))
    error = fft.solve(cell()).error
    assert error.how == "voxels split in two, of a block of 3 x 3 x 3"
    assert error.lower < fft.solve(cell(), voxels=24).conductivity < error.upper


def fft_rule(most):
    from references.fft.estimate import SPLIT

    return SPLIT._replace(most=most)


def test_beside_pores_the_dem_does_not_know():
    with pytest.raises(NotImplementedError, match="beside pores of an image"):
        solve(cell(0.0), particles=500).error  # noqa: B018
