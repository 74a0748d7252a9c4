"""Only here: stages whose seconds or peaks are not the whole's; rows on two ranks, where there is MPI."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from studies.scaling import ranks, rows


def test_peaks_and_sums_of_stages():
    stage = rows.Stages()
    stage("packing", lambda: None)
    kept = stage("cells", lambda: np.ones(4_000_000))
    row = stage.row()
    assert_allclose(row["cpu_s"], row["packing_cpu_s"] + row["cells_cpu_s"])
    # 30.5 MiB, less what the process had free.
    assert row["peak_mib"] > 0.9 * kept.nbytes / 2**20


@pytest.mark.slow
def test_a_row_on_two_ranks():
    if ranks.missing():
        pytest.skip(ranks.missing())
    row = ranks.row(1, 4000, 0, 2)
    assert row["unknowns"] > 4000 and row["residual"] <= 1e-10
    # Two exchanges of each cycle and one of each product go to the one neighbour, and those of the levels below.
    assert row["messages"] >= 3 * row["iterations"] and row["reductions"] >= 3 * row["iterations"]
    assert row["iterate_wall_s"] < row["solve_wall_s"] < row["wall_s"]
