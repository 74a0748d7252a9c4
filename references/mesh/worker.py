"""What the mesher's process does: it calls each function that it reads in a fork of itself, and writes the answer.

Every fork begins where all others began, so that a mesh does not depend on what was meshed before, and whatever gmsh
does to its process ends with it. A file that is run, of the standard library alone.
"""

from __future__ import annotations

import os
import pickle
import select
import signal
import sys
import threading

# Seconds between two signs of life, and bytes read at once.
PAUSE, PIECE = 0.2, 2**20
UNREAD = "a shape of one's own must be in a module that another process can import, to be meshed there"


def main():
    """Read (paths, pickled function with its arguments and limits) again and again, and answer each.

    With None while it runs, then bytes, the parts of the pickled (value, error), at last a tuple: the status and the
    seconds of processor time since the last one.
    """
    channel = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    # Nothing else may write there.
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    told, call = 0.0, _forked if hasattr(os, "fork") else _here
    while True:
        try:
            # The path first, with which the rest is found.
            sys.path[:], job = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        try:
            work = pickle.loads(job)
        except Exception as error:  # noqa: BLE001, whatever a module raises that is imported for it
            status = 0
            _say(channel, pickle.dumps((None, NotImplementedError(f"{UNREAD} ({error})"))))
        else:
            status = call(work, channel)
        spent = sum(os.times()[:4])
        _say(channel, (status, spent - told))
        told = spent


def _forked(work, channel):
    """Status of a child that does the work; the bytes of its answer are handed on."""
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            # The parent is to hear the end of these from this process, whatever becomes of its child.
            os.close(channel.fileno())
            os.close(read)
            os.dup2(os.open(os.devnull, os.O_RDONLY), sys.stdin.fileno())
            with os.fdopen(write, "wb") as file:
                pickle.dump(_outcome(*work), file)
            os._exit(0)
        finally:
            os._exit(1)
    os.close(write)
    while True:
        ready, _, _ = select.select([sys.stdin, read], [], [], PAUSE)
        if sys.stdin in ready:
            # Nothing more is sent meanwhile: the end of the pipe is the end of the parent.
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            os._exit(1)
        if read not in ready:
            _say(channel, None)
        elif part := os.read(read, PIECE):
            _say(channel, part)
        else:
            break
    os.close(read)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def _here(work, channel):
    """The same without a fork, once: the parent then ends this process."""
    over = threading.Event()

    def wait():
        while not over.wait(PAUSE):
            _say(channel, None)

    alive = threading.Thread(target=wait)
    alive.start()
    answer = _outcome(*work)
    over.set()
    alive.join()
    _say(channel, pickle.dumps(answer))
    return 0


def _say(channel, word):
    pickle.dump(word, channel)
    channel.flush()


def _outcome(function, arguments, memory, seconds):
    """(Value, error)."""
    _limit(memory, seconds)
    try:
        return function(*arguments), None
    except Exception as error:  # noqa: BLE001, the parent raises it
        return None, error


def _limit(memory, seconds):
    if os.name != "posix":
        return
    import resource

    limits = {"RLIMIT_AS": memory, "RLIMIT_CPU": seconds, "RLIMIT_CORE": 0}
    for name, value in limits.items():
        kind = getattr(resource, name)
        hard = resource.getrlimit(kind)[1]
        if value is not None:
            limit = int(value) if hard == resource.RLIM_INFINITY else min(int(value), hard)
            resource.setrlimit(kind, (limit, hard))


if __name__ == "__main__":
    main()
