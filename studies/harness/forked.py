"""Rows in copies of a process which has loaded the libraries, `demheat.runtime.copies`.

To start Python and load what a solve needs takes some three seconds, more than most solves do. Threads that OpenBLAS
and Numba start when they are loaded are not in a copy; both make theirs anew there. When a source file changes, another
process takes the first's place. On other systems than Linux every row starts from nothing.
"""

import gc
import importlib
import os
import sys
from contextlib import contextmanager, suppress
from functools import cache, partial

from demheat.runtime import copies
from studies.harness import provenance, quiet, runner

# What most rows load, whatever their method.
SCIPY = ("scipy.sparse.linalg", "scipy.sparse.csgraph", "scipy.spatial", "scipy.special", "scipy.optimize")
LIBRARIES = ("numba.np.ufunc.parallel", *SCIPY, "skfem", "pyfftw", "pyamg")


@contextmanager
def forking(*, values=False, count=None):
    """Have a first process while rows are made, in the environment of rows: libraries read it when they are loaded."""
    environment = provenance.row_environment(count)
    if not sys.platform.startswith("linux"):
        yield partial(runner.spawn_row, start=partial(runner.started, environment=environment), values=values)
        return
    first, made_of = None, None

    def compute(name, study, case):
        nonlocal first, made_of
        now = _sources()
        if first is None or not first.alive() or now != made_of:
            if first is not None:
                first.end()
            words = [sys.executable, "-m", "studies", "first", str(os.getpid())]
            first, made_of = copies.First(words, environment), now
        return runner.spawn_row(name, study, case, start=first.run, values=values)

    try:
        yield compute
    finally:
        if first is not None:
            first.end()


def _sources():
    """When each of our source files was changed."""
    files = (path for name in provenance.PACKAGES for path in (provenance.ROOT / name).rglob("*.py"))
    return {path: path.stat().st_mtime_ns for path in files}


def serve(main, parent):
    """Be the first process."""

    def begun(words):
        quiet.START = quiet.moment()
        return main(words)

    copies.serve(begun, _prepared, parent)


@cache
def load(path):
    """Load what rows of a method need, and compute nothing with it; what is missing is for the row to tell."""
    for name in LIBRARIES if path else ():
        with suppress(ImportError):
            importlib.import_module(name)
    with suppress(ImportError, AttributeError, ValueError):
        # Modules of methods load their solver when it is asked for.
        importlib.import_module(path).solve  # noqa: B018
    if path:
        _numba_ready()
    # Nothing of this is garbage: a row need not look through it.
    gc.collect()
    gc.freeze()


@cache
def _numba_ready():
    """Have Numba fill its tables of what it can compile, half a second for whatever function is first."""
    with suppress(ImportError):
        import numba

        numba.njit(lambda value: value + 1.0)(1.0)


def _prepared(words):
    """Load a study and what the row's method needs; if that fails, the row will say so."""
    with suppress(Exception):
        _, name, key, *_ = words
        study = runner.load(name)
        case = runner.find_case(study, key)
        # What is loaded now is what the row says it was made of.
        provenance.commit(study.__file__)
        load(provenance.module_of(study, case.get("method", "")))
