"""Only here: principal conductivities of a file turned the other way, tensors and tables in other units."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import Dependence, Material, Scene, orthotropic
from demheat.io import scenes

HEAD = 'size = [1, 1, 1]\nmatrix = "m"\n[walls]\n"x-" = "20 degC"\n"x+" = "30 degC"\n[materials.m]\n'


def read(folder, text):
    (folder / "scene.toml").write_text(HEAD + text)
    return scenes.read(folder / "scene.toml").matrix


def test_three_numbers_are_principal_ones(tmp_path):
    assert read(tmp_path, "conductivity_mW_mK = [1000, 2000, 3000]") == Material(np.diag([1.0, 2.0, 3.0]))
    turned = read(tmp_path, "conductivity = [1, '2 W/(m K)', 3]\nrotation_deg = [0, 0, 30]")
    assert turned == Material(orthotropic(1, 2, 3, rotation=(0, 0, math.radians(30))))
    # x turned towards y by 30 degrees.
    assert_allclose(turned.tensor[0, 0], 1 * 0.75 + 2 * 0.25, rtol=1e-14)
    assert_allclose(turned.tensor[0, 1], (1 - 2) * math.sqrt(0.75) / 2, rtol=1e-14)


def test_three_times_three_are_a_tensor(tmp_path):
    found = read(tmp_path, "conductivity_mW_mK = [[1, 0, 0], [0, 2, 0.5], [0, 0.5, '3']]".replace("'3'", "3"))
    assert_allclose(found.tensor, [[0.001, 0, 0], [0, 0.002, 0.0005], [0, 0.0005, 0.003]], rtol=1e-15)
    assert read(tmp_path, "conductivity = [[2, 0, 0], [0, 2, 0], [0, 0, 2]]") == Material(2.0)


def test_pairs_are_a_dependence(tmp_path):
    own = Material(2.0, dependence=Dependence([(20.0, 1.0), (100.0, 0.8)]))
    assert read(tmp_path, "conductivity = 2\ndependence_C = [[20, 1], [100, 0.8]]") == own
    assert read(tmp_path, "conductivity = 2\ndependence = [['20 degC', 1], ['100 degC', 0.8]]") == own


def test_a_table_of_conductivities_is_a_dependence(tmp_path):
    own = Material(45.0, dependence=Dependence([(20.0, 1.0), (400.0, 38.0 / 45.0)]))
    assert read(tmp_path, "conductivity_at_C = [[20, 45], [400, 38]]") == own
    words = "conductivity_at = [['20 degC', '45 W/(m K)'], ['400 degC', '38000 mW/(m K)']]"
    assert read(tmp_path, words) == own


@pytest.mark.parametrize("load", [{"walls": {"x-": 0.1, "x+": 7.0}}, {"gradient": (1.0, 0.0, 0.0)}])
def test_what_is_written_is_read_back_to_the_bit(tmp_path, load):
    bent = Material(orthotropic(1, 1 / 3, 1e-3, rotation=(0.1, 2.0, -0.7)), 1000.0, 900.0)
    warm = {} if "gradient" in load else {"dependence": [(0.1, 1 / 3), (7.7, 2.0)]}
    scene = Scene((1, 1, 1), Material(bent.conductivity, **warm), **load)
    scenes.write(scene, tmp_path / "scene.toml")
    assert scenes.read(tmp_path / "scene.toml") == scene


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("conductivity = [1, 2]", 7, "conductivity = [1, 2]: must be a number, three of them"),
        ("conductivity_at = [[20, 0]]", 7, "conductivity_at = [[20, 0]]: must be pairs [temperature, conductivity]"),
        (
            "conductivity_at = [[20, 1]]\nconductivity = 2",
            8,
            "conductivity: conductivity_at tells it; must be left out",
        ),
        ("conductivity_at = [['20 degC', '3 mm']]", 7, "unit 'mm' does not fit; must be one like W/(m K)"),
        ("conductivity = 2\nrotation_deg = [0, 0, 30]", 8, "rotation_deg: turns three principal conductivities"),
        ("conductivity = [[1, 0, 0], [0, 2, 5], [0, 5, 3]]", 7, "symmetric positive definite"),
        (
            "conductivity = [[1, 0, 0],\n[0, 2, 5],\n[0, 3]]",
            9,
            "conductivity[2] = [0, 3]: must be a number, three of them",
        ),
        (
            "conductivity = [[1, 0, 0],\n[0, 2, 5],\n[0, 3, 'x']]",
            9,
            "conductivity[2][2] = 'x': must be a number, or text",
        ),
        (
            "conductivity = 2\ndependence_C = [[20, 1],\n[100, -0.8]]",
            8,
            "must be two or more pairs (temperature, factor)",
        ),
        ("conductivity = 2\ndependence_C = [[20, 1],\n[100]]", 9, "dependence_C[1] = [100]: must be pairs"),
        ("conductivity = 2\ndependence_C = [[20, 1],\n[100, 'x']]", 9, "dependence_C[1][1] = 'x': must be a number"),
        ("conductivity = 2\ndependence = [[20, 1], [100, 2]]", 4, "all temperatures of a file must be of one scale"),
    ],
)
def test_what_is_wrong_is_one_line_with_its_place(tmp_path, text, line, words):
    with pytest.raises(ValueError, match=rf"scene.toml:{line}: ") as error:
        read(tmp_path, text)
    assert words in str(error.value) and "\n" not in str(error.value)


def test_a_cell_says_that_it_has_no_level(tmp_path):
    text = "size = [1, 1, 1]\ngradient = [1, 0, 0]\n[matrix]\nconductivity = 2\ndependence = [[20, 1], [100, 2]]\n"
    (tmp_path / "cell.toml").write_text(text)
    with pytest.raises(ValueError, match="cell.toml.*no level"):
        scenes.read(tmp_path / "cell.toml")
