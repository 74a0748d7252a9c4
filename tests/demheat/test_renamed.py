"""Only here: old names that users have met and that no longer work or warn, and misspelt ones."""

import sys
from importlib import import_module
from importlib.util import find_spec
from pydoc import locate

import numpy as np
import pytest

import demheat
from demheat import Calibrated, Laguerre, gallery
from demheat.dem.options import Particles
from demheat.io.images import read_image
from demheat.packing import domain, make_packing
from demheat.packing.statistics import coordination
from demheat.renamed import MOVED


def test_old_classes_and_functions():
    with pytest.warns(DeprecationWarning, match="tile is now replicate"):
        assert domain.tile is domain.replicate


def test_components_of_contacts():
    alone = make_packing([[0.5] * 3], [0.4], (1, 1, 1), False, {})
    found = coordination(alone, np.zeros(2, dtype=np.int64), np.empty(0, dtype=np.int64))
    with pytest.warns(DeprecationWarning, match="islands is now components"):
        assert found.islands == found.components == 1


def test_replicas_where_tiles_do():
    scene, wanted = gallery.simple_cubic(10.0, fraction=0.2), Particles(particles=8000, seed=0, replicas=2)
    with pytest.warns(DeprecationWarning, match="replicas = 2 .* tiles cost nothing"):
        wanted.check(scene, Laguerre())
    for law in (Calibrated(), Laguerre(conforming=False)):  # without a word: they are packed
        wanted.check(scene, law)


def test_unknown_names_are_no_attributes():
    with pytest.raises(AttributeError, match="no attribute 'Heater'"):
        _ = demheat.Heater
    with pytest.raises(AttributeError, match="no attribute 'tiles'"):
        _ = domain.tiles


@pytest.mark.parametrize(
    ("statement", "meant"),
    [
        ("import demheat.sovle", "from demheat import solve"),
        ("from demheat import sovle", "from demheat import solve"),
        ("import demheat.solve", "from demheat import solve"),  # a function
        ("import references.ftt", "from references import fft"),
        ("from demheat.io import scene", "from demheat.io import scenes"),
    ],
)
def test_misspelt_names_are_told(statement, meant):
    with pytest.raises(ModuleNotFoundError, match=f"did you mean `{meant}`"):
        exec(statement)


def test_who_asks_for_a_module_has_an_answer():
    assert find_spec("demheat.sovle") is None and locate("demheat.sovle") is None


@pytest.mark.parametrize("statement", ["import demheat.nothing", "from demheat import nothing"])
def test_what_is_like_no_name_is_as_anywhere(statement):
    with pytest.raises(ImportError) as told:
        exec(statement)
    assert "did you mean" not in str(told.value)


@pytest.mark.parametrize(("old", "new"), MOVED.items())
def test_old_modules_are_those_of_today(old, new, monkeypatch):
    for name in MOVED:
        monkeypatch.delitem(sys.modules, name, raising=False)
    with pytest.warns(DeprecationWarning, match=f"{old} is now {new}") as told:
        __import__(old)
    assert sys.modules[old] is import_module(new)
    assert told[-1].filename == __file__  # of those who ask, where they can mend it


@pytest.mark.filterwarnings("ignore:demheat.files is now:DeprecationWarning")
def test_files_had_images_too():
    assert import_module("demheat.files").read_image is read_image


def test_slabs_on_disk_are_solved_whole():
    from demheat import streamed

    scene = gallery.sphere_in_cube(5.0)
    with pytest.warns(DeprecationWarning, match=r"demheat\.streamed solves in memory now"):
        field = streamed.solve(scene, folder="nowhere", slabs=2, particles=1000)
    assert field.conductivity == demheat.solve(scene, particles=1000).conductivity
