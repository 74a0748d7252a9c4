"""Surfaces out of files, in Python and in TOML: the body that was written, in its unit, or one sentence."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from surface_bodies import brick, ring

from demheat import Material, Scene, SurfaceMesh
from demheat.io import scenes
from demheat.io.scenes.write import text_of_scene
from demheat.io.surfaces import read_surface

GOOD = Material(5.0)


def written(path, vertices, triangles, kind="triangle"):
    meshio = pytest.importorskip("meshio")
    meshio.Mesh(vertices, [(kind, triangles)]).write(path)
    return path


@pytest.mark.parametrize("ending", ["stl", "ply", "obj", "msh", "vtu"])
def test_formats(tmp_path, ending):
    vertices, triangles = ring()
    body = read_surface(written(tmp_path / f"ring.{ending}", 1000 * vertices, triangles), GOOD, unit="mm")
    # Some formats keep single precision.
    assert_allclose(body.bounds(), [vertices.min(axis=0), vertices.max(axis=0)], rtol=1e-6)
    assert len(body.triangles) == len(triangles)


def test_quadrangles_are_halved(tmp_path):
    vertices, _ = brick()
    quads = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
    body = read_surface(written(tmp_path / "brick.obj", vertices, quads, "quad"), GOOD, offset=(1, 0, 0))
    assert_allclose(body.volume, 0.5 * 0.375 * 0.75)
    assert_allclose(body.center, (1.5, 0.5, 0.5))


def test_what_is_no_surface_is_told(tmp_path):
    vertices, triangles = brick()
    with pytest.raises(ValueError, match="there is no such file"):
        read_surface(tmp_path / "none.stl", GOOD)
    with pytest.raises(ValueError, match=r"open.stl: not closed, 3 edges"):
        read_surface(written(tmp_path / "open.stl", vertices, triangles[1:]), GOOD)
    (tmp_path / "text.stl").write_text("solid nothing\n")
    (tmp_path / "text.ply").write_text("ply of nothing\n")
    for name in ("text.stl", "text.ply"):
        with pytest.raises(ValueError, match=name) as error:
            read_surface(tmp_path / name, GOOD)
        assert "\n" not in str(error.value)
    with pytest.raises(ValueError, match="unit = 'ft': must be one of m, mm"):
        read_surface(tmp_path / "open.stl", GOOD, unit="ft")


SCENE = """size = [1, 1, 1]
matrix = "base"
gradient = [0, 1, 0]
[materials.base]
conductivity = 1
[materials.good]
conductivity = 5
[[inclusions]]
shape = "surface mesh"
file = "brick.stl"
unit = "mm"
material = "good"
"""


def test_scene_files_name_them(tmp_path):
    vertices, triangles = brick()
    written(tmp_path / "brick.stl", 1000 * vertices, triangles)
    (tmp_path / "scene.toml").write_text(SCENE)
    scene = scenes.read(tmp_path / "scene.toml")
    assert_allclose(scene.inclusions[0].volume, 0.5 * 0.375 * 0.75, rtol=1e-6)
    for old, new, words in (
        ('"mm"', '"m"', r"scene.toml:8: inclusions\[0\]: vertices from .* seem to be in millimetres"),
        ("brick.stl", "brik.stl", r"scene.toml:10: inclusions\[0\].file = 'brik.stl': .*no such file; did you mean"),
        ('unit = "mm"', "size = 3", r"scene.toml:11: inclusions\[0\].size: no such key"),
    ):
        (tmp_path / "scene.toml").write_text(SCENE.replace(old, new))
        with pytest.raises(ValueError, match=words):
            scenes.read(tmp_path / "scene.toml")


def test_scene_files_are_written_with_their_triangles_beside(tmp_path):
    # Thirds are in no text of few digits.
    vertices, triangles = ring()
    own = SurfaceMesh(vertices / 3 + 1e-3 / 7, triangles, GOOD, resistance=1e-6)
    scene = Scene((1, 1, 1), Material(1.0), [own], gradient=(0, 1, 0))
    scenes.write(scene, tmp_path / "scene.toml")
    pytest.importorskip("meshio")
    (found,) = scenes.read(tmp_path / "scene.toml").inclusions
    assert np.array_equal(found.vertices, own.vertices) and np.array_equal(found.triangles, own.triangles)
    assert (found.material, found.resistance) == (GOOD, 1e-6)
    assert {each.name for each in tmp_path.iterdir()} == {"scene.toml", "scene-0.obj"}
    # What tells rows of one scene from those of another.
    moved = Scene((1, 1, 1), Material(1.0), [own.placed((0.5, 0.5, 0.5))], gradient=(0, 1, 0))
    assert text_of_scene(scene) == text_of_scene(scene) != text_of_scene(moved)
