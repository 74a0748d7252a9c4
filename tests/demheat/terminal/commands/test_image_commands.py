"""Only here: commands on an image that take it for shapes, or another image for the same."""

import re

import numpy as np
import pytest

from demheat import Image, Material, Scene
from demheat.io import scenes
from demheat.terminal.commands import main
from demheat.terminal.commands.bounds import bounds_of


@pytest.fixture
def path(tmp_path):
    labels = np.random.default_rng(4).choice([0, 3], (4, 5, 6))
    image = Image(labels, 1e-6, {0: Material(1.0), 3: Material(4.0)})
    scenes.write(Scene.of_image(image, gradient=(0.0, 1.0, 0.0)), tmp_path / "scene.toml")
    return tmp_path / "scene.toml"


def test_compare_an_image(path, tmp_path, capsys):
    words = ["compare", str(path), "--method", "fft,fem,maxwell", "--out", str(tmp_path / "out")]
    assert main(words) == 0
    told = capsys.readouterr().out
    assert "image of 4 x 5 x 6 voxels, 1 to 4 W/(m K)" in told and "voxels, certain" in told
    who = "images are for FFT, finite elements, the DEM and bounds on voxels\n"
    assert f"maxwell refused: Scene.image: formulas are of spheres in a matrix; {who}" in told
    rows = {line.split()[0]: line.split() for line in told.splitlines() if line.startswith(("fft ", "fem "))}
    bound = bounds_of(scenes.read(path))[-1]
    for value, low, high in (map(float, row[1:4]) for row in rows.values()):
        assert low < value < high and low < bound.upper and high > bound.lower
    assert (tmp_path / "out" / "scene.png").stat().st_size > 10_000
    # The same image is known again, another is not.
    main(words)
    assert capsys.readouterr().err == ""
    scene = scenes.read(path)
    turned = Scene.of_image(scene.image.turned((0, 1, 2)).turned((1, 0, 2)), gradient=scene.gradient)
    scenes.write(turned, path)
    main(words)
    assert "fft ..." in capsys.readouterr().err


def test_bounds_of_an_image_hold_each_other(path):
    general, isotropic, certain = bounds_of(scenes.read(path))
    assert general.lower < isotropic.lower < isotropic.upper < general.upper
    assert general.lower < certain.lower < certain.upper < general.upper


def test_three_labels_and_pores_have_fewer_bounds():
    labels = np.arange(8).reshape(2, 2, 2) % 3
    image = Image(labels, 1.0, {0: Material(1.0), 1: Material(2.0), 2: Material(0.0)})
    (general,) = bounds_of(Scene.of_image(image, gradient=(1, 0, 0)))
    assert general.lower == 0 and general.upper == pytest.approx((3 * 1 + 3 * 2) / 8)


def test_solve_writes(path, tmp_path):
    assert main(["solve", str(path), "--method", "fem", "--write", str(tmp_path / "x.vti")]) == 0
    assert (tmp_path / "x.vti").exists()


def test_effective_of_an_image_splits_its_voxels(path, capsys):
    assert main(["recommend", str(path), "--accuracy", "1e-2"]) == 0
    assert "voxels = 4 x 5 x 6" in capsys.readouterr().out
    assert main(["effective", str(path), "--accuracy", "2e-2"]) == 0
    told = capsys.readouterr().out
    k, half = (float(part) for part in re.search(r"^y .*?\+-.*? ([\d.]+) \+- ([\d.e-]+)", told, re.MULTILINE).groups())
    bound = bounds_of(scenes.read(path))[-1]
    assert bound.lower - half < k < bound.upper + half and half < 2e-2 * k
    assert "principal values, and their directions" in told and "by fft, tolerance = 0.001, voxels = " in told
