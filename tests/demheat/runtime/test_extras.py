"""What is not installed: a sentence says which extra brings it, and other methods go on."""

import re
import sys

import pytest
from imported import ROOT

from demheat import effective, gallery, recommend
from demheat.runtime.extras import EXTRAS, extra, lacking
from references import exact

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

# Distributions whose libraries have other names.
NAMES = {"scikit-fem": "skfem"}


@pytest.fixture
def without(monkeypatch):
    """Have libraries not be there."""

    def gone(*names):
        for name in names:
            monkeypatch.setitem(sys.modules, name, None)

    return gone


def test_extras_are_those_of_the_project():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    told = {
        name: tuple(NAMES.get(each, each) for each in (re.match(r"[\w-]+", line)[0] for line in lines))
        for name, lines in project["optional-dependencies"].items()
        if name in EXTRAS
    }
    assert told == EXTRAS


@pytest.mark.parametrize("name", EXTRAS)
def test_what_is_missing_is_said_in_a_sentence(name, without):
    library = EXTRAS[name][0]
    without(library)
    with pytest.raises(ImportError, match=rf"^what asks needs {library}, .*: pip install 'demheat\[{name}\]'$"):
        with extra("what asks"):
            __import__(library)
    assert lacking(name).startswith(f"{name} needs {library}")


def test_what_an_extra_does_not_bring_is_not_its_fault(without):
    without("json")
    with pytest.raises(ModuleNotFoundError, match="json"), extra("what asks"):
        __import__("json")


def test_methods_without_extras_are_always_there():
    assert lacking("dem") == lacking("exact") == ""


def test_a_field_says_what_it_lacks(without):
    field = exact.solve(gallery.slab(), points_per_axis=2)
    for method, library in {"to_dataframe": "pandas", "to_xarray": "xarray", "to_pyvista": "pyvista"}.items():
        without(library)
        with pytest.raises(ImportError, match=rf"^Field.{method} needs {library}, "):
            getattr(field, method)()


def test_another_method_is_recommended(without):
    """Unequal spheres between walls that cut one: neither exact forms nor multipoles."""
    scene = gallery.coated_sphere(10.0, 0.1)
    everything = recommend(scene, 1e-2)
    assert "needs pyfftw" not in everything.why and "needs gmsh" not in everything.why
    without("pyfftw", "gmsh")
    told = recommend(scene, 1e-2).why
    assert "fem: no, fem needs gmsh" in told and "fft: no, fft needs pyfftw" in told
    with pytest.raises(RuntimeError, match=r"fft: fft needs pyfftw.*pip install 'demheat\[fft\]'"):
        effective(scene, accuracy=1e-2, method="fft")
