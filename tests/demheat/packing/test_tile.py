"""Only here: tiles that are not what the recipe makes, miss the number asked for, have seams, or are read in part."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial import cKDTree

from demheat.packing import tile, tile_recipe
from demheat.packing.gate import check_packing
from demheat.packing.tile import OFF, STRETCH, fits, numbers, tiled


# Six CPU-seconds; whether points are at rest the next sees.
@pytest.mark.slow
def test_the_shipped_points_are_those_of_the_recipe():
    """The least tile made anew; steps that come to rest forgive rounding of another machine."""
    made = tile_recipe.make(numbers()[0]).astype(int)
    stored = np.round(np.sort(tile._tile(numbers()[0]), axis=0) * tile.PARTS).astype(int)
    # A ten-thousandth of the edge.
    assert_allclose(np.sort(made, axis=0), stored, atol=7)


def test_particles_are_in_the_centroids_of_their_cells():
    """Root mean square over the mean distance between particles; what they began as is much farther off."""
    for number in (numbers()[0], numbers()[-1]):
        points = tile._tile(number)
        off = np.linalg.norm(tile_recipe.centroids(points) - points, axis=1) * np.cbrt(number)
        assert np.sqrt(np.mean(off**2)) < 5e-3  # the last step of the recipe moved them by as much


def test_centroids_of_a_lattice_that_is_shifted_are_its_points():
    points = (np.stack(np.meshgrid(*[np.arange(4)] * 3), axis=-1).reshape(-1, 3) + 0.3) / 4
    points += 1e-9 * np.random.default_rng(0).random(points.shape)  # more than four cells in a corner are no tetrahedra
    assert_allclose(tile_recipe.centroids(points), points, atol=1e-7)


@pytest.mark.parametrize("size", [(1.0, 1.0, 1.0), (1.0, 1.3, 1.7)])
def test_any_number_is_met(size):
    for number in (1000, 1777, 12_345, 100_000):
        packing = tiled(number, size=size, seed=3)
        assert abs(packing.number / number - 1) <= OFF
        assert packing.provenance["number"] == packing.number and packing.provenance["stretch"] <= STRETCH
        check_packing(packing)
        assert np.all(packing.centers < packing.size)
        walled = tiled(number, size=size, periodic=False, seed=3)
        # What a wall cuts off a tile is more or less by chance: of the layer beside six walls a tenth.
        assert abs(walled.number / number - 1) <= OFF
        check_packing(walled)


def test_tiles_go_on_through_a_period():
    """No two particles are nearer across a seam than within a tile."""
    packing = tiled(8000, size=(1.0, 1.0, 1.0), seed=1)
    away, _ = cKDTree(packing.centers, boxsize=1.0).query(packing.centers, k=2)
    within, _ = cKDTree(tile._tile(packing.provenance["tile"]), boxsize=1.0).query(
        tile._tile(packing.provenance["tile"]), k=2
    )
    assert_allclose(away[:, 1].min(), within[:, 1].min() / packing.provenance["repeats"][0], rtol=1e-9)


def test_between_walls_is_one_layer():
    packing = tiled(5000, size=(1.0, 1.0, 1.0), periodic=False)
    radius = packing.radii[0]
    off = np.minimum(packing.centers, 1.0 - packing.centers) / radius
    near = off < tile.LAYER
    # At all six walls, none carried to the one across.
    for beside in (packing.centers, 1.0 - packing.centers):
        assert (beside < tile.LAYER * radius).any(axis=0).all()
    assert_allclose(off[near], tile.FIRST, rtol=1e-9)


def test_seeds_turn_and_shift():
    one, same, other = (tiled(1000, size=(1.0, 1.0, 1.0), seed=seed) for seed in (0, 0, 1))
    assert np.array_equal(one.centers, same.centers) and one.number == other.number
    assert not np.allclose(np.sort(one.centers[:, 0]), np.sort(other.centers[:, 0]))


def test_what_is_not_kept_takes_no_memory():
    def left(points):
        return points[:, 0] < 0.3

    whole, part = tiled(8000, size=(1.0, 1.0, 1.0)), tiled(8000, size=(1.0, 1.0, 1.0), keep=left)
    assert np.array_equal(part.centers, whole.centers[left(whole.centers)])
    assert part.provenance == whole.provenance


@pytest.mark.parametrize(("number", "size"), [(40, (1, 1, 1)), (1000, (1, 100, 100)), (1000, (1, 1, 100))])
def test_where_no_tile_fits_particles_are_packed(number, size):
    assert not fits(number, size, True)
    with pytest.raises(ValueError, match="no tile"):
        tiled(number, size=size)


@pytest.mark.parametrize("spoiled", [b"", b"something else", None])
def test_a_file_that_is_cut_or_foreign_is_refused(spoiled, monkeypatch, tmp_path):
    whole = tile.FILE.read_bytes()
    changed = bytearray(whole)
    changed[-1] ^= 1
    path = tmp_path / "tile.npy"
    path.write_bytes(bytes(changed) if spoiled is None else spoiled)
    monkeypatch.setattr(tile, "FILE", path)
    tile._tiles.cache_clear(), tile._tile.cache_clear()
    try:
        with pytest.raises(RuntimeError, match="install it again"):
            tiled(1000, size=(1.0, 1.0, 1.0))
    finally:
        tile._tiles.cache_clear(), tile._tile.cache_clear()
