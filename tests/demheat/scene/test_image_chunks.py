"""Only here: images in chunks that are read as a whole, or more than twice."""

import tracemalloc

import numpy as np
import pytest

from demheat import Image, Material, Scene
from demheat.scene import image as module
from references import fft

MATERIALS = {0: Material(1.0), 2: Material(5.0), 300: Material(20.0)}
LABELS = np.random.default_rng(3).choice(list(MATERIALS), (11, 6, 5))


class Chunked:
    """Labels as zarr has them: a shape, a type, chunks, and slices that are made when they are asked for."""

    def __init__(self, labels, layer=4):
        self.labels, self.chunks, self.read = labels, (layer, 2, 2), []
        self.shape, self.dtype, self.ndim = labels.shape, labels.dtype, labels.ndim

    def __getitem__(self, part):
        self.read.append((part.start, part.stop))
        return self.labels[part].copy()

    def __array__(self, *_, **__):
        raise AssertionError("read as a whole")


@pytest.mark.parametrize("slab", [1, 90, 10**6])
def test_chunks_make_no_difference(monkeypatch, slab):
    whole = Image(LABELS, 1.0, MATERIALS)
    monkeypatch.setattr(module, "SLAB", slab)
    labels = Chunked(LABELS)
    parted = Image(labels, 1.0, MATERIALS)
    assert parted == whole and parted.digest == whole.digest and parted.labels.dtype == np.uint16
    # Whole layers of chunks, all of them twice.
    assert all(start % 4 == 0 for start, _ in labels.read)
    assert len(labels.read) == 2 * (3 if slab < 100 else 1)


def test_voxels_of_chunks_have_the_same_bits():
    fields = [
        fft.solve(Scene.of_image(Image(labels, 1e-3, MATERIALS), gradient=(1, 0, 0)))
        for labels in (LABELS, Chunked(LABELS))
    ]
    assert fields[0].conductivity == fields[1].conductivity
    np.testing.assert_array_equal(fields[0].samples.temperature, fields[1].samples.temperature)


def test_wide_labels_are_never_there_as_a_whole(monkeypatch):
    monkeypatch.setattr(module, "SLAB", 2**14)
    labels = Chunked(np.random.default_rng(0).integers(0, 2, (128, 64, 64)), layer=8)
    tracemalloc.start()
    try:
        Image(labels, 1.0, {0: MATERIALS[0], 1: MATERIALS[2]})
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    # The labels in a byte each, a layer of chunks in eight, slabs of it: half a MiB of labels, 4 in 64 bits.
    assert peak < 0.3 * labels.labels.nbytes


@pytest.mark.parametrize("labels", [Chunked(LABELS[0]), Chunked(LABELS + 0.5), Chunked(LABELS[:0])])
def test_what_is_no_image_is_refused(labels):
    labels.chunks = labels.chunks[: labels.ndim]
    with pytest.raises(ValueError, match="Image.labels of"):
        Image(labels, 1.0, MATERIALS)
