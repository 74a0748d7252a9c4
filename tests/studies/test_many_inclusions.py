"""The study of many inclusions: errors against the multipoles."""

import numpy as np
import pandas as pd
from numpy.testing import assert_allclose

from studies import many_inclusions


def test_errors_hang_on_the_highest_degree_even_if_it_failed():
    rows = [{"name": "multipole", "highest": n, "k_ratio": k} for n, k in ((4, 1.49), (6, 1.5), (8, 1.5))]
    df = pd.DataFrame([*rows, {"name": "dem", "particles": 1e4, "number": 83, "inside": 830, "k_ratio": 1.53}])
    found = many_inclusions.errors(df)
    assert_allclose(found["error_percent"], [-100 * 0.01 / 1.5, 0.0, 0.0, 2.0])
    # Counted, not the cell's particles by the volume of its spheres: twins are many.
    assert_allclose(found["per_inclusion"].iloc[-1], 10.0)
    assert many_inclusions.errors(df.drop(columns="inside"))["per_inclusion"].isna().all()
    df.loc[2, "k_ratio"] = np.nan
    assert many_inclusions.errors(df)["error_percent"].isna().all()
