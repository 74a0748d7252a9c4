"""Only here: stages whose seconds or peaks are not the whole's."""

import numpy as np
from numpy.testing import assert_allclose

from studies.scaling import rows


def test_peaks_and_sums_of_stages():
    stage = rows.Stages()
    stage("packing", lambda: None)
    kept = stage("cells", lambda: np.ones(4_000_000))
    row = stage.row()
    assert_allclose(row["cpu_s"], row["packing_cpu_s"] + row["cells_cpu_s"])
    # 30.5 MiB, less what the process had free.
    assert row["peak_mib"] > 0.9 * kept.nbytes / 2**20
