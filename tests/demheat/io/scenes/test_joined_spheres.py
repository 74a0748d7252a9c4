"""Only here: spheres of a table that overlap, joined with others than those, or not through a periodic face."""

import numpy as np
import pytest

from demheat.io import scenes

HEAD = """size = [1, 1, 1]
matrix = "m"
{load}
[materials]
m = {{conductivity = 1}}
g = {{conductivity = 5}}
h = {{conductivity = 7}}
[[inclusions]]
file = "s.csv"
material = "g"
{more}
"""
CENTERS, RADIUS = np.random.default_rng(2).random((12, 3)), 0.14


def read(folder, rows, *, more="join = true", load="gradient = [0, 1, 0]", head="x,y,z,radius"):
    text = "\n".join([head, *(",".join(map(str, row)) for row in rows)])
    (folder / "s.csv").write_text(text + "\n", encoding="utf-8")
    (folder / "scene.toml").write_text(HEAD.format(load=load, more=more), encoding="utf-8")
    return scenes.read(folder / "scene.toml")


@pytest.mark.parametrize("periodic", [True, False])
def test_groups_are_bodies(tmp_path, periodic):
    # Between walls all keep off them; in the cell groups reach through its faces.
    centers = CENTERS if periodic else 0.15 + 0.7 * CENTERS
    load = "gradient = [0, 1, 0]" if periodic else 'walls = {"y-" = 0, "y+" = 1}'
    scene = read(tmp_path, [(*row, RADIUS) for row in centers], load=load)
    assert {shape.kind for shape in scene.inclusions} == ({"union", "sphere"} if periodic else {"union"})
    points = np.random.default_rng(3).random((5000, 3))
    apart = points[:, None] - centers
    apart -= np.round(apart) if periodic else 0
    inside = (np.linalg.norm(apart, axis=2) < RADIUS).any(axis=1)
    assert 0.05 < inside.mean() < 0.2 and np.array_equal(scene.phase_at(points) > 0, inside)


def test_what_overlaps_is_told_what_helps(tmp_path):
    rows = [(0.4, 0.5, 0.5, 0.2), (0.6, 0.5, 0.5, 0.2)]
    # The worst pair of three decides; of .9 it is .555, rounded down.
    three = [*rows, (0.1, 0.5, 0.5, 0.21)]
    for more, told in (("", 0.5), ("radius_factor = 0.9", 0.499)):
        with pytest.raises(
            ValueError, match=rf"overlap partially.*; radius_factor = {told} will mend it, or join = tr"
        ):
            read(tmp_path, three, more=more)
    assert len(read(tmp_path, three, more="radius_factor = 0.5").inclusions) == 3
    assert [each.kind for each in read(tmp_path, rows).inclusions] == ["union"]
    assert [each.kind for each in read(tmp_path, rows, more="radius_factor = 0.49").inclusions] == ["sphere"] * 2
    with pytest.raises(ValueError, match="s.csv:2: overlaps a sphere of another material"):
        read(tmp_path, [(*rows[0], "g"), (*rows[1], "h")], head="x,y,z,radius,material")
    # One alone, and its resistance.
    (one,) = read(tmp_path, rows[:1], more="join = true\nresistance = 0.5").inclusions
    assert (one.kind, one.resistance) == ("sphere", 0.5)
    (both,) = read(tmp_path, rows, more="join = true\nresistance = 0.5").inclusions
    assert both.resistance == 0.5 and not any(each.resistance for each in both.shapes)
