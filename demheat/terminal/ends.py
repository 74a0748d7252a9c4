"""How a command ends: a closed pipe, a full disk, Ctrl-C, and errors as one line that names the file."""

import errno
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import PurePath

# Exit status: bad input; and as a shell says of a command that SIGINT or SIGPIPE ended.
BAD, INTERRUPTED, CLOSED = 2, 130, 141
# Where `python -m` finds our commands.
OURS = ("demheat", "mpi", "studies")


def finished(command: Callable[[], int], name: str) -> int:
    """Exit status of a command, once all that it printed has left; where nobody reads on it ends as Unix tools do."""
    try:
        try:
            return command()
        finally:
            if sys.stdout is not None:
                sys.stdout.flush()
    except BrokenPipeError:
        _let_go()
        return CLOSED
    except OSError as error:
        if not of_output(error):
            raise
        _let_go()
        print(f"{name}: {error_line(error)}", file=sys.stderr)
        return BAD


def of_output(error: BaseException) -> bool:
    """Whether an error is of what is printed, which `finished` answers to: files of ours have names."""
    return isinstance(error, OSError) and error.filename is None and error.errno in (errno.EPIPE, errno.ENOSPC)


def error_line(error: BaseException) -> str:
    """An error in one line; of a file, its name first."""
    if isinstance(error, OSError) and error.strerror:
        # What is written into a file of ours has its name.
        return f"{error.filename or 'standard output, or a temporary file'}: {error.strerror}"
    return " ".join(str(error).split()) or type(error).__name__


def _let_go():
    """Let the interpreter find nothing at its end that could not be written."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, AttributeError):
            # What stands in for a stream may have no number.
            with suppress(OSError, AttributeError):
                os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def _hushed(kind, error, trace):
    """Ctrl-C ends a command that is still loading without a traceback."""
    if issubclass(kind, KeyboardInterrupt):
        os._exit(INTERRUPTED)
    sys.__excepthook__(kind, error, trace)


def _is_command(path: str) -> bool:
    """Whether a process is one of our commands, by the first of its words: "-m" while its package is loading."""
    folder, name = ("", *PurePath(path).parts)[-2:] if path else ("", "")
    return name in ("-m", "demheat", "demheat.exe") or (name == "__main__.py" and folder in OURS)


if sys.argv and _is_command(sys.argv[0]):
    sys.excepthook = _hushed
