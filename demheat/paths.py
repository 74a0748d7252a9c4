"""Names of files as users give them, and files written whole or not at all."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
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


@contextmanager
def replaced(path: Path) -> Iterator[Path]:
    """Path of a temporary file that takes the place of `path` at the end, unless an exception comes first.

    Parameters
    ----------
    path : Path
        Its folder is there.
    """
    # The suffix stays last: drawing libraries tell the format by it.
    part = path.with_name(f".{path.stem}.{os.getpid()}.{threading.get_ident()}.part{path.suffix}")
    try:
        yield part
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)
