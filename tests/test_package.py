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
CODE = f"""
import sys
for library in {[each for libraries in EXTRAS.values() for each in libraries]}:
    sys.modules[library] = None
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


def test_it_works_alone(wheel, tmp_path):
    place, empty = tmp_path / "place", tmp_path / "empty"
    empty.mkdir()
    words = ["-m", "pip", "install", "--quiet", "--no-deps", "--no-index", "--target", str(place), str(wheel)]
    subprocess.run([sys.executable, *words], check=True)
    # Without the clone, which an editable install puts on the path.
    paths = {"PYTHONPATH": f"{place}:{sysconfig.get_path('purelib')}:{sysconfig.get_path('platlib')}"}
    done = subprocess.run(
        [sys.executable, "-S", "-c", CODE], cwd=empty, env=_environment() | paths, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    file, values, chosen, *told = done.stdout.splitlines()
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
