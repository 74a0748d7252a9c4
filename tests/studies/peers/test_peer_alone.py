"""What a program costs, measured by a process that is small."""

import sys

import pytest

from studies.peers.alone import packaged, ran_alone


def test_cost_is_its_own():
    """This process has far more memory than a Python that fills 64 MiB."""
    printed, cost = ran_alone([sys.executable, "-I", "-S", "-c", "x = bytearray(64 << 20); print('done')"])
    assert printed.strip() == "done"
    assert 64 < cost["peak_mib"] < 100
    assert 0 < cost["cpu_s"] < 5 and cost["whole"]


def test_what_fails_says_why():
    with pytest.raises(RuntimeError, match="exit status 3: no luck"):
        ran_alone([sys.executable, "-c", "import sys; print('no luck', file=sys.stderr); sys.exit(3)"])


def test_no_such_package():
    assert packaged("no-such-package") == ""
