"""Only here: links and reaches that statistics cannot have, of values that are each good."""

import numpy as np
import pytest
from crystals import simple_cubic, touching

from demheat.packing.base import Packing, make_packing
from demheat.packing.statistics import (
    backbone,
    coordination,
    directions,
    fabric,
    packing_fraction,
    radial_distribution,
    two_point,
)


def test_bad_input():
    crystal = simple_cubic(6)
    walled, rows = crystal._replace(periodic=np.zeros(3, dtype=bool)), touching(crystal)
    indptr, indices = rows
    swapped = indices.copy()
    swapped[[0, 1]] = swapped[[1, 0]]
    one = Packing(np.full((2, 3), 1.0), np.full(2, 0.5), np.full(3, 4.0), np.ones(3, dtype=bool), {})
    pair = np.array([0, 1, 2]), np.array([1, 0])
    for name, call in (
        ("margin = 6.0: must be < 6 mean radii", lambda: packing_fraction(walled, margin=6.0)),
        ("margin = 5.5: no particle", lambda: coordination(walled, *rows, margin=5.5)),
        ("indptr of shape", lambda: coordination(crystal, indptr[::-1], indices)),
        ("indices of shape", lambda: coordination(crystal, indptr, indices[:-1])),
        ("indices from", lambda: coordination(crystal, indptr, indices + 1)),
        ("indices: each pair", lambda: coordination(crystal, indptr, swapped)),
        ("indices: each pair", lambda: coordination(one, np.array([0, 1, 1]), np.array([1]))),
        ("indices: each pair", lambda: coordination(one, np.array([0, 1, 2]), np.array([0, 1]))),
        ("indices: each pair", lambda: coordination(one, np.array([0, 2, 4]), np.array([1, 1, 0, 0]))),
        ("centers: 0 and 1 coincide", lambda: fabric(one, *pair)),
        ("centers: 0 and 1 coincide", lambda: backbone(one, *pair)),
        ("no links", lambda: fabric(one, np.zeros(3, dtype=int), np.empty(0, dtype=int))),
        ("bins = 7", lambda: directions(crystal, *rows, bins=7)),
        ("r_max = 3.1: .* <= 3, half of the shortest period", lambda: radial_distribution(crystal, r_max=3.1)),
        ("r_max = 3.0: no centre", lambda: radial_distribution(walled, r_max=3.0)),
        ("r_max = 2.6: must be <= 2.5, half of the longest line", lambda: two_point(walled, r_max=2.6, margin=1.0)),
        ("at least 2", lambda: radial_distribution(make_packing([[1, 1, 1]], [0.5], (4, 4, 4), True, {}))),
        ("along = ", lambda: two_point(crystal, along=(1, 0, 0), r_max=1.0)),
        ("points = 1", lambda: two_point(crystal, points=1, r_max=1.0)),
        ("lines = 1", lambda: two_point(crystal, lines=1, r_max=1.0)),
        ("periods must be", lambda: two_point(one._replace(radii=np.full(2, 1.1)), r_max=0.5)),
    ):
        with pytest.raises(ValueError, match=name):
            call()
