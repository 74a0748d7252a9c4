"""Names of files as users give them, files written whole or not at all, and folders in which one writes at a time."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


def checked_path(path) -> Path:
    """A name as the path of a file, or a ValueError."""
    try:
        path = Path(path)
    except TypeError:
        raise ValueError(f"path = {path!r}: must be the name of a file, or its path") from None
    if "\0" in str(path):
        raise ValueError(f"path = {str(path)!r}: must be the name of a file; none has a zero byte")
    return path


def check_folder(path: Path) -> None:
    """Raise ValueError unless a file can be put where a path says, before there is anything to put there."""
    if not path.parent.is_dir():
        raise ValueError(f"path = {str(path)!r}: there is no folder {str(path.parent)!r}")
    if path.is_dir():
        raise ValueError(f"path = {str(path)!r}: is a folder; must be the name of a file")
    if not os.access(path.parent, os.W_OK):
        raise ValueError(
            f"path = {str(path)!r}: must lie in a folder that can be written into, not {str(path.parent)!r}"
        )


def output_folder(path) -> Path:
    """A folder that files can be put into, made if it is not there."""
    path = checked_path(path)
    path.mkdir(parents=True, exist_ok=True)
    if not os.access(path, os.W_OK):
        raise ValueError(f"{path}: must be a folder that can be written into")
    return path


@contextmanager
def replaced(path: Path) -> Iterator[Path]:
    """Path of a temporary file that takes the place of `path` at the end, unless an exception comes first.

    Errors of the system, such as a full disk, name `path`.
    """
    # The suffix stays last: drawing libraries tell the format by it.
    part = path.with_name(f".{path.stem}.{os.getpid()}.{threading.get_ident()}.part{path.suffix}")
    try:
        yield part
        os.replace(part, path)
    except OSError as error:
        # Without a name, as writes are, or of the part, of which nobody knows. NumPy's have no number either.
        if error.filename not in (None, str(part)) or isinstance(error, BrokenPipeError):
            raise
        if error.errno is None:
            raise OSError(f"{path}: cannot be written: {error}") from None
        raise OSError(error.errno, error.strerror, str(path)) from None
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Wait for others that write into a folder, and let them wait; without locks where the system has none."""
    try:
        import fcntl

        handle = os.open(folder, os.O_RDONLY)
    except (ImportError, OSError):
        yield
        return
    try:
        with suppress(OSError):
            fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)
