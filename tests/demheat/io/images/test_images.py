"""Only here: image files turned, mirrored or cut short and taken, and errors that name no file."""

import sys

import numpy as np
import pytest
import tifffile

from demheat import Material
from demheat.io import images, scenes
from demheat.io.images import read_image
from demheat.scene import Scene

nrrd = pytest.importorskip("nrrd")

MATERIALS = {0: Material(1.0), 1: Material(5.0), 200: Material(0.0)}
LABELS = np.random.default_rng(5).choice(list(MATERIALS), (5, 4, 3)).astype(np.uint8)
HEADER = """ObjectType = Image
NDims = 3
DimSize = 5 4 3
ElementSpacing = 0.002 0.001 0.004
ElementType = {kind}
{more}ElementDataFile = {data}
"""


def npy(path):
    np.save(path / "x.npy", LABELS)
    return path / "x.npy"


def npy_fortran(path):
    np.save(path / "f.npy", np.asfortranarray(LABELS.astype(np.int64)))
    return path / "f.npy"


def tiff(path, name="x.tif", labels=LABELS, **how):
    # Pages are z, rows y, columns x.
    tifffile.imwrite(path / name, np.ascontiguousarray(labels.T), photometric="minisblack", **how)
    return path / name


def tiff_packed(path):
    return tiff(path, "p.tiff", compression="zlib")


def tiff_large_first(path):
    return tiff(path, "b.tif", LABELS.astype(np.uint16), byteorder=">")


def tiff_apart(path):
    """Pages with something between them."""
    with tifffile.TiffWriter(path / "a.tif") as file:
        for page in LABELS.T:
            file.write(np.ascontiguousarray(page), photometric="minisblack", contiguous=False, metadata=None)
    return path / "a.tif"


def meta(path, kind="MET_UCHAR", more="", data="x.raw", dtype="<u1", before=b""):
    (path / data).write_bytes(before + LABELS.astype(dtype).tobytes(order="F"))
    (path / "x.mhd").write_text(HEADER.format(kind=kind, more=more, data=data))
    return path / "x.mhd"


def meta_large_first(path):
    return meta(path, "MET_SHORT", "BinaryDataByteOrderMSB = True\n", dtype=">i2")


def meta_behind(path):
    return meta(path, "MET_INT", "HeaderSize = -1\n", dtype="<i4", before=b"what a scanner said")


def meta_local(path):
    header = HEADER.format(kind="MET_UCHAR", more="", data="LOCAL").encode()
    (path / "x.mha").write_bytes(header + LABELS.tobytes(order="F"))
    return path / "x.mha"


def nrrd_file(path, name="x.nrrd", labels=LABELS, **header):
    header = {"spacings": [2.0, 1.0, 4.0], "units": ["um", "um", "um"]} | header
    nrrd.write(str(path / name), labels, header)
    return path / name


VOXEL = (2e-6, 1e-6, 4e-6)
TELLING = (meta, meta_large_first, meta_behind, meta_local, nrrd_file)
SILENT = (npy, npy_fortran, tiff, tiff_packed, tiff_large_first, tiff_apart)


@pytest.mark.parametrize("make", [*SILENT, *TELLING], ids=lambda make: make.__name__)
def test_every_format_gives_the_same_image(make, tmp_path):
    image = read_image(make(tmp_path), materials=MATERIALS, voxel=VOXEL if make in SILENT else None)
    assert np.array_equal(image.labels, LABELS) and image.labels.dtype == np.uint8
    assert image.voxel == pytest.approx(VOXEL, rel=1e-15)
    assert image.phases == tuple(MATERIALS.values())


@pytest.mark.parametrize("make", [npy, tiff, tiff_large_first, meta, meta_local], ids=lambda make: make.__name__)
def test_what_is_plain_is_mapped(make, tmp_path):
    """Not read as a whole: slabs of it pass into the image."""
    path = make(tmp_path)
    labels, _ = images.READERS[path.suffix](path)
    assert isinstance(labels, np.memmap)


def test_a_single_page_is_one_voxel_thick(tmp_path):
    path = tiff(tmp_path, labels=LABELS[:, :, :1])
    image = read_image(path, materials=MATERIALS, voxel=1.0)
    assert image.shape == (5, 4, 1) and np.array_equal(image.labels, LABELS[:, :, :1])


def bad_npy(path):
    (path / "x.npy").write_bytes(b"\x93NUMPY, or not")
    return path / "x.npy"


