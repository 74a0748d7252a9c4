"""Old names that users have met still work, and say what they are called now."""

import pytest

import demheat
from demheat import gallery
from demheat.packing import domain


@pytest.mark.parametrize(("old", "new"), [({"poor": "keep"}, {"sparse": "keep"}), ({"tiles": 1}, {"replicas": 1})])
def test_old_keywords(old, new):
    scene, knobs = gallery.slab(periodic=True), {"particles": 200, "law": "calibrated"}
    with pytest.warns(DeprecationWarning, match=f"{next(iter(old))}= is now {next(iter(new))}=") as caught:
        before = demheat.solve(scene, **knobs, **old)
    assert caught[0].filename == __file__
    assert before.conductivity == demheat.solve(scene, **knobs, **new).conductivity


def test_an_old_keyword_beside_its_new_one_is_refused():
    with pytest.raises(ValueError, match="tiles = 2 beside replicas, its new name: must be given once"):
        demheat.solve(gallery.slab(periodic=True), particles=200, tiles=2, replicas=1)


def test_old_classes_and_functions():
    with pytest.warns(DeprecationWarning, match="tile is now replicate"):
        assert domain.tile is domain.replicate


def test_unknown_names_are_no_attributes():
    with pytest.raises(AttributeError, match="no attribute 'Heater'"):
        _ = demheat.Heater
    with pytest.raises(AttributeError, match="no attribute 'tiles'"):
        _ = domain.tiles
