"""Cases that see nothing of their own on most days are for `make test-slow`."""

import pytest


def slow_but(kept, cases):
    """All cases as parameters, marked slow but for those kept: names, numbers or tuples as they stand in the list."""
    cases = list(cases)
    assert set(kept) <= set(cases)
    return [
        case if case in kept else pytest.param(*(case if isinstance(case, tuple) else (case,)), marks=pytest.mark.slow)
        for case in cases
    ]
