"""The name of a machine: generations of processors that share a name are told apart."""

import os

import pytest

from demheat.runtime import machine as module

EPYC = "processor\t: 0\nvendor_id\t: AuthenticAMD\ncpu family\t: 26\nmodel\t\t: 2\nmodel name\t: AMD EPYC\n"
OTHER = EPYC.replace("26", "25").replace(": 2\n", ": 17\n")


@pytest.fixture
def named(tmp_path, monkeypatch):
    """The name by such a file."""
    monkeypatch.setattr(module, "CPUINFO", tmp_path / "cpuinfo")
    monkeypatch.setattr("platform.processor", lambda: "")
    monkeypatch.setattr("platform.machine", lambda: "aarch64")

    def named(text):
        if text is not None:
            module.CPUINFO.write_text(text)
        return module.machine.__wrapped__()

    return named


@pytest.mark.parametrize(
    ("text", "model"),
    [
        # Of several processors the first.
        (EPYC + "\n" + OTHER, "AMD EPYC (family 26, model 2)"),
        (OTHER, "AMD EPYC (family 25, model 17)"),
        ("model name\t: Some CPU\n", "Some CPU"),
        ("cpu family\t:\nmodel\t: 7\nmodel name\t: Some CPU\n", "Some CPU (model 7)"),
        # Of others than x86 no model is named there.
        ("processor\t: 0\nBogoMIPS\t: 50.00\nCPU part\t: 0xd0c\n", "aarch64"),
        (None, "aarch64"),
    ],
)
def test_the_name_has_family_and_model_where_the_system_knows_them(named, text, model):
    assert named(text) == f"{model}, {os.cpu_count()} processors"
