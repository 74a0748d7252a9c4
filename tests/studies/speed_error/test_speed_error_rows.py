"""Only here: a scheme that gives up taken for a failed row, or any error for a refusal."""

import pytest

from studies.speed_error import rows


@pytest.mark.parametrize("name", ["third", "slab"])
def test_a_scheme_that_does_not_converge_is_a_refusal(monkeypatch, name):
    def gives_up(name, **knobs):
        raise RuntimeError("scheme: did not converge: 5000 iterations")

    monkeypatch.setattr(rows, "_march" if name == "slab" else "_steady", gives_up)
    found = rows.solved(name, method="fft", voxels=32)
    assert found == {"status": "unsupported", "note": "scheme: did not converge: 5000 iterations"}


def test_another_error_is_none(monkeypatch):
    def fails(name, **knobs):
        raise RuntimeError("no memory")

    monkeypatch.setattr(rows, "_steady", fails)
    with pytest.raises(RuntimeError, match="no memory"):
        rows.solved("third", method="fft", voxels=32)
