"""What fft.solve says of itself while it runs: a share of the way that a terminal can show."""

import math

import pytest

from demheat.runtime import progress
from demheat.scene import Material, Scene, Sphere
from references import fft
from references.fft.problem import converged


def test_share_of_the_way_to_the_tolerance():
    assert converged(1.0, 1e-2, 1e-4) == pytest.approx(0.5)
    assert converged(1.0, 1e-4, 1e-4) == converged(1.0, 0.0, 1e-4) == 1.0
    # Nothing is done yet, or the error is larger than at first or not known.
    assert converged(1.0, 1.0, 1e-4) == converged(1.0, 2.0, 1e-4) == converged(math.inf, 1.0, 1e-4) == 0.0
    assert converged(1.0, math.nan, 1e-4) == 0.0


@pytest.mark.parametrize("scheme", ["cg", "eyre-milton"])
def test_stages(monkeypatch, scheme):
    monkeypatch.setattr(progress, "SILENT", 0.0)
    monkeypatch.setattr(progress, "PAUSE", 0.0)
    said = []
    progress.on_progress(said.append)
    sphere = Sphere((0.5, 0.5, 0.5), 0.3, Material(5.0))
    try:
        fft.solve(Scene((1.0,) * 3, Material(1.0), [sphere], gradient=(1.0, 0.0, 0.0)), voxels=12, scheme=scheme)
    finally:
        progress.on_progress(None)
    assert {report.stage for report in said} >= {"voxels", "iterations"}
    assert all(0 <= report.share <= 1 for report in said)
    # From the first error most of the way.
    assert max(report.share for report in said if report.stage == "iterations") > 0.7
