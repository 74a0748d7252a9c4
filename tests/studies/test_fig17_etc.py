"""What the studies of random dispersions make of their rows: limits, means, intervals, errors."""

import numpy as np
import pandas as pd
import pytest
from known_rows import ladder
from numpy.testing import assert_allclose

from studies.fig17_etc import means as dispersion_means
from studies.fig17_etc import tables as dispersion_table


def cells(kind, boundary, values, **more):
    rows = {"name": "fft", "kind": kind, "boundary": boundary, "fraction": 0.2, "axes": "xyz", **more}
    return pd.DataFrame({"realisation": range(len(values)), "k_ratio": values, **rows})


def test_interval_is_students():
    df = cells("periodic", "gradient", [1.0, 1.1, 1.2])
    found = dispersion_means.interval(df, "periodic", 0.2)
    # Student's 97.5 % point of two degrees of freedom is 4.30265, as printed in tables, to its last digit.
    assert_allclose(found, (1.1, 4.30265 * 0.1 / np.sqrt(3), 0.1, 3), rtol=1e-5)
    assert dispersion_means.interval(df.iloc[:1], "periodic", 0.2) is None


def test_changes_between_kinds_and_boundaries():
    df = pd.concat(
        [
            cells("periodic", "gradient", [1.0, 1.0]),
            cells("unequal", "gradient", [1.01, 1.03]),
            cells("walled", "gradient", [1.0, 2.0]),
            cells("walled", "walls", [1.01, 2.06]),
        ]
    )
    assert_allclose(dispersion_means.change(df, 0.2, "unequal"), 2.0)
    # That of one degree of freedom, 12.7062, to its last digit.
    assert_allclose(dispersion_means.change_interval(df, 0.2, "unequal"), 100 * 12.7062 * 0.01 / 1.02, rtol=1e-5)
    assert_allclose(dispersion_means.of_walls(df, 0.2), [1.0, 3.0])
    assert len(dispersion_means.of_walls(df[df["boundary"] == "gradient"], 0.2)) == 0


def test_bounds_are_those_of_the_cell_and_of_the_methods_own_fraction():
    df = pd.DataFrame([{"name": "zeta2", "fraction": 0.2, "realisation": 3, "zeta2": 0.0}])
    low, high = dispersion_means.bounds_of(df, {"fraction": 0.2, "realisation": 3, "inclusion": 0.25})
    # Without zeta_2 the bounds are Maxwell's on both sides: the lower one of Hashin and Shtrikman.
    beta = (1.5 / 0.195 - 1) / (1.5 / 0.195 + 2)
    # One formula in two forms: rounding.
    assert_allclose([low, high], (1 + 0.5 * beta) / (1 - 0.25 * beta), rtol=1e-12)
    with pytest.raises(ValueError, match="zeta2"):
        dispersion_means.bounds_of(df, {"fraction": 0.2, "realisation": 4, "inclusion": 0.25})


def test_the_nearest_method_is_named_with_its_cost():
    here = {"kind": "periodic", "boundary": "gradient", "realisation": 0, "axes": "y", "fraction": 0.2}
    rows = [
        ladder("dem", "particles", [1e4, 1e5], [1.52, 1.52], cpu_s=[1.0, 7.0], **here),
        ladder("fem", "size", [0.1], [1.501], cpu_s=3.0, **here),
        ladder("fft", "voxels", [64, 128, 256], [1.51] * 3, cpu_s=2.0, **here),
        ladder("fft-em", "voxels", [64, 128, 256], [1.49] * 3, cpu_s=2.0, **here),
    ]
    where = {key: here[key] for key in ("kind", "boundary", "realisation", "axes")}
    line = dispersion_table._nearest(pd.concat(rows), {0.2: 1.5}, "periodic", where)
    assert line["f = 0.2"] == "FEM, 3 s"
