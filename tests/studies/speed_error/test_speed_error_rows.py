"""What a row of speed against error says when a method gives up."""

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


def test_errors_of_a_row_are_those_of_its_scene():
    """Layers are exact with linear elements: conductivity, temperature and flux at the points."""
    found = rows.solved("laminate", method="fem", order=1, curved=False, size=0.02)
    # The linear solver's 1e-9 or so, in per cent.
    assert abs(found["error_percent"]) < 1e-5 and found["temperature_rms"] < 1e-5 and found["flux_rms"] < 1e-5
    assert found["points_cpu_s"] >= 0 and found["unknowns"] > 100
