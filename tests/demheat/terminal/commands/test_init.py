"""Only here: a first scene that does not run, an example of the help that does not, help without a method."""

import re

import pytest
from spared import slow_but

from demheat.declared import all_methods
from demheat.io import scenes
from demheat.terminal.commands import helps, main
from demheat.terminal.commands.options import COMMANDS


def test_every_command_has_an_example():
    assert set(helps.EXAMPLES) == set(COMMANDS)


# Answers to be judged are of another program.
MADE = [name for name in helps.EXAMPLES if name != "judge"]


@pytest.mark.parametrize("name", slow_but(set(MADE) - {"report", "compare"}, MADE))
def test_an_example_works_in_an_empty_folder(name, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for line in helps.EXAMPLES[name].split(" && "):
        program, *rest = line.split()
        assert program == "demheat" and main(rest) == 0, capsys.readouterr().err
    assert capsys.readouterr().out.startswith("written scene.toml")


def test_what_comments_offer_is_valid(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["init", "first.toml"]) == 0
    text = (tmp_path / "first.toml").read_text(encoding="utf-8")
    assert "demheat solve first.toml" in text and "@" not in text
    bead = scenes.read("first.toml").inclusions[0]
    # Keys in comments, each for itself, are known in their tables; words about them stand behind another hash.
    offered = re.findall(r"^# (\w+ = .*)$", text, re.MULTILINE)
    assert len(offered) >= 6
    (tmp_path / "beads.csv").write_text("x_mm,y_mm,z_mm,radius_mm\n0.1,0.1,0.1,0.05\n", encoding="utf-8")
    for line in offered:
        if line.startswith(
            ('file = "scan', "voxel", "threshold", "domain", "material", 'file = "part', "shape", "unit")
        ):
            continue
        table = "[[inclusions]]\nmaterial = 'glass'\n" if line.startswith("file") else ""
        changed = text.replace("# " + line, table + line, 1)
        if line.startswith("conductivity_at"):
            changed = re.sub(r"^conductivity = 1.05.*\n", "", changed, flags=re.MULTILINE)
        (tmp_path / "second.toml").write_text(changed, encoding="utf-8")
        scene = scenes.read("second.toml")
        assert scene.inclusions[0].center == bead.center


def test_the_surface_that_comments_offer_is_read(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["init"]) == 0
    first, mark, rest = (
        (tmp_path / "scene.toml")
        .read_text(encoding="utf-8")
        .partition("# [[inclusions]]                      # a body")
    )
    block, gap, rest = (mark + rest).partition("\n\n")
    text = first + re.sub("^# ", "", block, flags=re.MULTILINE).replace("part.stl", "part.obj") + gap + rest
    (tmp_path / "scene.toml").write_text(text, encoding="utf-8")
    corners = "v 0 0 0 | v .1 0 0 | v 0 .1 0 | v 0 0 .1 | f 1 3 2 | f 1 2 4 | f 1 4 3 | f 2 3 4"
    (tmp_path / "part.obj").write_text(corners.replace(" | ", "\n"), encoding="utf-8")
    bead, part = scenes.read("scene.toml").inclusions
    # A sixth of the cube of a tenth of a millimetre.
    assert part.kind == "surface mesh" and part.volume == pytest.approx(1e-12 / 6)


def test_what_is_there_is_not_written_over(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.toml").write_text("mine", encoding="utf-8")
    assert main(["init"]) == 2
    assert capsys.readouterr().err == "demheat: scene.toml: is there already; must be another name, or be moved away\n"
    assert (tmp_path / "scene.toml").read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize("words", [["--help"], ["solve", "--help"]])
def test_help_lists_all_methods(words, capsys):
    with pytest.raises(SystemExit):
        main(words)
    told = capsys.readouterr().out
    for name in all_methods():
        assert re.search(rf"(^| ){re.escape(name)}(,|\n| )", told, re.MULTILINE), name
    for each in (
        ("m2K_W", ".xdmf", ".nrrd", ".liggghts", ".stl .ply .obj .msh", "surface mesh")
        if len(words) == 1
        else ("voxels=None", "particles=100000")
    ):
        assert each in told
