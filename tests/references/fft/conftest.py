"""Blocks of the sweeps: a fixture that the tests of sweeps and of transforms share."""

import pytest

from references.fft import sweeps


@pytest.fixture(params=[1, 2**20], ids=["one by one", "many at a time"])
def blocks(request, monkeypatch):
    """Planes and columns one by one, or as many at a time as there are, the last block smaller."""
    monkeypatch.setattr(sweeps, "BLOCK_BYTES", request.param)
    monkeypatch.setattr(sweeps, "BLOCKS", 3)
