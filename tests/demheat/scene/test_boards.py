"""Only here: boards taken for noise, noise for boards, or what is left on them read off the wrong power."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from demheat import Image, Material, Scene
from demheat.scene.boards import left_by_boards


def scene_of(labels, *conductivities):
    materials = dict(enumerate(map(Material, conductivities)))
    return Scene.of_image(Image(labels.astype(np.uint8), 1.0, materials), gradient=(1.0, 0.0, 0.0))


def left_of(scene):
    return left_by_boards(scene, goes_on=True)


def board(width=2, axis=2):
    squares = np.kron(np.indices((4, 4)).sum(axis=0) % 2, np.ones((width, width), int))
    return np.moveaxis(squares[:, :, None].repeat(3, axis=2), 2, axis)


@pytest.mark.parametrize("axis, contrast", [(0, 10.0), (1, 100.0), (2, 1000.0)])
def test_boards_leave_what_the_power_at_their_corners_says(axis, contrast):
    # Keller, J. Math. Phys. 28 (1987) 2516: the field has the power (4 / pi) arctan(contrast^-1/2); steps of 1/2000.
    power = 4 / np.pi * np.arctan(contrast**-0.5)
    left = left_of(scene_of(board(axis=axis), 1.0, contrast))
    assert left == pytest.approx(1 / (2 ** (2 * power) - 1), rel=0.015)


def test_of_several_boards_the_worst_counts():
    one, other = board(), np.where(board(), 2, 0)
    both = np.concatenate([one, np.full((1, 8, 3), 1), other])
    left = [left_of(scene_of(one, 1.0, contrast)) for contrast in (10.0, 100.0)]
    assert left[0] < left_of(scene_of(both, 1.0, 10.0, 100.0)) == left[1]


def test_specks_labels_and_grains_do_not_hide_boards():
    """Under two labels that conduct alike, with a voxel of the other phase in each block, of grains nearly alike."""
    right = left_of(scene_of(board(5), 1.0, 1000.0))
    twice = np.where(np.indices((20, 20, 3))[0] > 9, 2, 1) * board(5)
    assert left_of(scene_of(twice, 1.0, 1000.0, 1000.1)) == pytest.approx(right, rel=1e-3)
    specks = board(5)
    specks[2::5, 2::5, 1] = 1 - specks[2::5, 2::5, 1]
    assert left_of(scene_of(specks, 1.0, 1000.0)) == right
    grains = 2 * board(5) + (np.random.default_rng(0).random((20, 20, 3)) < 0.5)
    assert left_of(scene_of(grains, 1.0, 1.2, 1000.0, 1200.0)) == pytest.approx(right, rel=0.2)


def test_blocks_may_meet_across_the_faces_of_a_cell():
    """Of two in opposite corners one edge of seven alternates, if the cell goes on."""
    labels = np.zeros((9, 9, 3), int)
    labels[:3, :3] = labels[-3:, -3:] = 1
    scene = scene_of(labels, 1.0, 1000.0)
    assert left_by_boards(scene, goes_on=True) == left_of(scene_of(board(5), 1.0, 1000.0))
    assert left_by_boards(scene, goes_on=False) == 0.0


def test_noise_layers_and_blocks_apart_are_no_boards():
    rng = np.random.default_rng(0)
    noise = rng.random((12, 12, 12)) < 0.5
    lumps = gaussian_filter(rng.normal(size=(24, 24, 24)), 2.0, mode="wrap") > 0
    layers = np.indices((4, 4, 4))[0] // 2
    apart = np.zeros((6, 6, 6), int)
    apart[2:4, 2:4, 2:4] = 1
    for labels in (noise, lumps, layers, apart):
        assert left_of(scene_of(labels, 1.0, 1000.0)) == 0.0


@pytest.mark.parametrize("conductivity", [0.0, 2e4])
def test_beyond_some_contrast_there_is_nothing_to_go_by(conductivity):
    with pytest.raises(NotImplementedError, match="checkerboard of a contrast beyond 10000"):
        left_of(scene_of(board(), 1.0, conductivity))


def test_materials_with_axes_say_nothing():
    turned = Material(np.diag([1.0, 2.0, 50.0]))
    image = Image(board().astype(np.uint8), 1.0, {0: Material(1.0), 1: turned})
    assert left_of(Scene.of_image(image, gradient=(1.0, 0.0, 0.0))) == 0.0
