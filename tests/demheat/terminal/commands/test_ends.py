"""Only here: commands that end in a traceback by a pipe, a full disk or Ctrl-C, and rows that two at work lose."""

import csv
import errno
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from demheat import gallery
from demheat.io import scenes
from demheat.runtime.paths import replaced
from demheat.terminal.commands import compare, main

ROOT = Path(__file__).parents[4]
COMMANDS = {
    "module": ("-m", "demheat"),
    "script": (
        "-c",
        "import sys; sys.argv[0] = '/usr/bin/demheat'; from demheat.terminal.commands import main; sys.exit(main())",
    ),
    "studies": ("-m", "studies"),
}


def ended(*words, stdout=subprocess.PIPE, path=()):
    """Exit status and what is said of errors of a process."""
    found = {"PYTHONPATH": os.pathsep.join(map(str, (*path, ROOT)))}
    # Else nothing waits to be written at the end, and argparse passes over what it cannot write itself.
    usual = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
    run = subprocess.run(
        [sys.executable, *map(str, words)],
        env=usual | found,
        stdout=stdout,
        stderr=subprocess.PIPE,
        text=True,
        timeout=120,
    )
    return run.returncode, run.stderr


@pytest.mark.parametrize("command", COMMANDS)
def test_a_closed_pipe_is_silent(command):
    reader, writer = os.pipe()
    os.close(reader)
    assert ended(*COMMANDS[command], "--help", stdout=writer) == (141, "")
    os.close(writer)


def test_a_pipe_closed_while_it_works_is_silent(tmp_path):
    """What is done meanwhile is kept, as it would be if somebody read on."""
    scenes.write(gallery.laminate(), tmp_path / "scene.toml")
    reader, writer = os.pipe()
    os.close(reader)
    words = ("-m", "demheat", "solve", tmp_path / "scene.toml", "--method", "exact", "--no-interval")
    assert ended(*words, "--write", tmp_path / "x.npz", stdout=writer) == (141, "")
    os.close(writer)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
@pytest.mark.parametrize("how", [(), ("-u",)], ids=["", "unbuffered"])
def test_output_that_finds_no_room_is_named(how, tmp_path):
    scenes.write(gallery.laminate(), tmp_path / "scene.toml")
    words = ("-m", "demheat", "solve", tmp_path / "scene.toml", "--method", "exact", "--no-interval")
    with open("/dev/full", "wb") as full:
        status, said = ended(*how, *words, stdout=full)
    assert status == 2 and said.startswith("demheat: standard output") and said.endswith("No space left on device\n")
    assert said.count("\n") == 1


@pytest.mark.parametrize("command", COMMANDS)
def test_ctrl_c_while_it_loads(command, tmp_path):
    """As if it came in the middle of an import, at a moment that is always the same."""
    (tmp_path / "numpy.py").write_text("raise KeyboardInterrupt\n")
    assert ended(*COMMANDS[command], "--help", path=(tmp_path,)) == (130, "")


def test_ctrl_c_while_a_program_loads_the_package(tmp_path):
    """Which is no command of ours: it hears of it."""
    (tmp_path / "numpy.py").write_text("raise KeyboardInterrupt\n")
    status, said = ended("-c", "import demheat", path=(tmp_path,))
    assert status not in (0, 130) and said.endswith("KeyboardInterrupt\n")


def test_a_full_disk_names_the_file(tmp_path):
    resource = pytest.importorskip("resource")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    path = tmp_path / "scene.npy"
    for write in (lambda part: part.write_bytes(bytes(2**16)), lambda part: np.save(part, np.zeros(2**13))):
        resource.setrlimit(resource.RLIMIT_FSIZE, (2**12, before[1]))
        try:
            with pytest.raises(OSError, match=str(path)), replaced(path) as part:
                write(part)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert list(tmp_path.iterdir()) == []


def test_a_command_names_the_file(capsys, tmp_path, monkeypatch):
    def full(*_, **__):
        raise OSError(errno.ENOSPC, "No space left on device")

    scenes.write(gallery.laminate(), tmp_path / "scene.toml")
    monkeypatch.setattr(csv, "DictWriter", full)
    words = ["compare", tmp_path / "scene.toml", "--methods", "maxwell", "--out", tmp_path / "out"]
    assert main([str(word) for word in words]) == 2
    told = capsys.readouterr().err.splitlines()[-1]
    assert told == f"demheat: {tmp_path / 'out' / 'scene.csv'}: No space left on device"


