"""Only here: old names that users have met and that no longer work or warn."""

import pytest

import demheat
from demheat.packing import domain


def test_old_classes_and_functions():
    with pytest.warns(DeprecationWarning, match="tile is now replicate"):
        assert domain.tile is domain.replicate


def test_unknown_names_are_no_attributes():
    with pytest.raises(AttributeError, match="no attribute 'Heater'"):
        _ = demheat.Heater
    with pytest.raises(AttributeError, match="no attribute 'tiles'"):
        _ = domain.tiles
