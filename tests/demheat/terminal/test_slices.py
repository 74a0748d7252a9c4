"""Only here: planes through a body turned, shifted, or masked otherwise than the body ends."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from demheat.gallery import laminate, slab
from demheat.scene import Material, Scene
from demheat.terminal import slices
from references import exact


def test_square_pixels_over_the_whole_face():
    points, mask = slices.plane(slab(size=(0.3, 0.2, 0.1)), axis=2, at=0.04, n=6)
    assert mask.shape == (4, 6) and mask.all()
    assert_allclose(points[:, 2], 0.04)
    assert_allclose(slices.filled(mask, points[:, 0]), np.tile(0.025 + 0.05 * np.arange(6), (4, 1)))
    assert_allclose(slices.filled(mask, points[:, 1]), np.tile(0.025 + 0.05 * np.arange(4)[:, None], (1, 6)))


@pytest.mark.parametrize(("axis", "columns", "rows"), [(0, 1, 2), (1, 0, 2), (2, 0, 1)])
def test_rows_along_the_later_axis(axis, columns, rows):
    points, mask = slices.plane(slab(size=(0.1, 0.2, 0.3)), axis=axis, at=0.05, n=12)
    grid = slices.filled(mask, points)
    assert_allclose(grid[..., axis], 0.05)
    assert np.all(np.diff(grid[..., columns], axis=1) > 0) and np.all(np.diff(grid[..., rows], axis=0) > 0)
    assert_allclose(np.ptp(grid[..., columns], axis=0), 0.0)


def test_a_side_thinner_than_a_pixel_has_one():
    points, mask = slices.plane(slab(size=(1.0, 0.01, 1.0)), axis=2, at=0.5, n=10)
    assert mask.shape == (1, 10)
    assert_allclose(points[:, 1], 0.005)


@pytest.mark.parametrize(
    ("domain", "axis", "at", "share"),
    [
        ("sphere", 2, 0.5, np.pi / 4),
        # The circle at a height h over the middle has the radius sqrt(R^2 - h^2).
        ("sphere", 0, 0.8, np.pi / 4 * (1 - 0.36)),
        ("cylinder-z", 0, 0.5, 1.0),
        ("cylinder-z", 1, 0.8, 0.8),
    ],
)
def test_round_bodies_are_masked(domain, axis, at, share):
    scene = Scene(size=(1.0, 1.0, 1.0), matrix=Material(1.0), domain=domain, initial=0.0)
    points, mask = slices.plane(scene, axis=axis, at=at, n=200)
    # Pixels are in or out by their middle: found within 2e-4, and a circle is 600 pixels long, each 2.5e-5 of the area.
    assert mask.mean() == pytest.approx(share, abs=1e-3)
    assert len(points) == mask.sum()
    assert_array_equal(mask, mask[::-1])


def test_a_field_on_a_plane():
    # Layers across z, heat along y: one temperature gradient everywhere, the flux is that of the layer.
    scene = laminate(direction="along", contrast=3.0)
    field = exact.solve(scene)
    middles = (np.arange(8) + 0.5) / 80
    along = slices.on_plane(field, axis=2, at=0.03, n=8)
    assert_allclose(along.temperature, np.tile(25.0 + 100.0 * middles[:, None], (1, 8)), atol=1e-6)
    across = slices.on_plane(field, axis=1, at=0.02, n=8)
    column = np.zeros((8, 3))
    column[:, 2] = middles
    layers = scene.conductivities[scene.phase_at(column)]
    assert len(np.unique(layers)) == 2
    assert across.flux.shape == (8, 8, 3)
    assert_allclose(across.flux[..., 1], np.tile(-100.0 * layers[:, None], (1, 8)), rtol=1e-6)


def test_outside_is_not_a_number_and_another_flux_may_stand_in():
    scene = Scene(size=(1.0, 1.0, 1.0), matrix=Material(1.0), domain="sphere", initial=0.0, walls={"round": 1.0})

    class Uniform:
        def __init__(self):
            self.scene = scene

        def temperature_at(self, points):
            return points[:, 0]

    sliced = slices.on_plane(Uniform(), axis=2, at=0.5, n=5, flux_at=lambda points: np.ones((len(points), 3)))
    # Of 5 x 5 pixels those in the corners have their middles (0.4, 0.4) off the centre: outside.
    out = np.zeros((5, 5), dtype=bool)
    out[[0, 0, -1, -1], [0, -1, 0, -1]] = True
    assert_array_equal(np.isnan(sliced.temperature), out)
    assert_array_equal(np.isnan(sliced.flux), np.repeat(out[..., None], 3, axis=2))
    assert_allclose(sliced.temperature[2], (np.arange(5) + 0.5) / 5)


def test_a_plane_that_touches_only_is_refused():
    scene = Scene(size=(1.0, 1.0, 1.0), matrix=Material(1.0), domain="sphere", initial=0.0)
    with pytest.raises(ValueError, match="none of the pixels"):
        slices.plane(scene, axis=2, at=0.0, n=4)
