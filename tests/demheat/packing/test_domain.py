"""Only here: cuts and replicas of packings that lose spheres, images or the order of memory."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from demheat.packing.base import make_packing
from demheat.packing.domain import cut, replicate
from demheat.packing.neighbours import contacts, neighbours
from demheat.packing.relax import relax
from demheat.scene.shapes.morton import morton_order


@pytest.fixture(scope="module")
def block():
    return relax(2000, size=(1.0, 1.3, 0.9), seed=4)


def as_set(packing):
    return {tuple(row) for row in np.round(np.column_stack((packing.centers, packing.radii)), 9).tolist()}


def images(packing):
    """All spheres with their 27 images, (27 n, 4)."""
    shifts = np.stack(np.meshgrid(*[[-1, 0, 1]] * 3, indexing="ij"), -1).reshape(-1, 3) * packing.size
    return np.concatenate([np.column_stack((packing.centers + s, packing.radii)) for s in shifts])


@pytest.mark.parametrize(
    ("domain", "size", "center", "keep"),
    [
        ("box", (0.5, 0.7, 0.6), (0.05, 1.25, 0.3), "inside"),
        ("cylinder-y", (0.6, 0.8, 0.6), (0.05, 1.25, 0.3), "center"),
        ("cylinder-x", (0.4, 0.7, 0.7), (0.5, 0.65, 0.45), "inside"),
        ("sphere", (0.8,) * 3, (0.05, 1.25, 0.3), "inside"),
    ],
)
def test_what_is_cut_is_what_lies_inside(block, domain, size, center, keep):
    """Against all images of all spheres, tested one domain at a time by its definition."""
    found = cut(block, domain, size=size, center=center, keep=keep)
    spheres, half = images(block), np.array(size) / 2
    local, reach = spheres[:, :3] - center, spheres[:, 3] * (keep == "inside")
    flat, round_axes = {
        "box": ([0, 1, 2], []),
        "cylinder-y": ([1], [0, 2]),
        "cylinder-x": ([0], [1, 2]),
        "sphere": ([], [0, 1, 2]),
    }[domain]
    inside = np.all(np.abs(local[:, flat]) + reach[:, None] <= half[flat], axis=1)
    if round_axes:
        inside &= np.linalg.norm(local[:, round_axes], axis=1) + reach <= half[round_axes[0]]
    expected = np.column_stack((local[inside] + half, spheres[inside, 3]))
    assert as_set(found) == {tuple(row) for row in np.round(expected, 9).tolist()}
    assert found.domain == domain and not found.periodic.any()
    assert 100 < found.number < block.number / 2


def test_a_cylinder_of_full_length_keeps_its_period_and_fills_it(block):
    drum = cut(block, "cylinder-y")
    assert_array_equal(drum.size, [0.9, 1.3, 0.9])
    assert_array_equal(drum.periodic, [False, True, False])
    assert_allclose(drum.volume, np.pi / 4 * 0.9**2 * 1.3, rtol=1e-14)
    # By definition; links across the periodic ends are there.
    _, _, gap = contacts(drum)
    indptr, indices = neighbours(drum, scale=1 + gap)
    ends = drum.centers[np.repeat(np.arange(drum.number), np.diff(indptr)), 1] - drum.centers[indices, 1]
    assert np.abs(ends).max() > 1.0
    assert cut(block, "cylinder-y", keep="center").number > drum.number


def test_a_drum_between_hard_walls_keeps_them():
    walled = relax(2000, periodic=(True, False, True), phi=0.6, seed=4)
    drum = cut(walled, "cylinder-y", size=(0.7, 1.0, 0.7))
    assert not drum.periodic.any()
    near = [np.sum(end <= drum.radii * 1.001) for end in (drum.centers[:, 1], 1 - drum.centers[:, 1])]
    assert min(near) > 20  # spheres still touch both ends
    # What reaches a little into a hard wall (relaxed packings overlap) is not lost by a rough cut there.
    assert np.any(drum.centers[:, 1] < drum.radii)


def test_everything_is_kept_by_a_cut_of_the_whole_box(block):
    assert as_set(cut(block)) == as_set(block)
    assert cut(block).periodic.all()


def test_cuts_that_walls_forbid(block):
    walled = block._replace(periodic=np.array([True, False, True]))
    with pytest.raises(ValueError, match="beyond the walls"):
        cut(walled, size=(0.5, 0.5, 0.5), center=(0.5, 0.2, 0.5))
    assert cut(walled, size=(0.5, 0.5, 0.5), center=(0.1, 0.25, 0.5)).number > 50
    with pytest.raises(ValueError, match="in a cylinder-y"):
        cut(cut(block, "cylinder-y"), "box")


def test_tiles_are_images(block):
    big = replicate(block, (2, 1, 3))
    assert_allclose(big.size, [2.0, 1.3, 2.7], rtol=1e-15)
    shifts = [np.array([i, 0, k]) * block.size for i in range(2) for k in range(3)]
    expected = np.concatenate([np.column_stack((block.centers + s, block.radii)) for s in shifts])
    assert as_set(big) == {tuple(row) for row in np.round(expected, 9).tolist()}
    assert_allclose(big.phi, block.phi, rtol=1e-12)
    # Each sphere has as many neighbours in the big box as its original.
    few, many = (np.diff(neighbours(p, scale=1.1)[0]) for p in (block, big))
    assert_array_equal(many, np.tile(few, 6))


def test_tiles_of_a_cube_are_in_morton_order():
    cube = relax(1000, seed=0)
    big = replicate(cube, (2, 2, 2))
    order = morton_order(big.centers, big.size)
    # 21 bits of the small box are 20 of the large one: only spheres in one cell of 2**-20 may change places.
    assert np.mean(order == np.arange(8000)) > 0.99


def test_a_centre_that_rounds_to_the_far_face_is_wrapped():
    size = (0.1, 0.3, 0.7)
    packing = make_packing([np.nextafter(size, 0)], [0.01], size, True, {})
    big = replicate(packing, (3, 5, 7))
    assert np.all(big.centers < big.size)


def test_walls_are_not_repeated(block):
    walled = block._replace(periodic=np.array([True, False, True]))
    assert replicate(walled, (2, 1, 2)).number == 8000
    with pytest.raises(ValueError, match="must be 1 along axes with walls"):
        replicate(walled, (1, 2, 1))