def sliced(path, text, temperature):
    with path.open("wb") as file:
        np.savez(file, temperature=temperature, scene=text)
    return path.read_bytes()


def plain(path):
    with path.open("wb") as file:
        np.save(file, np.zeros((3, 4)))
    return path.read_bytes()


TEXT, PLANE = "gradient = 1", np.arange(12.0).reshape(3, 4)


def test_slices_that_are_none(tmp_path, monkeypatch):
    path = tmp_path / "scene.slice.npz"
    whole = sliced(path, TEXT, PLANE)
    lines = []
    assert np.array_equal(compare._slice(tmp_path / "scene.csv", TEXT, lines.append), PLANE)
    # Of another scene; none.
    assert compare._slice(tmp_path / "scene.csv", "another", lines.append) is None
    assert compare._slice(tmp_path / "other.csv", TEXT, lines.append) is None and lines == []
    flipped = bytearray(whole)
    flipped[whole.index(PLANE.tobytes()) + 20] ^= 1
    broken = [b"", b"foreign", whole[:100], whole[:-1], bytes(flipped), plain(path)]
    broken += [sliced(path, TEXT, each) for each in (PLANE[0], PLANE.astype(str), np.array("hot"))]
    for content in broken:
        path.write_bytes(content)
        lines.clear()
        assert compare._slice(tmp_path / "scene.csv", TEXT, lines.append) is None
        assert len(lines) == 1 and lines[0].startswith(f"{path}: no slice, or a part of one: ") and "\n" not in lines[0]
    path.write_bytes(whole)
    monkeypatch.setattr(compare, "LARGEST", 100)
    assert compare._slice(tmp_path / "scene.csv", TEXT, lines.append) is None and "more than 100 bytes" in lines[-1]


def test_a_slice_cut_short_costs_no_comparison(capsys, tmp_path):
    scenes.write(gallery.laminate(), tmp_path / "scene.toml")
    words = [str(each) for each in ("compare", tmp_path / "scene.toml", "--methods", "exact", "--out", tmp_path)]
    words.append("--no-interval")
    assert main(words) == 0 and "no slice" not in capsys.readouterr().err
    kept = tmp_path / "scene.slice.npz"
    whole = kept.read_bytes()
    kept.write_bytes(whole[:50])
    assert main(words) == 0 and f"{kept}: no slice, or a part of one" in capsys.readouterr().err
    # With a row that is made it is made anew.
    assert main([*words, "--force"]) == 0 and "no slice" not in capsys.readouterr().err
    with np.load(kept) as found:
        assert found["temperature"].ndim == 2


# So many rows each, of the same scene and code; both begin when both are ready.
ROWS = 60
ADD = f"""
import sys
from pathlib import Path
from demheat.terminal.commands import rows
print("ready", flush=True)
input()
for number in range({ROWS}):
    key = (sys.argv[1] + str(number), "", "True", "scene", "code")
    row = dict.fromkeys(rows.COLUMNS, "") | dict(zip(rows.KEY, key))
    rows.add(Path(sys.argv[2]), key, row)
"""


def test_two_at_work_in_one_folder_lose_no_row(tmp_path):
    path = tmp_path / "scene.csv"
    knobs = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    knobs["env"] = os.environ | {"PYTHONPATH": str(ROOT)}
    both = [subprocess.Popen([sys.executable, "-c", ADD, name, path], **knobs) for name in "ab"]
    try:
        assert [each.stdout.readline() for each in both] == ["ready\n"] * 2
        for each in both:
            each.stdin.write("\n")
            each.stdin.flush()
        assert [each.communicate(timeout=60)[1] for each in both] == ["", ""]
    finally:
        for each in both:
            each.kill()
            each.communicate()
    assert {key[0] for key in compare.rows.read(path)} == {f"{name}{number}" for name in "ab" for number in range(ROWS)}
    assert [each.name for each in tmp_path.iterdir()] == ["scene.csv"]
