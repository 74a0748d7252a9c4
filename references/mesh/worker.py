"""What the mesher's process does: forks of it read a function each, call it, and write the answer.

Every fork begins where all others began, so that a mesh does not depend on what was meshed before, and whatever gmsh
does to its process ends with it. A file that is run, of the standard library alone.
"""

import contextlib
import os
import pickle
import select
import signal
import sys
import threading

# Seconds between two signs of life, and bytes read at once.
PAUSE, PIECE = 0.2, 2**20
# Linux: what personality(2) is asked with, and its flag for addresses that are not drawn anew.
PRESENT, NOT_RANDOM = 0xFFFFFFFF, 0x0040000
UNREAD = "a shape of one's own must be in a module that another process can import, to be meshed there"


def main():
    """Have a fork read (paths, pickled function with its arguments and limits) and answer it, again and again.

    With None while it runs, then bytes, the parts of the pickled (value, error), at last a tuple: the status and the
    seconds of processor time since all began.
    """
    _same_addresses()
    channel = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    # Nothing else may write there.
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    if not hasattr(os, "fork"):
        _serve(channel, _here, 0.0)
        return
    _load(*sys.argv[1:])
    # This process reads and keeps nothing: where a fork's memory lies does not depend on what was meshed before.
    while True:
        select.select([sys.stdin], [], [])
        before = _spent()
        if (child := os.fork()) == 0:
            os._exit(_serve(channel, _forked, before))
        if os.waitpid(child, 0)[1]:
            return


def _same_addresses():
    """Begin again at addresses that are not drawn anew, on Linux where that is allowed: gmsh's meshes go by them."""
    if sys.platform != "linux" or "DEMHEAT_SAME_ADDRESSES" in os.environ:
        return
    import ctypes

    now = ctypes.CDLL(None).personality(PRESENT)
    if now >= 0 and ctypes.CDLL(None).personality(now | NOT_RANDOM) >= 0:
        os.execve(sys.executable, [sys.executable, *sys.argv], os.environ | {"DEMHEAT_SAME_ADDRESSES": "1"})


def _load(paths, function):
    """Load what a pickled function wants, so that forks have it; one that cannot be loaded is for them to tell."""
    sys.path[:] = paths.split(os.pathsep)
    with contextlib.suppress(Exception):
        pickle.loads(bytes.fromhex(function))


def _serve(channel, call, before):
    """Read and answer once; 1 at the end of what there is to read."""
    try:
        # The path first, with which the rest is found.
        sys.path[:], job = pickle.load(sys.stdin.buffer)
    except EOFError:
        return 1
    try:
        work = pickle.loads(job)
    except Exception as error:  # noqa: BLE001, whatever a module raises that is imported for it
        status = 0
        _say(channel, pickle.dumps((None, NotImplementedError(f"{UNREAD} ({error})"))))
    else:
        status = call(work, channel)
    _say(channel, (status, before + _spent()))
    return 0


def _spent():
    """Seconds of processor time of this process and those that it has waited for."""
    return sum(os.times()[:4])


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
