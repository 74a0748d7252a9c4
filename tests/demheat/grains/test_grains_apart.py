"""Only here: grains that nothing joins and nobody is told of, and walls of a packing that has none."""

import pytest

from demheat import grains
from demheat.packing import make_packing


def bed(periodic):
    return make_packing([[1, 1, 1], [3, 3, 3]], [0.4, 0.4], (4, 4, 4), periodic, {})


def test_a_bed_that_conducts_nothing_says_so():
    with pytest.warns(UserWarning, match="no two grains touch"):
        assert grains.solve(bed(True), 10.0, gradient=(0, 0, 1), gap=grains.Gap(conductivity=0.2)).conductivity == 0


def test_walls_of_a_periodic_packing():
    with pytest.raises(ValueError, match="must be a gradient instead"):
        grains.solve(bed(True), 10.0, walls={"z-": 0.0, "z+": 1.0})
