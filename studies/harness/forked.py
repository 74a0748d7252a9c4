"""Rows in processes that begin as copies of one which has loaded the libraries: they start in hundredths of a second.

To start Python and load what a solve needs takes some three seconds, more than most solves do. Here one process, the
first, does so once, and forks for each row; on Linux, elsewhere every row starts from nothing. A row still has its
process to itself: what it compiles, allocates and keeps ends with it. The first computes nothing. Threads that OpenBLAS
and Numba start when they are loaded are not in a copy; both make theirs anew there. When a source file changes, another
process takes the first's place.
"""

from __future__ import annotations

import gc
import importlib
import json
import os
import select
import signal
import subprocess
import sys
import traceback
from contextlib import contextmanager, suppress
from functools import cache, partial

from demheat.runtime import fresh
from studies.harness import provenance, quiet, runner

# What most rows load, whatever their method.
SCIPY = ("scipy.sparse.linalg", "scipy.sparse.csgraph", "scipy.spatial", "scipy.special", "scipy.optimize")
LIBRARIES = ("numba.np.ufunc.parallel", *SCIPY, "skfem", "pyfftw", "pyamg")
# Seconds for the first process to end.
PATIENCE = 5.0


@contextmanager
def forking(*, values=False, count=None):
    """Have a first process while rows are made."""
    if not sys.platform.startswith("linux"):
        yield partial(runner.spawn_row, environment=provenance.row_environment(count), values=values)
        return
    first, made_of = None, None

    def compute(name, study, case):
        nonlocal first, made_of
        now = _sources()
        if first is None or first.poll() is not None or now != made_of:
            _end(first)
            first, made_of = _begun(count), now
        return runner.spawn_row(name, study, case, start=partial(_started, first), values=values)

    try:
        yield compute
    finally:
        _end(first)


def _begun(count):
    """The first process, in the environment of rows: libraries read it when they are loaded."""
    words = [sys.executable, "-m", "studies", "first", str(os.getpid())]
    # Unbuffered, so that nothing that is there to be read hides from `select`.
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "bufsize": 0}
    return subprocess.Popen(words, start_new_session=True, env=provenance.row_environment(count), **pipes)


def _end(first):
    """End the first process: by itself, once it has seen the end of its row, so that nothing of that is left."""
    if first is None:
        return
    first.stdin.close()
    try:
        first.wait(PATIENCE)
    except subprocess.TimeoutExpired:
        first.kill()
        first.wait()
    first.stdout.close()


def _sources():
    """When each of our source files was changed."""
    files = (path for name in provenance.PACKAGES for path in (provenance.ROOT / name).rglob("*.py"))
    return {path: path.stat().st_mtime_ns for path in files}


def _started(first, words, log, limit):
    """Have a copy of the first process do what the command line says; return its status, as `fresh.run` does."""
    first.stdin.write(json.dumps([words, str(log)]).encode() + b"\n")
    pid = int(first.stdout.readline() or 0)
    if not pid:
        return -signal.SIGKILL
    guard = fresh.watch(pid)
    try:
        if not select.select([first.stdout], [], [], limit)[0]:
            fresh.end_group(pid)
            first.stdout.readline()
            raise subprocess.TimeoutExpired(words, limit)
        return int(first.stdout.readline() or -signal.SIGKILL)
    finally:
        fresh.end_group(pid)
        fresh.dismiss(guard)


def serve(main, parent):
    """Be the first process: for each line of orders load what that row needs and copy this process."""
    fresh.die_with_parent(parent)
    own = os.getpid()
    answers = os.dup(1)
    # What a library may print is no answer.
    os.dup2(2, 1)
    for line in sys.stdin:
        words, log = json.loads(line)
        _prepared(*words[1:3])
        pid = os.fork()
        if not pid:
            _copied(main, [*words, "--parent", str(own)], log)
        os.write(answers, f"{pid}\n".encode())
        _, status = os.waitpid(pid, 0)
        os.write(answers, f"{os.waitstatus_to_exitcode(status)}\n".encode())


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


def _prepared(name, key):
    """Load a study and what the row's method needs; if that fails, the row will say so."""
    with suppress(Exception):
        study = runner.load(name)
        case = runner.find_case(study, key)
        # What is loaded now is what the row says it was made of.
        provenance.commit(study.__file__)
        load(provenance.module_of(study, case.get("method", "")))


def _copied(main, words, log):
    """Do what the command line says, and end."""
    status = 1
    try:
        os.setsid()
        stream = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        for number, target in enumerate((os.open(os.devnull, os.O_RDONLY), stream, stream)):
            os.dup2(target, number)
        quiet.START = quiet.moment()
        status = main(words)
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else 1
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)
