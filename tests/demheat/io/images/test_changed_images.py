"""Only here: a part of an image from elsewhere, labels of larger voxels that are none, voxels of the wrong size."""

import numpy as np
import pytest
import tifffile

from demheat import Material
from demheat.io import scenes
from demheat.io.images import read_image
from demheat.io.images.changed import changed

GREY = np.random.default_rng(5).integers(0, 200, (6, 4, 8)).astype(np.float32)
LABELS = np.random.default_rng(6).integers(0, 4, (6, 4, 8)).astype(np.uint8)
MATERIALS = {number: Material(1.0 + number) for number in range(4)}


def test_a_part_is_cut_out(tmp_path):
    np.save(tmp_path / "x.npy", LABELS)
    image = read_image(tmp_path / "x.npy", voxel=2.0, materials=MATERIALS, crop=[[1, 5], [0, 4], [2, 3]])
    assert np.array_equal(image.labels, LABELS[1:5, :, 2:3]) and image.voxel == (2.0, 2.0, 2.0)


def test_larger_voxels_have_the_label_of_most(tmp_path):
    np.save(tmp_path / "x.npy", LABELS)
    image = read_image(tmp_path / "x.npy", voxel=(1.0, 2.0, 3.0), materials=MATERIALS, coarsen=2)
    assert image.voxel == (2.0, 4.0, 6.0) and image.shape == (3, 2, 4)
    for place in np.ndindex(image.shape):
        block = LABELS[tuple(slice(2 * k, 2 * k + 2) for k in place)]
        # Of several that as many have, the least.
        assert image.labels[place] == np.argmax(np.bincount(block.ravel()))


def test_grey_values_are_averaged_before_they_are_told_apart(monkeypatch):
    monkeypatch.setattr("demheat.scene.image.SLAB", 40)  # One layer at a time
    found = changed(GREY, coarsen=2, threshold=[70, 110])
    mean = GREY.reshape(3, 2, 2, 2, 4, 2).mean(axis=(1, 3, 5))
    assert np.array_equal(found, (mean >= 70).astype(int) + (mean >= 110)) and set(found.ravel()) == {0, 1, 2}
    # What is as large as the threshold is above it.
    assert changed(np.full((1, 1, 1), 70.0), threshold=70).item() == 1


WRONG = [
    ({"crop": [[0, 7], [0, 4], [0, 8]]}, r"crop = \[\[0, 7\].*must be three pairs .* within 6 x 4 x 8"),
    ({"crop": [[0, 6], [0, 4]]}, "crop = .*must be three pairs"),
    ({"crop": [[2, 2], [0, 4], [0, 8]]}, "crop = .*must be three pairs"),
    ({"coarsen": 4}, "coarsen = 4: must divide the 6 x 4 x 8 voxels; crop cuts some off"),
    ({"coarsen": 0}, "coarsen = 0: must be a whole number >= 1"),
    ({"threshold": [3, 2]}, r"threshold = \[3, 2\]: must be a finite number, or several that rise"),
    ({"threshold": "much"}, "threshold = 'much': must be"),
]


def test_a_threshold_that_tells_nothing_apart_is_warned_of():
    with pytest.warns(UserWarning, match=r"threshold = 300: all .* voxels are of label 0, as grey values are .* to "):
        assert not changed(GREY, threshold=300).any()


@pytest.mark.parametrize(("how", "words"), WRONG, ids=[str(how) for how, _ in WRONG])
def test_what_makes_no_image(how, words):
    with pytest.raises(ValueError, match=words):
        changed(LABELS, **how)


UM = (2e-6, 2e-6, 5e-6)
TIFFS = {
    "imagej": {
        "imagej": True,
        "resolution": (0.5, 0.5),
        "metadata": {"spacing": 5.0, "unit": "um", "axes": "ZYX"},
    },
    "micro": {
        "imagej": True,
        "resolution": (0.5, 0.5),
        "metadata": {"spacing": 5.0, "unit": "\\u00B5m", "axes": "ZYX"},
    },
    "ome": {
        "ome": True,
        "metadata": {
            "axes": "ZYX",
            **{f"PhysicalSize{axis}": size for axis, size in zip("XYZ", (2, 2, 0.005), strict=True)},
            "PhysicalSizeZUnit": "mm",
        },
    },
}


@pytest.mark.parametrize("kind", TIFFS)
def test_a_tiff_may_tell_its_voxels(kind, tmp_path):
    how = TIFFS[kind]
    path = tmp_path / ("x.ome.tif" if kind == "ome" else "x.tif")
    tifffile.imwrite(path, np.ascontiguousarray(LABELS.T), **how)
    image = read_image(path, materials=MATERIALS)
    assert image.voxel == pytest.approx(UM, rel=1e-6) and np.array_equal(image.labels, LABELS)


def test_a_tiff_that_tells_no_unit_is_asked_for(tmp_path):
    how = {"imagej": True, "resolution": (0.5, 0.5), "metadata": {"spacing": 5.0, "axes": "ZYX"}}
    tifffile.imwrite(tmp_path / "x.tif", np.ascontiguousarray(LABELS.T), **how)
    with pytest.raises(ValueError, match="does not tell the edges of a voxel"):
        read_image(tmp_path / "x.tif", materials=MATERIALS)


FILE = """gradient = [0, 1, 0]
[image]
file = "x.npy"
voxel_um = 2
{more}
[materials.pore]
conductivity = 1
[materials.rock]
conductivity = 3
"""


def of_file(tmp_path, more):
    np.save(tmp_path / "x.npy", LABELS)
    (tmp_path / "scene.toml").write_text(FILE.format(more=more), encoding="utf-8")
    return scenes.read(tmp_path / "scene.toml")


def test_a_file_names_labels_and_changes(tmp_path):
    scene = of_file(tmp_path, "labels = {pore = [0, 1], rock = [2, 3]}\ncrop = [[0, 4], [0, 4], [0, 8]]\ncoarsen = 2")
    assert scene.image.shape == (2, 2, 4) and scene.size == pytest.approx((8e-6, 8e-6, 16e-6))
    assert {label: each.conductivity for label, each in scene.image.materials.items()}.items() <= {
        **dict.fromkeys((0, 1), 1.0),
        **dict.fromkeys((2, 3), 3.0),
    }.items()
    scene = of_file(tmp_path, "threshold = 2\nlabels = {pore = 0, rock = 1}")
    assert np.array_equal(scene.image.labels, LABELS >= 2)


@pytest.mark.parametrize(
    ("more", "line", "words"),
    [
        ("labels = {pore = [0, 1], rok = 2}", 5, "image.labels.rok: must be the name of one of.*did you mean 'rock'"),
        ("labels = {pore = [0, 1], rock = [1, 2]}", 5, "label 1 has a material already"),
        ("labels = {pore = 0.5}", 5, "must be a label, a whole number"),
        ("labels = {pore = 0, rock = [1, 2, 3]}\ncoarsen = 3", 6, "image.coarsen = 3: must divide"),
        ("", 6, "must be a label of the image, a whole number, or in its labels"),
    ],
)
def test_what_is_wrong_has_its_line(tmp_path, more, line, words):
    with pytest.raises(ValueError, match=rf"scene.toml:{line}: .*{words}") as caught:
        of_file(tmp_path, more)
    assert "\n" not in str(caught.value)
