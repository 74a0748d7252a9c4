"""The files of the benchmark: their form, their checksums, and that they stand by themselves."""

import copy
import hashlib
import json

import numpy as np
import pytest

import benchmark
from benchmark import make, parts
from benchmark.schema import faults
from demheat.io import known

NAMES = benchmark.names()
SCHEMA = json.loads((make.HOME / "schema.json").read_text(encoding="utf-8"))
PAINTED = [name for name in NAMES if "image" in benchmark.read(name)]


@pytest.mark.parametrize("name", NAMES)
def test_a_file_fits_the_schema(name):
    table = benchmark.read(name)
    assert faults(table, SCHEMA) == [] and table["name"] == name


def test_there_are_thirty_and_more_of_every_kind():
    groups = {name: benchmark.read(name)["group"] for name in NAMES}
    assert len(NAMES) >= 30
    assert set(groups.values()) == {
        *("cubic arrays", "coated spheres", "laminates", "patterns of the plane", "fibres", "dispersions"),
        *("certain bounds", "transients", "NAFEMS", "published images"),
    }
    assert benchmark.names(group="NAFEMS") == ["nafems-t2", "nafems-t3", "nafems-t4"]


def test_checksums_and_the_table_are_those_of_the_files():
    assert (make.HOME / "SHA256SUMS").read_text(encoding="utf-8") == make.sums()
    page = (make.HOME / "README.md").read_text(encoding="utf-8")
    assert page.partition(make.BEGIN)[2].partition(make.END)[0].strip() == make.page().strip()


@pytest.mark.parametrize("name", [name for name in NAMES if "voxels" not in benchmark.read(name)["scene"]])
def test_a_scene_read_and_written_is_the_same(name):
    scene, known = benchmark.load(name)
    assert json.loads(json.dumps(parts.table_of(scene))) == benchmark.read(name)["scene"]
    if known.conductivity is not None:
        # Digits: seven at least, where nothing but certain bounds or print stand behind it.
        assert known.error < 1e-6 * known.conductivity * 2 or known.by in ("certain bounds", "published")
    assert len(known.positions) == len(known.temperature)
    assert known.conductivity is not None or len(known.temperature) >= 3


def painted(table, shape):
    """Labels by what README.md says, of the file alone."""
    scene = table["scene"]
    size, periodic = np.array(scene["size"]), "gradient" in scene
    x = (np.stack(np.indices(shape), axis=-1) + 0.5) / shape * size
    found = np.zeros(shape, np.uint8)
    for each in scene["inclusions"]:
        if each["shape"] == "layer":
            along = x[..., "xyz".index(each["axis"])]
            inside = (along > each["start"]) & (along < each["stop"])
        else:
            off = x - each["center"]
            if periodic:
                off -= size * np.round(off / size)
            if each["shape"] == "sphere":
                inside = np.sum(off**2, axis=-1) < each["radius"] ** 2
            elif each["shape"] == "cylinder":
                axis = np.array(each["axis"]) / np.linalg.norm(each["axis"])
                across = off - np.sum(off * axis, axis=-1, keepdims=True) * axis
                inside = np.sum(across**2, axis=-1) < each["radius"] ** 2
            else:
                inside = np.all(np.abs(off) < np.array(each["sides"]) / 2, axis=-1)
        found[inside] = each["material"]
    return found


@pytest.mark.parametrize("name", PAINTED)
def test_an_image_is_painted_from_the_words_of_the_page(name):
    table = benchmark.read(name)
    found = painted(table, table["image"]["voxels"])
    assert hashlib.sha256(found.tobytes()).hexdigest() == table["image"]["sha256"]
    assert np.bincount(found.ravel()).tolist() == table["image"]["counts"]


@pytest.mark.parametrize("name", ["coated-hollow", "fibres-hexagonal-f50-s10", "dispersion-unlike"])
def test_our_painter_agrees_and_no_centre_is_at_an_interface(name):
    scene, _ = benchmark.load(name)
    assert json.loads(json.dumps(make.image(scene))) == benchmark.read(name)["image"]
    image = parts.image_of(scene, (8, 8, 8))
    assert image.size == pytest.approx(scene.size) and image.labels.max() >= 1


def test_an_interface_at_the_centre_of_a_voxel_is_refused():
    scene, _ = benchmark.load("laminate-across")
    table = copy.deepcopy(benchmark.read("laminate-across"))
    table["scene"]["inclusions"][0]["stop"] = 0.5 + 0.5 / 32
    with pytest.raises(ValueError, match="passes the centre of a voxel"):
        make.image(known.scene_of(table))
    assert make.image(scene)["counts"] == [16384, 16384]


@pytest.mark.parametrize(
    "change, told",
    [
        (lambda table: table.pop("known"), ": lacks 'known'"),
        (lambda table: table.update(licence="other"), "licence: breaks const"),
        (lambda table: table["scene"].update(colour=1), "scene.colour: is not known"),
        (lambda table: table["scene"].update(size=[1.0, 1.0]), "scene.size: breaks minItems 3"),
        (lambda table: table["scene"]["inclusions"][0].update(radius=-1), "radius: breaks exclusiveMinimum"),
        (lambda table: table["scene"]["inclusions"][0].update(shape="cone"), "scene.inclusions[0]: fits 0 of 4 forms"),
        (lambda table: table["scene"]["walls"].update(up={"temperature": 1.0}), "scene.walls.up (its name)"),
        (lambda table: table["scene"]["materials"][0].update(conductivity="1"), "conductivity: fits 0 of 2"),
        (lambda table: table["known"]["conductivity"].update(error=0.0), "error: breaks exclusiveMinimum"),
        (lambda table: table.update(name="Sc 1"), "name: breaks pattern"),
    ],
)
def test_what_a_broken_file_lacks_is_said(change, told):
    table = benchmark.read("sc-third-s10")
    change(table)
    assert told in " ".join(faults(table, SCHEMA))


def test_a_schema_of_unknown_words_is_refused():
    with pytest.raises(ValueError, match="multipleOf"):
        faults(1, {"multipleOf": 2})


def test_unknown_names_are_refused():
    with pytest.raises(ValueError, match="name = 'sc-third': must be one of ball-step"):
        benchmark.load("sc-third")


def test_an_image_that_is_not_shipped_is_asked_for_and_checked(tmp_path):
    with pytest.raises(ValueError, match="give the path of its labels: github.com/tldr-group/taufactor"):
        benchmark.load("taufactor-500-x")
    labels = np.zeros((2, 3, 4), np.uint8)
    labels[1, 2, 3] = 255
    np.save(tmp_path / "labels.npy", labels)
    with pytest.raises(ValueError, match=r"shape \(2, 3, 4\) and SHA-256 .*must be \(500, 500, 500\) and 3cf0038d"):
        benchmark.load("taufactor-500-x", image=tmp_path / "labels.npy")
    table = benchmark.read("taufactor-500-x")
    own = {"shape": [2, 3, 4], "voxel": 0.1, "sha256": hashlib.sha256(labels.tobytes()).hexdigest()}
    table["scene"]["voxels"] |= own
    scene = known.scene_of(table, image=tmp_path / "labels.npy")
    assert scene.conductivities.tolist() == [0.0, 1.0] and scene.phase_at([[0.15, 0.25, 0.35]]).tolist() == [1]
