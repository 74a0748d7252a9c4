"""Only here: images in several sizes as OME writes them: axes in another order, the voxel, what is refused."""

import json

import numpy as np
import pytest

from demheat import Material
from demheat.io.images import read_image

zarr = pytest.importorskip("zarr", minversion="3")

MATERIALS = {0: Material(1.0), 7: Material(5.0)}
LABELS = np.random.default_rng(5).choice(list(MATERIALS), (9, 8, 7)).astype(np.uint8)
AXES = [{"name": "c", "type": "channel"}, *({"name": n, "type": "space", "unit": "micrometer"} for n in "zyx")]


def written(path, version, *, axes=AXES, array=None, scale=(1, 4.0, 3.0, 2.0), where="0", also=()):
    """A group with one array; by version 2 or 3 of zarr."""
    group = zarr.open_group(str(path), mode="w", zarr_format=version)
    values = LABELS.transpose(2, 1, 0)[None] if array is None else array
    made = group.create_array("0", shape=values.shape, chunks=(1, *[4] * (values.ndim - 1)), dtype=values.dtype)
    made[:] = values
    steps = [{"type": "scale", "scale": list(scale)}]
    told = [{"axes": axes, "datasets": [{"path": where, "coordinateTransformations": steps}, {"path": "1"}]}]
    if also:
        told[0]["coordinateTransformations"] = list(also)
    group.attrs.update({"multiscales": told} if version == 2 else {"ome": {"version": "0.5", "multiscales": told}})
    return path


@pytest.mark.parametrize("version", [2, 3])
def test_the_finest_image_its_axes_and_its_voxel(tmp_path, version):
    image = read_image(written(tmp_path / "rock.zarr", version), materials=MATERIALS)
    assert np.array_equal(image.labels, LABELS)
    # Scales are those of z, y and x.
    assert image.voxel == pytest.approx((2e-6, 3e-6, 4e-6), rel=1e-12)
    part = read_image(tmp_path / "rock.zarr", materials=MATERIALS, crop=[[1, 9], [2, 6], [0, 5]])
    assert np.array_equal(part.labels, LABELS[1:9, 2:6, :5])


def test_a_scale_of_all_sizes_counts_too(tmp_path):
    twice = [{"type": "scale", "scale": [1, 2.0, 2.0, 2.0]}]
    image = read_image(written(tmp_path / "rock.zarr", 2, also=twice), materials=MATERIALS)
    assert image.voxel == pytest.approx((4e-6, 6e-6, 8e-6), rel=1e-12)


def test_without_units_the_voxel_must_be_given(tmp_path):
    plain = [{"name": axis} for axis in "czyx"]
    path = written(tmp_path / "rock.zarr", 2, axes=plain)
    with pytest.raises(ValueError, match="does not tell the edges of a voxel"):
        read_image(path, materials=MATERIALS)
    assert read_image(path, materials=MATERIALS, voxel=1e-3).voxel == (1e-3,) * 3


@pytest.mark.parametrize(
    ("how", "words"),
    [
        ({"array": np.zeros((2, 3, 4, 5), np.uint8)}, "has 2 entries along 'c'; must be one image of one channel"),
        ({"array": np.zeros((3, 4, 5), np.uint8)}, "an array of 3 axes, 4 are told of"),
        ({"axes": [{"name": n} for n in "tcyx"]}, "axes t, c, y, x; must have x, y and z"),
        ({"where": "../other"}, "lies outside; must be in this folder"),
        ({"where": "7"}, "no zarr array"),
        ({"axes": 3}, "no zarr image, or a part of one"),
    ],
)
def test_what_is_no_body_is_refused(tmp_path, how, words):
    path = written(tmp_path / "rock.zarr", 2, **how)
    with pytest.raises(ValueError, match=words) as told:
        read_image(path, materials=MATERIALS, voxel=1.0)
    assert "\n" not in str(told.value)


def test_a_group_of_something_else_is_still_one(tmp_path):
    zarr.open_group(str(tmp_path / "rock.zarr"), mode="w", zarr_format=2)
    (tmp_path / "rock.zarr" / ".zattrs").write_text(json.dumps({"mine": 1}))
    with pytest.raises(ValueError, match="is a group; must be one array"):
        read_image(tmp_path / "rock.zarr", materials=MATERIALS, voxel=1.0)
