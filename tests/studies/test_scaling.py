"""The study of scaling: fits, efficiencies and extrapolations of rows that are made up."""

import numpy as np
import pandas as pd
from numpy.testing import assert_allclose

from studies.scaling import means, rows


def made_up():
    """Stages that go as the number and as its square, one too short to be timed, with two methods."""
    made = []
    for number in (100, 1000, 3000, 10_000):
        twins, cells = 1e-3 * number, 1e-8 * number**2
        made.append(
            {"name": "dem", "part": "inclusions", "number": number, "status": "ok", "cpu_s": twins + cells}
            | {"wall_s": 1.0, "twins_cpu_s": twins, "twins_wall_s": 1.0, "cells_cpu_s": cells, "cells_wall_s": 1.0}
            | {"phases_cpu_s": 1e-7 * number, "phases_wall_s": 1.0, "unknowns": 50 * number}
        )
    return pd.DataFrame([*made, made[-1] | {"name": "fft", "twins_cpu_s": np.nan, "cells_cpu_s": np.nan}])


def test_exponents_are_those_of_the_stages():
    found = means.fitted(made_up(), "number").set_index(["name", "stage"])["exponent"]
    # The squares of the first numbers are below LEAST: two rows are left, too few.
    assert_allclose(found["dem", "twins"], 1.0, rtol=1e-12)  # rounding
    assert means.fitted(made_up(), "number").set_index("stage")["doubt"]["twins"] < 1e-6  # its root
    assert ("dem", "cells") not in found and ("dem", "phases") not in found
    assert 1.0 < found["dem", "all"] < 1.1
    # One row makes no fit.
    assert "fft" not in found.index.get_level_values("name")


def test_efficiency_of_two_threads():
    rows = [
        {"name": "dem", "part": "elements", "particles": n, "cores": cores, "status": "ok", "cpu_s": 1.0}
        | {"wall_s": wall, "cells_cpu_s": 1.0, "cells_wall_s": wall / 2}
        for n, cores, wall in ((1e4, 1, 4.0), (1e4, 2, 2.5), (8e6, 2, 9.0))
    ]
    found = means.efficiencies(pd.DataFrame(rows))
    assert list(found["stage"]) == ["all", "cells"]
    assert_allclose(found["efficiency"], 0.8)
    assert_allclose(found["wall"], [4.0, 2.0])


def test_errors_are_those_against_the_multipoles_of_the_same_spheres():
    same = {"kind": "equal", "fraction": 0.3, "status": "ok"}
    found = (("multipole", 5, 2.0), ("dem", 5, 2.02), ("dem", 6, 2.0))
    df = pd.DataFrame([same | {"name": n, "number": k, "k_ratio": v} for n, k, v in found])
    assert_allclose(means.errors(df)["error_percent"], [0.0, 1.0, np.nan])


def test_what_a_billion_takes_goes_on_from_the_largest_row():
    rows = [
        {"name": "dem", "part": "elements", "unknowns": n, "status": "ok", "cpu_s": 36e-6 * n, "wall_s": 1.0}
        | {"peak_mib": 600 * n / 2**20}
        for n in (1e5, 1e6, 1e7)
    ]
    (line,) = means.billion(pd.DataFrame(rows))
    assert_allclose([line["hours"], line["tib"] * 2**40], [10.0, 6e11])


def test_peaks_and_sums_of_stages():
    stage = rows.Stages()
    stage("packing", lambda: None)
    kept = stage("cells", lambda: np.ones(4_000_000))
    row = stage.row()
    assert_allclose(row["cpu_s"], row["packing_cpu_s"] + row["cells_cpu_s"])
    # 30.5 MiB, less what the process had free.
    assert row["peak_mib"] > 0.9 * kept.nbytes / 2**20
