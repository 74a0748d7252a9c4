"""gmsh in a process of its own: Ctrl-C ends it at once, and a crash of it is an error like others.

gmsh's library keeps to itself until a mesh is done: no signal reaches Python meanwhile; and its second mesh in a
process may be another than its first, or end the process. So one worker is kept (`references.mesh.worker`), which forks
for each mesh and keeps nothing of it. It is ended with whatever ends the wait for it, and ends itself with its parent;
a fork of the parent starts its own.
"""

import atexit
import os
import pickle
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from demheat.runtime.process_state import count_elsewhere

# Part of the work at which estimates of the time stay.
LAST = 0.95
# Of the worker. Threads would only take room: nothing there uses them. gmsh's HXT reads, on coarse round bodies, memory
# that it has not written: the C library of Linux fills all with this byte's complement first (5 % of the time), so that
# it crashes always, and its next size is taken, instead of now and then, or with another mesh each time.
ENVIRONMENT = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MALLOC_PERTURB_": "1", "PYTHONHASHSEED": "0"}
# Workers of this process with the processor seconds that were counted of each; those of them that wait for work, at
# most one, whatever the number of threads.
_workers: dict[subprocess.Popen, float] = {}
_idle: list[subprocess.Popen] = []


class Stopped(RuntimeError):
    """What a process is stopped for that it would do again."""


def run_apart(
    function: Callable,
    *arguments,
    seconds: float,
    done: Callable[[float], None],
    memory: float | None = None,
    most: float | None = None,
):
    """Call function(*arguments) in another process."""
    job = pickle.dumps((function, arguments, memory, most))
    worker = _worker(function)
    try:
        status, answer = _waited(worker, job, seconds, done)
    except (EOFError, OSError, pickle.UnpicklingError):
        _end(worker)
        raise RuntimeError(f"the mesher's process ended with status {worker.returncode}") from None
    except BaseException:
        _end(worker)
        raise
    if _idle or not hasattr(os, "fork"):
        _end(worker)
    else:
        _idle.append(worker)
    if status != 0:
        _fail(status, most)
    value, error = pickle.loads(answer)
    if error is not None:
        raise error
    return value


def _worker(function):
    """One that waits for work, or a new one, which loads what a function wants."""
    while _idle:
        try:
            worker = _idle.pop()
        except IndexError:  # another thread was faster
            break
        if worker.poll() is None:
            return worker
        _end(worker)
    if not sys.executable:
        raise RuntimeError("meshes are made in a process of their own, and sys.executable does not say which program")
    # A session of its own: Ctrl-C in a terminal is for the parent alone, who ends the worker.
    how = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "start_new_session": os.name == "posix"}
    words = [
        sys.executable,
        Path(__file__).with_name("worker.py"),
        os.pathsep.join(_paths()),
        pickle.dumps(function).hex(),
    ]
    worker = subprocess.Popen(words, env=os.environ | ENVIRONMENT, **how)
    _workers[worker] = 0.0
    return worker


def _paths():
    """Where modules are; relative paths are those of this process, which may have moved since."""
    return [os.path.abspath(each) for each in sys.path]


def _waited(worker, job, seconds, done):
    """Status and bytes of the answer."""
    pickle.dump((_paths(), job), worker.stdin)
    worker.stdin.flush()
    begin = time.monotonic()
    parts = []
    while not isinstance(word := pickle.load(worker.stdout), tuple):
        # None tells that it is alive.
        if word is not None:
            parts.append(word)
        done(min((time.monotonic() - begin) / seconds, LAST))
    status, spent = word
    count_elsewhere(spent - _workers[worker])
    _workers[worker] = spent
    return status, b"".join(parts)


def _fail(status, most):
    if os.name == "posix" and status == -signal.SIGKILL:
        raise MemoryError("gmsh was killed, most likely for want of memory: ask for a larger size of the elements")
    if os.name == "posix" and status == -signal.SIGXCPU:
        raise Stopped(
            f"gmsh was stopped after {most:.0f} s of processor time, many times what was expected: ask for another "
            "size of the elements"
        )
    raise RuntimeError(f"gmsh crashed: its process ended with status {status}")


def _end(worker):
    """End a worker and its fork."""
    if os.name == "posix" and worker.returncode is None:
        try:
            os.killpg(worker.pid, signal.SIGKILL)
        except (ProcessLookupError, PermissionError):
            pass
    worker.kill()
    for pipe in (worker.stdin, worker.stdout):
        try:
            pipe.close()
        except OSError:  # what was not sent yet
            pass
    worker.wait()
    # Now the system counts it among the children that have ended.
    count_elsewhere(-_workers.pop(worker, 0.0))


def _forget():
    """A forked child leaves its parent's workers alone, which are to hear when the parent ends."""
    for worker in _workers:
        for pipe in (worker.stdin, worker.stdout):
            pipe.raw.close()
        worker.returncode = 0
    _workers.clear()
    _idle.clear()


@atexit.register
def _end_all():
    for worker in list(_workers):
        _end(worker)


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget)
