"""Figures of the cutter are put together from runs with one thread and with two."""

from studies.common import cutter


def test_figures_put_together(monkeypatch):
    runs = {1: {"cpu_s": 2.0, "wall_s": 2.0, "again": 0.0, "peer_cpu_s": 10.0}, 2: {"wall_s": 1.25}}
    monkeypatch.setattr(cutter, "_run", lambda particles, seed, threads: runs[threads])
    row = cutter.compared(100_000)
    assert row["ratio"] == 0.2 and row["efficiency"] == 0.8 and row["us_per_cell"] == 20.0
    assert row["peer_us_per_cell"] == 100.0 and round(row["cells_per_s"]) == 50_000
