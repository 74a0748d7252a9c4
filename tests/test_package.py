"""What is published: an sdist, and the wheel made of it, which works in an empty folder without any extra."""

import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import zipfile

import pytest
from imported import ROOT

from demheat.io.scenes.source import tomllib
from demheat.runtime.extras import EXTRAS
from demheat.version import __version__

BUILD = "from setuptools import build_meta; import sys; print(getattr(build_meta, sys.argv[1])(sys.argv[2]))"
# Without extras, as `pip install demheat` leaves it: the DEM and closed forms solve, others say what they lack.
HEAD = f"""
import sys
for library in {[each for libraries in EXTRAS.values() for each in libraries]}:
    sys.modules[library] = None
"""
CODE = """
import demheat
from demheat import gallery
from references import bracket, exact, fem, fft

scene = gallery.sphere_in_cube(5.0)
print(demheat.__file__)
print(demheat.solve(scene, particles=1000).conductivity, exact.solve(scene).conductivity)
print(demheat.effective(scene).method, demheat.recommend(gallery.laminate()).method)
for method in (fem, fft, bracket, bracket.voxels):
    try:
        method.solve
    except ImportError as error:
        print(error)
for name in ("benchmark", "studies", "tests"):
    try:
        __import__(name)
    except ModuleNotFoundError as error:
        print(error)
"""
# And what is missing costs no other method its answer.
COMMANDS = """
print("=")
from demheat import gallery
from demheat.io import scenes
from demheat.terminal.commands import main

scenes.write(gallery.sphere_in_cube(5.0), "scene.toml")
words = "--method fft,dem,exact --knob dem.particles=1000 --knob fft.voxels=8 --no-interval"
print(main(["compare", "scene.toml", *words.split()]))
try:
    main(["solve", "--help"])
except SystemExit as error:
    print(error.code)
"""


PARTS = ("demheat", "references", "pyproject.toml", "README.md", "LICENSE")
# Of a clone, not of what is installed.
MADE = ("", ".pyc", ".nbi", ".nbc")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """Built of the sdist, so that nothing is missing in that; neither touches the clone."""
    folder = tmp_path_factory.mktemp("package")
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    for name in filter(None, listed.split("\0")):
        # What is gone is not committed yet.
        if (ROOT / name).is_file() and name.partition("/")[0] in PARTS:
            (folder / "clone" / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, folder / "clone" / name)
    sdist = folder / _built("build_sdist", folder / "clone", folder)
    with tarfile.open(sdist) as file:
        file.extractall(folder, filter="data")
    return folder / _built("build_wheel", folder / sdist.name.removesuffix(".tar.gz"), folder)


def _built(what, source, target):
    done = subprocess.run([sys.executable, "-c", BUILD, what, str(target)], cwd=source, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()[-1]


def test_it_has_two_packages_and_their_data(wheel):
    names = zipfile.ZipFile(wheel).namelist()
    assert {name.partition("/")[0] for name in names} == {"demheat", "references", f"demheat-{__version__}.dist-info"}
    files = [path for each in ("demheat", "references") for path in (ROOT / each).rglob("*") if path.suffix not in MADE]
    wanted = {path.relative_to(ROOT).as_posix() for path in files} | {"demheat/py.typed", "references/py.typed"}
    assert wanted - {*names} == set()


@pytest.fixture(scope="module")
def place(wheel, tmp_path_factory):
    """Where the wheel is installed."""
    found = tmp_path_factory.mktemp("place")
    # As it is; nothing is compiled that is not imported.
    words = ["--quiet", "--no-deps", "--no-index", "--no-compile", "--target", str(found), str(wheel)]
    subprocess.run([sys.executable, "-m", "pip", "install", *words], check=True)
    return found


@pytest.fixture(scope="module")
def printed(place, tmp_path_factory):
    """Lines that a program prints in a folder, without the clone, which an editable install puts on the path."""
    paths = {"PYTHONPATH": f"{place}:{sysconfig.get_path('purelib')}:{sysconfig.get_path('platlib')}"}
    words, folder = [sys.executable, "-S", "-c", HEAD + CODE + COMMANDS], tmp_path_factory.mktemp("empty")
    done = subprocess.run(words, cwd=folder, env=_environment() | paths, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    at = lines.index("=") + 1
    return lines[: at - 1], lines[at:]


def test_it_works_alone(place, printed):
    file, values, chosen, *told = printed[0]
    assert file.startswith(str(place)) and chosen == "exact exact"
    dem, true = map(float, values.split())
    # 1000 particles err by .2 %.
    assert abs(dem / true - 1) < 5e-3
    assert [re.search(r"^([\w.]+) needs (\w+), .*'demheat\[(\w+)\]'$", line).groups() for line in told[:4]] == [
        ("references.fem", "skfem", "fem"),
        ("references.fft", "pyfftw", "fft"),
        ("references.bracket", "skfem", "fem"),
        ("references.bracket.voxels", "pyfftw", "fft"),
    ]
    assert told[4:] == [f"No module named '{name}'" for name in ("benchmark", "studies", "tests")]


def test_commands_go_on_without_what_is_missing(printed):
    said = printed[1]
    # Its status: one method failed. What follows is help.
    end = said.index("1")
    lines = {line.split()[0]: line for line in said[:end] if line.split()}
    assert float(lines["exact"].split()[1]) == pytest.approx(42.6403, rel=1e-5)
    assert float(lines["dem"].split()[1]) == pytest.approx(42.6403, rel=5e-3)  # 1000 particles
    needs = "pyfftw, which is not installed: pip install 'demheat[fft]'"
    assert lines["fft"] == f"fft failed: references.fft needs {needs}"
    assert "no picture: a picture needs matplotlib" in lines["rows"]
    told = " ".join(" ".join(said[end:]).split())
    assert said[-1] == "0" and f"not installed: fft needs {needs}" in told


def _environment():
    return {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}


def test_papers_of_a_release_say_the_same():
    """Recipe of conda, metadata of Zenodo and of citations: version, requirements, title."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    recipe = (ROOT / "docs" / "release" / "meta.yaml").read_text(encoding="utf-8")
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    zenodo = (ROOT / ".zenodo.json").read_text(encoding="utf-8")
    assert project["version"] == __version__
    assert f'version = "{__version__}"' in recipe and f"\nversion: {__version__}\n" in citation
    assert f'"version": "{__version__}"' in zenodo
    asked = [line for line in project["dependencies"] if "python_version" not in line]
    for line in asked:
        name, least = line.split(">=")
        assert f"    - {name} >={least}\n" in recipe
    assert re.search(r'^title: (".*")$', citation, re.MULTILINE)[1] in zenodo
