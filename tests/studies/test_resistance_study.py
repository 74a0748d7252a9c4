"""Study `resistance`: the Kapitza length that a fall asks for, from rows that are known."""

import numpy as np
import pandas as pd
from numpy.testing import assert_allclose

from demheat import gallery
from studies.resistance import cases, means, rows


def known(fraction, lengths):
    """Rows as if Hasselman and Johnson's formula were what multipoles find."""
    k = [means.conductivity(fraction, length) for length in lengths]
    return pd.DataFrame({"fraction": fraction, "kapitza": lengths, "k_ratio": k, "realisation": 0})


def test_the_length_that_a_fall_asks_for():
    found = known(0.2, cases.SILICA)
    for fall in (0.03, cases.GAP, 0.15):
        # A fall of that formula is c l / (1 + d l): its inverse is a line in that of the length.
        assert_allclose(means.explaining(found, 0.2, fall), means.foreseen(0.2, fall), rtol=1e-9)
    assert means.explaining(found, 0.2, 0.9) is None and means.explaining(found, 0.3, 0.07) is None
    assert_allclose(means.lowest(found), -np.diff(found["k_ratio"]).max(), rtol=1e-12)
    assert_allclose(means.radius_of(0.1, 1e-8), 1e-8 * 0.195 / 0.1, rtol=1e-12)


def test_arrangements_of_one_fraction_weigh_the_same():
    both = pd.concat([known(0.2, (0.0, 0.1)), known(0.2, (0.0, 0.1)).assign(k_ratio=[3.0, 1.0])])
    first = known(0.2, (0.0, 0.1))["k_ratio"]
    assert_allclose(means.curve(both, 0.2), [(first[0] + 3) / 2, (first[1] + 1) / 2], rtol=1e-12)


def test_surfaces_of_one_length_over_the_radius():
    scene = rows.resisting(gallery.random_dispersion(3, fraction=0.1), 0.25)
    for each in scene.inclusions:
        assert_allclose(each.resistance * scene.matrix.conductivity, 0.25 * each.radius, rtol=1e-12)
