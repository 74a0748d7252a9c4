"""gmsh in a process of its own: Ctrl-C ends it at once, and a crash of it is an error like others.

gmsh's library keeps to itself until a mesh is done: no signal reaches Python meanwhile. What may last is therefore
done by a child, which is ended with whatever ends the wait for it, and which ends itself with its parent.
"""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable

# Estimated tetrahedra, of about 2 s: the child costs 1 s, most of it imports. Less is done here, in a thread.
APART_FROM = 20_000
# Seconds between two signs of life; the share done at which estimates of the time stay.
PAUSE, LAST = 0.2, 0.95


def run_apart(
    function: Callable, *arguments, seconds: float, done: Callable[[float], None], memory: float | None = None
):
    """Call function(*arguments) in a new process.

    Parameters
    ----------
    function : callable
        Of a module, for pickle finds it by its name.
    *arguments
        Which pickle takes, as the answer.
    seconds : float
        That it takes, about.
    done : callable (share)
        Called meanwhile with the share of them that is over.
    memory : float, bytes, optional
        Of addresses that the process may have: gmsh runs away on some geometries, and would take the machine's all.

    Returns
    -------
    object
        What the function returns.

    Raises
    ------
    MemoryError
        If the process was killed, as systems do that run out of memory.
    RuntimeError
        If it crashed, as gmsh does that wants more than `memory`.
    Exception
        Whatever the function raises.
    """
    # A session of its own: Ctrl-C in a terminal is for the parent alone, who ends the child.
    knobs = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "start_new_session": os.name == "posix"}
    with subprocess.Popen([sys.executable, __file__], **knobs) as child:
        try:
            # The path first, with which the rest is found.
            pickle.dump(sys.path, child.stdin)
            pickle.dump((function, arguments, memory), child.stdin)
            child.stdin.flush()
            begin = time.monotonic()
            # Empty answers tell that the child is alive.
            while (answer := pickle.load(child.stdout)) is None:
                done(min((time.monotonic() - begin) / seconds, LAST))
            value, error = answer
            if error is not None:
                raise error
            return value
        except (EOFError, BrokenPipeError):
            _fail(child.wait())
        finally:
            child.kill()


def _fail(status):
    if os.name == "posix" and status == -signal.SIGKILL:
        raise MemoryError("gmsh was killed, most likely for want of memory: ask for a larger size of the elements")
    raise RuntimeError(f"gmsh crashed: its process ended with status {status}")


def main():
    """What the child does: read a function and its arguments, write (answer, error), and None all the while."""
    channel = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    # Nothing else may write there.
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    sys.path[:] = pickle.load(sys.stdin.buffer)
    function, arguments, memory = pickle.load(sys.stdin.buffer)
    _limit(memory)
    over = threading.Event()
    alive = threading.Thread(target=_say_alive, args=(channel, over), daemon=True)
    for thread in (alive, threading.Thread(target=_end_with_parent, daemon=True)):
        thread.start()
    try:
        answer = function(*arguments), None
    except Exception as error:  # noqa: BLE001, the parent raises it
        answer = None, error
    over.set()
    alive.join()
    pickle.dump(answer, channel)
    channel.flush()
    # At once: nothing is left to do, and the parent may hang up first.
    os._exit(0)


def _limit(memory):
    if memory is not None and os.name == "posix":
        import resource

        hard = resource.getrlimit(resource.RLIMIT_AS)[1]
        limit = int(memory) if hard == resource.RLIM_INFINITY else min(int(memory), hard)
        resource.setrlimit(resource.RLIMIT_AS, (limit, hard))


def _say_alive(channel, over):
    while not over.wait(PAUSE):
        pickle.dump(None, channel)
        channel.flush()


def _end_with_parent():
    # Nothing more is sent: the end of the pipe is the end of the parent. Not read by the buffer, which has a lock.
    os.read(sys.stdin.fileno(), 1)
    os._exit(1)


if __name__ == "__main__":
    main()
