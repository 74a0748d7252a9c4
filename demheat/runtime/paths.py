"""Names of files as users give them, files written whole or not at all, and folders in which one writes at a time."""

import os
import tempfile
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


def check_target(path) -> Path:
    """The path of a file that can be put where it says, before there is anything to put there; else a ValueError."""
    path = checked_path(path)
    if not path.parent.is_dir():
        raise ValueError(f"path = {str(path)!r}: there is no folder {str(path.parent)!r}")
    if path.is_dir():
        raise ValueError(f"path = {str(path)!r}: is a folder; must be the name of a file")
    if not _takes_files(path.parent):
        raise ValueError(
            f"path = {str(path)!r}: must lie in a folder that can be written into, not {str(path.parent)!r}"
        )
    return path


def check_output(path) -> Path:
    """The path of a folder that files can be put into, or that can be made, before there is anything to put there."""
    path = checked_path(path)
    there = next(each for each in (path, *path.absolute().parents) if each.exists())
    if not there.is_dir():
        raise ValueError(f"path = {str(path)!r}: must be a folder, and {str(there)!r} is a file")
    if not _takes_files(there):
        where = "a folder" if there == path else "in a folder"
        raise ValueError(f"path = {str(path)!r}: must be {where} that can be written into, not {str(there)!r}")
    return path


def made_folder(path: Path) -> Path:
    """A folder, made if it is not there."""
    path.mkdir(parents=True, exist_ok=True)
    return path


def _takes_files(folder):
    """Whether a file can be made in a folder: rights alone do not tell root, nor of a folder on a network."""
    try:
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


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
