"""Only here: old names that users have met and that no longer work or warn."""

import pytest

import demheat
from demheat import Calibrated, Laguerre, gallery
from demheat.dem.options import Particles
from demheat.packing import domain


def test_old_classes_and_functions():
    with pytest.warns(DeprecationWarning, match="tile is now replicate"):
        assert domain.tile is domain.replicate


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
