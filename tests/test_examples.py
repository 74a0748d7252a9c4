"""Ready scenes: each is read and solved; what their comments say of them is so."""

import re
from pathlib import Path

import pytest

from demheat.io import scenes
from demheat.terminal.commands import main
from demheat.terminal.commands.bounds import bounds_of
from references import exact, fft, multipole

FOLDER = Path(__file__).parents[1] / "examples"
SCENES = sorted(FOLDER.glob("*.toml"))


# Voxels of a sixteenth are coarse, and balls of a bed nearly touch.
@pytest.mark.filterwarnings("ignore:gaps beside inclusions")
@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_an_example_is_solved(path, capsys):
    """By voxels, coarsely: between the bounds that hold for all bodies."""
    scene = scenes.read(path)
    (bound, *_) = bounds_of(scene)
    k = fft.solve(scene, voxels=16).conductivity
    # Laminates along an axis attain the harmonic mean; the solver's tolerance is far below.
    assert bound.lower * (1 - 1e-6) <= k < bound.upper
    assert main(["solve", str(path), "--method", "maxwell"]) in (0, 1)


def test_the_balls_are_those_of_the_dump():
    scene = scenes.read(FOLDER / "packed_bed.toml")
    # 2.33 mm less 2 %; the corner of the box of the dump, -5 -5 0, is that of the scene.
    assert {round(ball.radius, 12) for ball in scene.inclusions} == {2.2834e-3}
    assert {round(c, 9) for ball in scene.inclusions for c in ball.center} == {2.32e-3, 5e-3, 7.68e-3}


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_commands_in_comments_are_commands(path, capsys):
    """But for what they cost: their words are read, and their scene is there."""
    lines = re.findall(r"(?m)^#     demheat (.*)$", path.read_text(encoding="utf-8"))
    assert lines
    from demheat.terminal.commands.options import parser

    for line in lines:
        options = parser("0").parse_args(line.split())
        assert FOLDER.parent / options.scene == path


def test_the_sphere_is_the_array_that_its_comment_says():
    path = FOLDER / "sphere_in_cube.toml"
    said = float(re.search(r"is known: ([\d.]+) W", path.read_text(encoding="utf-8"))[1])
    # As many digits as are said.
    assert abs(exact.solve(scenes.read(path)).conductivity - said) < 1e-6


def test_the_wall_is_a_series_of_resistances(capsys):
    path = FOLDER / "layered_wall.toml"
    scene = scenes.read(path)
    resistance = 0.015 / 0.7 + 0.24 / 0.5 + 0.14 / 0.035 + 0.01 / 0.87
    # Rounding.
    assert abs(exact.solve(scene).conductivity * resistance / 0.405 - 1) < 1e-12
    assert main(["solve", str(path), "--method", "exact"]) == 0
    assert f"heat at x-    {25 / resistance * 0.04:.6g} W" in capsys.readouterr().out


def test_the_beads_are_those_of_the_table():
    scene = scenes.read(FOLDER / "composite.toml")
    assert len(scene.inclusions) == 20 and {bead.material.conductivity for bead in scene.inclusions} == {1.05}
    _, isotropic = bounds_of(scene)
    # A cell of twenty spheres is isotropic to a few per cent.
    assert isotropic.lower * 0.97 < multipole.solve(scene).conductivity < isotropic.upper * 1.03
