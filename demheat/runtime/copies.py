"""Commands in copies of one process that has loaded what they need: they start in hundredths of a second, on Linux.

The first process computes nothing; it loads, and forks for each command, which has its process to itself: what it
compiles, allocates and keeps ends with it.
"""

import json
import os
import select
import signal
import subprocess
import sys
import traceback
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from demheat.runtime import fresh

# Seconds for the first process to end.
PATIENCE = 5.0


class First:
    """The first process, as its parent sees it: a command that calls `serve`."""

    def __init__(self, words: Sequence[str], environment: Mapping[str, str]):
        # Unbuffered, so that nothing that is there to be read hides from `select`.
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "bufsize": 0}
        self.process = subprocess.Popen(words, start_new_session=True, env=environment, **pipes)

    def alive(self) -> bool:
        """Whether it can be asked for copies."""
        return self.process.poll() is None

    def run(self, words: Sequence[str], log: Path, *, limit: float | None = None) -> int:
        """Have a copy do what a command line says; return its status, as `fresh.run` does."""
        answers = self.process.stdout
        self.process.stdin.write(json.dumps([words, str(log)]).encode() + b"\n")
        pid = int(answers.readline() or 0)
        if not pid:
            return -signal.SIGKILL
        guard = fresh.watch(pid)
        try:
            if not select.select([answers], [], [], limit)[0]:
                fresh.end_group(pid)
                answers.readline()
                raise subprocess.TimeoutExpired(words, limit)
            return int(answers.readline() or -signal.SIGKILL)
        finally:
            fresh.end_group(pid)
            fresh.dismiss(guard)

    def end(self) -> None:
        """Let it end by itself, once it has seen the end of its copy, so that nothing of that is left."""
        self.process.stdin.close()
        try:
            self.process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.process.stdout.close()


def serve(main: Callable[[list[str]], int], prepare: Callable[[list[str]], None], parent: int) -> None:
    """Be the first process: for each command load what it needs and have a copy call `main`."""
    fresh.die_with_parent(parent)
    own = os.getpid()
    answers = os.dup(1)
    # What a library may print is no answer.
    os.dup2(2, 1)
    for line in sys.stdin:
        words, log = json.loads(line)
        prepare(words)
        pid = os.fork()
        if not pid:
            _copied(main, [*words, "--parent", str(own)], log)
        os.write(answers, f"{pid}\n".encode())
        _, status = os.waitpid(pid, 0)
        os.write(answers, f"{os.waitstatus_to_exitcode(status)}\n".encode())


def _copied(main, words, log):
    """Do what the command line says, and end."""
    status = 1
    try:
        os.setsid()
        stream = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        for number, target in enumerate((os.open(os.devnull, os.O_RDONLY), stream, stream)):
            os.dup2(target, number)
        status = main(words)
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else 1
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)
