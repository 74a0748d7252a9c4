"""Workers of a real study are killed: its rows are those of a run here."""

import random

import pytest
from tools import lost_workers

KILLS = 3


def test_what_is_measured_is_no_difference():
    here = {"a": {"k": "1.0", "wall_s": "2", "when": "now"}, "b": {"k": "2.0"}}
    there = {"a": {"k": "1.0", "wall_s": "3", "when": "then"}, "b": {"k": "2.0"}}
    assert lost_workers.differences(here, there) == []
    there["b"]["k"] = "2.0000000001"
    assert lost_workers.differences(here, there) == [("b", "k", "2.0", "2.0000000001")]
    assert lost_workers.differences(here, {"a": here["a"]}) == [("b", "case", True, False)]


@pytest.mark.slow
def test_killed_workers_of_a_real_study_lose_no_row(tmp_path):
    """The DEM, finite elements and multipoles, twelve rows."""
    pytest.importorskip("distributed")
    local = lost_workers.ran("resistance", tmp_path / "local")
    # Two workers take no less than half as long.
    drawn = random.Random(20)
    moments = [drawn.uniform(0.0, 0.4 * local.seconds) for _ in range(KILLS)]
    run = lost_workers.ran("resistance", tmp_path / "killed", "--workers", "2", moments=moments, drawn=drawn)
    assert len(local.rows) >= 12 and {row["status"] for row in local.rows.values()} == {"ok"}
    assert len(run.killed) == KILLS and run.killed[-1][1] < len(local.rows)
    assert lost_workers.differences(local.rows, run.rows) == [] and run.status == local.status == 0
