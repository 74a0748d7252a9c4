"""Meshes of cylinders and spheres: areas of walls, volumes by the fourth power; errors of ours are not tried again."""

import math

import numpy as np
import pytest
from fem_scenes import UNIT
from numpy.testing import assert_allclose

from demheat.scene import Scene
from references.fem import space
from references.mesh import make_round
from references.mesh import round as module


@pytest.mark.parametrize(
    ("domain", "walls"),
    [("sphere", ["round"]), pytest.param("cylinder-y", ["y-", "y+", "round"], marks=pytest.mark.slow)],
)
def test_round_bodies(domain, walls):
    of = Scene((1.0, 0.7, 1.0) if domain != "sphere" else (1.0,) * 3, UNIT, initial=0.0, domain=domain)
    lids = {"y-": math.pi / 4, "y+": math.pi / 4, "round": 0.7 * math.pi if domain != "sphere" else math.pi}
    loss = []
    for size in (0.25, 0.125):
        made = make_round(of, size=size, order=2)
        on = space.tetrahedra(of, made)
        assert sorted(made.walls) == sorted(walls)
        areas = [on.walls[name][1].sum() for name in walls]
        assert_allclose(areas, [lids[name] for name in walls], rtol=0.02 * size)
        assert_allclose(on.volumes.sum(), made.volumes.sum(), rtol=1e-12)
        loss.append(abs(made.stats["volume_error"]))
    # A quadratic surface errs by the fourth power of the edge in volume; chords would by the second.
    assert loss[1] < 1e-4 and np.log2(loss[0] / loss[1]) > 3
    straight = make_round(of, size=0.125, order=1)
    assert 1e-3 < -straight.stats["volume_error"] < 0.03


def test_other_errors_are_not_tried_again(monkeypatch):
    calls = []

    def wrong(*_):
        calls.append(1)
        raise TypeError("ours")

    monkeypatch.setattr(module, "_attempt", wrong)
    with pytest.raises(TypeError, match="ours"):
        make_round(Scene((1.0,) * 3, UNIT, initial=0.0, domain="sphere"), size=0.4, order=1)
    assert len(calls) == 1