def cut(make, left):
    def made(path):
        file = make(path)
        file.write_bytes(file.read_bytes()[:left])
        return file

    return made


def cut_raw(path):
    file = meta(path)
    (path / "x.raw").write_bytes(b"\0" * 59)
    return file


def without_raw(path):
    file = meta(path)
    (path / "x.raw").unlink()
    return file


def mhd(text):
    def made(path):
        meta(path)
        (path / "x.mhd").write_text(text)
        return path / "x.mhd"

    return made


def objects(path):
    np.save(path / "x.npy", np.array([{}, None], dtype=object), allow_pickle=True)
    return path / "x.npy"


def colour(path):
    tifffile.imwrite(path / "x.tif", np.zeros((4, 6, 3), np.uint8), photometric="rgb")
    return path / "x.tif"


def two_stacks(path):
    with tifffile.TiffWriter(path / "x.tif") as file:
        file.write(np.zeros((4, 6), np.uint8), photometric="minisblack")
        file.write(np.zeros((5, 6), np.uint8), photometric="minisblack")
    return path / "x.tif"


def saved(array):
    def made(path):
        np.save(path / "x.npy", array)
        return path / "x.npy"

    return made


def named(name):
    return lambda path: path / name


BASE = HEADER.format(kind="MET_UCHAR", more="", data="x.raw")
BAD = {
    "no such file": (named("x.npy"), "there is no such file"),
    "a folder": (lambda path: (path / "x.tif").mkdir() or path / "x.tif", "must be a regular file"),
    "unknown suffix": (named("x.png"), "must end in one of .npy, .tif"),
    "no npy": (bad_npy, "no array of NumPy"),
    "objects": (objects, "no array of NumPy"),
    "floats": (saved(LABELS.astype(float)), "labels of type float64: must be whole numbers"),
    "unknown label": (saved(LABELS + 1), "none for labels 2, 201 of the image; must have one for each"),
    "no tiff": (lambda path: bad_npy(path).rename(path / "x.tif"), "no TIFF, or a part of one"),
    "truncated packed tiff": (cut(tiff_packed, 200), "no TIFF, or a part of one"),
    "colour": (colour, "3 channels of colour"),
    "two stacks": (two_stacks, "2 images of unlike shapes"),
    "truncated raw": (cut_raw, "has 59 bytes; 5 x 4 x 3 voxels of uint8 take 60"),
    "no raw": (without_raw, "there is no such file"),
    "truncated mha": (cut(meta_local, 180), "bytes; 5 x 4 x 3 voxels"),
    "no header": (mhd("grains\n"), "x.mhd:1: no line of a MetaImage: 'grains'"),
    "two sizes": (mhd(BASE.replace("5 4 3", "5 4")), "DimSize = 5 4: must be three whole numbers"),
    "type": (mhd(BASE.replace("MET_UCHAR", "MET_HALF")), "ElementType = MET_HALF: must be one of MET_CHAR"),
    "packed": (mhd("CompressedData = True\n" + BASE), "packed data or several channels"),
    "list": (mhd(BASE.replace("x.raw", "LIST")), "ElementDataFile = LIST: must be one file"),
    "header size": (mhd("HeaderSize = -7\n" + BASE), "HeaderSize = -7: must be a whole number >= -1"),
    "no nrrd": (lambda path: bad_npy(path).rename(path / "x.nrrd"), "no NRRD, or a part of one"),
    "truncated nrrd": (cut(nrrd_file, 90), "no NRRD, or a part of one"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_broken_file_is_one_line(name, tmp_path):
    make, words = BAD[name]
    path = make(tmp_path)
    with pytest.raises(ValueError) as caught:
        read_image(path, materials=MATERIALS, voxel=1e-6)
    told = str(caught.value)
    assert words in told and told.startswith(str(tmp_path)) and "\n" not in told


def test_a_cut_file_is_no_thinner_body(tmp_path):
    """Wherever it ends: tifffile would log that pages are missing, and go on with those that are there."""
    path = tiff_apart(tmp_path)
    data, refused = path.read_bytes(), 0
    ends = range(0, len(data), 8)
    for end in ends:
        path.write_bytes(data[:end])
        try:
            labels = read_image(path, materials=MATERIALS, voxel=1.0).labels
        except ValueError as error:
            refused += 1
            assert str(error).startswith(str(path)) and "\n" not in str(error)
        else:
            # What is cut off says nothing of pages.
            assert np.array_equal(labels, LABELS)
    assert refused > len(ends) / 2


@pytest.mark.parametrize("voxel", [0.0, (1.0, 1.0)])
def test_bad_voxels(voxel, tmp_path):
    with pytest.raises(ValueError, match=r"x.npy: Image.voxel = "):
        read_image(npy(tmp_path), materials=MATERIALS, voxel=voxel)


@pytest.mark.parametrize("make", [npy, tiff, lambda path: nrrd_file(path, units=["parsec"] * 3)])
def test_a_voxel_must_be_known(make, tmp_path):
    with pytest.raises(ValueError, match="does not tell the edges of a voxel"):
        read_image(make(tmp_path), materials=MATERIALS)


@pytest.mark.parametrize("make, library", [(tiff, "tifffile"), (nrrd_file, "nrrd")])
def test_a_library_that_is_not_there(make, library, tmp_path, monkeypatch):
    path = make(tmp_path)
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(ImportError, match=r"pip install \w+, or demheat\[images\]"):
        read_image(path, materials=MATERIALS, voxel=1.0)


def test_what_does_not_fit_is_not_read(tmp_path, monkeypatch):
    monkeypatch.setattr("demheat.runtime.limits.free_memory", lambda: 10.0)
    monkeypatch.setattr("demheat.runtime.limits.ALWAYS", 1)
    for make in (npy, tiff_packed, nrrd_file):
        with pytest.raises(ValueError, match="GiB of memory or more"):
            read_image(make(tmp_path), materials=MATERIALS, voxel=1.0)


SCENE = """gradient_K_mm = [0, 1, 0]
[image]
file = "x.tif"
voxel_um = [2, 1, 4]
[materials.0]
conductivity = 1
[materials.1]
conductivity = 5
[materials.200]
conductivity = 0
"""


def scene_file(path, text=SCENE):
    tiff(path)
    (path / "scene.toml").write_text(text)
    return path / "scene.toml"


def test_a_scene_of_an_image(tmp_path):
    scene = scenes.read(scene_file(tmp_path))
    assert scene.image == read_image(tmp_path / "x.tif", materials=MATERIALS, voxel=VOXEL)
    assert scene == Scene.of_image(scene.image, gradient=(0.0, 1000.0, 0.0))
    text = SCENE.replace("voxel_um = [2, 1, 4]", 'voxel = "3 um"')
    assert scenes.read(scene_file(tmp_path, text)).image.voxel == (3e-6,) * 3


def test_what_is_written_is_read_back(tmp_path):
    scene = scenes.read(scene_file(tmp_path))
    scenes.write(scene, tmp_path / "again.toml")
    assert scenes.read(tmp_path / "again.toml") == scene
    assert sorted(each.name for each in tmp_path.iterdir()) == ["again.npy", "again.toml", "scene.toml", "x.tif"]


@pytest.mark.parametrize(
    "old, new, words",
    [
        ("x.tif", "x.tiff", ":3: image.file = 'x.tiff': there is no such file; did you mean 'x.tif'?"),
        ("[materials.200]", "[materials.pore]", ":9: materials.pore: must be a label of the image, a whole number"),
        ("[materials.200]", "[materials.201]", ":3: image.file = 'x.tif': materials: none for labels 200"),
        ("gradient", "size_mm = [1, 1, 1]\ngradient", ":1: size_mm: with an image, which has it itself"),
        ("gradient", 'matrix = "0"\ngradient', ":1: matrix: with an image"),
        ("voxel_um = [2, 1, 4]", "voxel_um = 0", ":4: image.voxel_um = 0: voxel = 0"),
        ("voxel_um = [2, 1, 4]", "voxel_um = [2, 1]", ":4: image.voxel_um = [2, 1]: voxel = "),
        ("voxel_um = [2, 1, 4]", "", ":3: image.file = 'x.tif': does not tell the edges of a voxel"),
        ("voxel_um", "voxels_um", ":4: image.voxels_um: no such key here; did you mean 'voxel_um'?"),
        ("gradient_K_mm = [0, 1, 0]", "", "neither given"),
        ("gradient_K_mm = [0, 1, 0]", "gradient_K_mm = [0, 0, 0]", ":1: gradient_K_mm = [0, 0, 0]: must not be zero"),
    ],
)
def test_bad_scenes_of_images(old, new, words, tmp_path):
    path = scene_file(tmp_path, SCENE.replace(old, new))
    with pytest.raises(ValueError) as caught:
        scenes.read(path)
    assert words in str(caught.value) and "\n" not in str(caught.value)
