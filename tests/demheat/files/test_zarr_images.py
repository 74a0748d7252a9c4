"""Images of zarr: the same as the array, and one line for what is none."""

import numpy as np
import pytest

from demheat import Material, Scene, files
from demheat.files import read_image
from references import fft

zarr = pytest.importorskip("zarr")

MATERIALS = {0: Material(1.0), 7: Material(5.0)}
LABELS = np.random.default_rng(5).choice(list(MATERIALS), (9, 8, 7)).astype(np.int64)


def stored(path, labels=LABELS, chunks=(4, 4, 4)):
    array = zarr.open(str(path), mode="w", shape=labels.shape, chunks=chunks, dtype=labels.dtype)
    array[:] = labels
    return path


def test_it_is_the_array(tmp_path):
    image = read_image(stored(tmp_path / "rock.zarr"), voxel=1e-3, materials=MATERIALS)
    assert np.array_equal(image.labels, LABELS) and image.labels.dtype == np.uint8
    found = fft.solve(Scene.of_image(image, gradient=(0, 1, 0)))
    plain = fft.solve(Scene.of_image(type(image)(LABELS, 1e-3, MATERIALS), gradient=(0, 1, 0)))
    assert found.conductivity == plain.conductivity


def test_in_a_scene_file(tmp_path):
    stored(tmp_path / "rock.zarr")
    materials = "".join(f"[materials.{label}]\nconductivity = {m.conductivity}\n" for label, m in MATERIALS.items())
    text = f'gradient = [1.0, 0.0, 0.0]\n[image]\nfile = "rock.zarr"\nvoxel = 1e-3\n{materials}'
    (tmp_path / "rock.toml").write_text(text)
    assert np.array_equal(files.read(tmp_path / "rock.toml").image.labels, LABELS)


def group(path):
    zarr.open_group(str(path), mode="w")
    return path


def a_file(path):
    path.write_bytes(b"packed")
    return path


def nothing(path):
    path.mkdir()
    return path


def broken(path):
    stored(path)
    for chunk in [each for each in path.rglob("*") if each.is_file() and not each.name.startswith((".", "zarr"))]:
        chunk.write_bytes(b"no chunk")
    return path


@pytest.mark.parametrize("make", [group, a_file, nothing, broken], ids=lambda make: make.__name__)
def test_what_is_none_is_one_line(make, tmp_path):
    path = make(tmp_path / "rock.zarr")
    with pytest.raises(ValueError, match="rock.zarr") as told:
        read_image(path, voxel=1.0, materials=MATERIALS)
    assert "\n" not in str(told.value) and len(str(told.value)) < 300


def test_of_labels_only(tmp_path):
    with pytest.raises(ValueError, match=r"rock.zarr: Image.labels of type float64"):
        read_image(stored(tmp_path / "rock.zarr", LABELS + 0.5), voxel=1.0, materials=MATERIALS)
