"""Only here: images of zarr in another order, or packed in ways that are not read."""

import numpy as np
import pytest

from demheat import Material, Scene
from demheat.io import scenes
from demheat.io.images import read_image
from references import fft

zarr = pytest.importorskip("zarr", minversion="3")
numcodecs = pytest.importorskip("numcodecs")

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
    assert np.array_equal(scenes.read(tmp_path / "rock.toml").image.labels, LABELS)


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


CODECS = numcodecs.Zlib(), numcodecs.GZip(), numcodecs.BZ2(), numcodecs.LZMA(), numcodecs.Blosc(), numcodecs.LZ4()


@pytest.mark.parametrize("packer", [None, numcodecs.Zstd(), *CODECS], ids=lambda each: each and each.codec_id)
def test_codecs_of_version_2(packer, tmp_path):
    path, few = tmp_path / "rock.zarr", packer in (None, CODECS[0], CODECS[4])
    filters, mark = ([numcodecs.Shuffle(8)], "/") if few else (None, ".")
    how = {"zarr_format": 2, "compressors": packer, "filters": filters, "shards": None}
    how |= {"chunk_key_encoding": {"name": "v2", "separator": mark}}
    array = zarr.create_array(str(path), shape=LABELS.shape, chunks=(4, 8, 4), dtype="<i8", **how)
    array[:] = LABELS
    assert np.array_equal(read_image(path, voxel=1e-3, materials=MATERIALS).labels, LABELS)


OF_3 = [(), zarr.codecs.GzipCodec(), zarr.codecs.ZstdCodec(), zarr.codecs.BloscCodec()]
OF_3 += [(zarr.codecs.GzipCodec(), zarr.codecs.Crc32cCodec()), zarr.codecs.Crc32cCodec()]


@pytest.mark.parametrize("packers", OF_3, ids=str)
def test_codecs_of_version_3(packers, tmp_path):
    path, keys = tmp_path / "rock.zarr", "v2" if packers == () else "default"
    how = {"filters": [zarr.codecs.TransposeCodec(order=(2, 0, 1))], "chunk_key_encoding": {"name": keys}}
    array = zarr.create_array(str(path), shape=LABELS.shape, chunks=(4, 4, 4), dtype="i2", compressors=packers, **how)
    array[:] = LABELS
    assert np.array_equal(read_image(path, voxel=1e-3, materials=MATERIALS).labels, LABELS)


@pytest.mark.parametrize("packer", [numcodecs.Zstd(), *CODECS], ids=lambda each: each.codec_id)
def test_a_chunk_that_expands(packer, tmp_path):
    path = tmp_path / "rock.zarr"
    zarr.create_array(str(path), shape=(2, 2, 2), chunks=(2, 2, 2), dtype="u1", zarr_format=2, compressors=packer)
    (path / "0.0.0").write_bytes(packer.encode(bytes(2**17)))
    # What zlib has packed cannot become large from so little, and is looked at as it is read.
    words = "zarr array, or a part of one" if packer.codec_id in ("zlib", "gzip") else "expand to more than 12 bytes"
    with pytest.raises(ValueError, match=words):
        read_image(path, voxel=1e-3, materials=MATERIALS)


def test_shards_are_refused(tmp_path):
    path = tmp_path / "rock.zarr"
    zarr.create_array(str(path), shape=(8, 8, 8), chunks=(2, 2, 2), shards=(4, 4, 4), dtype="u1")
    with pytest.raises(ValueError, match="the codec 'sharding_indexed' is none"):
        read_image(path, voxel=1e-3, materials=MATERIALS)


def test_version_2_of_the_library_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(zarr, "__version__", "2.18.3")
    with pytest.raises(ImportError, match="rock.zarr: zarr 2.18.3 is installed; must be 3 or later"):
        read_image(stored(tmp_path / "rock.zarr"), voxel=1e-3, materials=MATERIALS)
