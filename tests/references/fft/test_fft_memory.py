"""What a solve on voxels says that it will take is what it takes."""

import tracemalloc

import pytest

from demheat import gallery
from references import fft

CELL, WALLS = gallery.simple_cubic(10.0), gallery.sphere_in_cube(10.0)


@pytest.mark.parametrize(
    ("scene", "knobs"),
    [
        (CELL, {"scheme": "cg", "rule": "plain"}),
        (WALLS, {"scheme": "cg", "rule": "plain", "precision": "float32"}),
        (WALLS, {"scheme": "cg", "rule": "links"}),
        (CELL, {"scheme": "eyre-milton", "rule": "plain"}),
    ],
)
def test_the_peak_is_as_it_was_said(scene, knobs):
    fft.solve(scene, voxels=16, **knobs)  # compiled
    tracemalloc.start()
    try:
        field = fft.solve(scene, voxels=96, tolerance=0.3, threads=1, **knobs)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    # Blocks and buffers of a megabyte each besides, a tenth of the whole here; nothing may be left out.
    assert 0.97 < peak / 2**20 / field.stats["expected_mib"] < 1.25
