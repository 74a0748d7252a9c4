"""A command in a process of its own, which ends with all that it started: at its time limit, or with its parent."""

import ctypes
import json
import os
import signal
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path


def run(
    words: Sequence[str], log: Path, *, limit: float | None = None, environment: Mapping[str, str] | None = None
) -> int:
    """Run a command and return its status, negative if a signal ended it."""
    with Path(log).open("wb") as stream:
        process = subprocess.Popen(words, stdout=stream, stderr=stream, start_new_session=True, env=environment)
        guard = watch(process.pid)
        try:
            return process.wait(limit)
        finally:
            _end(process)
            dismiss(guard)


def answer_of(words: Sequence[str], *, limit: float | None = None, start: Callable = run) -> dict:
    """What a command writes as JSON into the file that is the last of its words.

    Without an answer a TimeoutError at the limit, or a ChildProcessError that says how it ended.
    """
    with tempfile.TemporaryDirectory() as folder:
        answer, log = Path(folder) / "row.json", Path(folder) / "log"
        try:
            code = start([*words, str(answer)], log, limit=limit)
        except subprocess.TimeoutExpired:
            raise TimeoutError(f"not finished after {limit:g} s") from None
        try:
            return json.loads(answer.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            raise ChildProcessError(_ending(code, log)) from None


def die_with_parent(parent: int) -> None:
    """Have the kernel kill this process when its parent dies (Linux): a killed run leaves no solve behind."""
    try:
        ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # 1 = PR_SET_PDEATHSIG
    except (OSError, AttributeError):
        return
    if os.getppid() != parent:
        os._exit(1)


def watch(pid: int) -> subprocess.Popen | None:
    """Have a shell end a process and all that it started if this process is killed; None without a shell.

    The kernel ends the process itself then, see `die_with_parent`, but not what that has started. The shell hears of it
    by the end of a pipe of which nobody else holds the other end.
    """
    words = ["sh", "-c", 'read word; kill -9 -"$0"', str(pid)]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    try:
        return subprocess.Popen(words, stdin=subprocess.PIPE, start_new_session=True, **quiet)
    except OSError:
        return None


def dismiss(guard: subprocess.Popen | None) -> None:
    """End what `watch` returned."""
    if guard is not None:
        guard.kill()
        guard.wait()
        guard.stdin.close()


def end_group(pid: int) -> None:
    """Kill a process that leads a session, and all that it started."""
    try:
        os.killpg(pid, signal.SIGKILL)
    except (ProcessLookupError, PermissionError):
        pass


def _end(process):
    """Kill a process and all that it started, and wait for it."""
    end_group(process.pid)
    process.wait()


def _ending(code, log):
    """How a process ended and what it said last, in one line."""
    how = f"process killed by {signal.Signals(-code).name}" if code < 0 else f"process ended with status {code}"
    lines = log.read_text(encoding="utf-8", errors="replace").strip().splitlines()
    return f"{how}; {lines[-1][:300] if lines else 'nothing on its output'}"
