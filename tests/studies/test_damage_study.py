"""Study `damage`: what is made of rows that are known."""

import numpy as np
import pandas as pd
from numpy.testing import assert_allclose

from studies.damage import means, rows


def known(removed, k):
    return pd.DataFrame({"body": "lattice", "number": 12, "removed": removed, "k_ratio": k, "draw": [0, 1] * 2})


def test_links_beside_what_is_known():
    found = known([0.01, 0.01, 0.4, 0.4], [0.985 + 0.0003, 0.985 - 0.0001, 0.38, 0.40])
    # Means over draws: 0.9851 loses 0.0149 of 0.015; 0.39 beside 0.4.
    assert_allclose(means.first_loss(found), 0.0001 / 0.015, rtol=1e-9)
    assert_allclose(means.beside_theory(found, 0.4), 0.01 / 0.4, rtol=1e-9)
    assert_allclose(means.above_bound(found), 0.9851 / 0.99 - 1, rtol=1e-9)
    assert means.first_loss(found.iloc[:0]) is None and means.above_bound(found.iloc[:0]) is None
    assert_allclose(means.theory([0.0, 1 / 3, 0.9]), [1.0, 0.5, 0.0], atol=1e-15)


def test_how_errors_of_discs_fall():
    cracks = pd.DataFrame(
        {"particles": [1000, 1000, 8000, 8000], "radius": [0.1, 0.2] * 2, "error_percent": [-4.0, -2.0, -2.0, -1.5]}
    )
    assert_allclose(means.fall(cracks, 1000, 8000), 0.75)
    assert means.fall(cracks, 8000, 64000) is None


def test_shares_that_have_come_off():
    gone = [sum(each.material.conductivity == 0 for each in rows.damaged(share).inclusions) for share in (0, 0.5, 1)]
    assert gone == [0, 8, 16]


def test_a_lattice_fills_the_cell():
    made = rows.lattice(4)
    assert made.number == 64 and np.all(made.radii == 1 / 8)
