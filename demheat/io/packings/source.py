"""Where packings are read from: regular files, in pieces, and never more out of them than they can honestly hold."""

import gzip
import io
import os
import stat
from pathlib import Path

from demheat.runtime.limits import ALWAYS, check_free

# What is packed may expand to so many times its length, and to `ALWAYS` in any case. Rows of a packing shrink to a
# third or so, those of a dump with columns of zeros to a tenth; what was made to be large, to a thousandth.
MOST_EXPANSION = 100


def length_of(path) -> int:
    """Length of a regular file in bytes."""
    path = Path(path)
    status = path.stat()
    if not stat.S_ISREG(status.st_mode):
        raise ValueError(f"path = {str(path)!r}: must be a regular file, no folder, device or pipe")
    check_free(path, status.st_size)
    return status.st_size


def most_unpacked(length: int) -> int:
    """Bytes that a packed file of a length in bytes may expand to."""
    return max(ALWAYS, MOST_EXPANSION * length)


def text_of(path) -> io.TextIOWrapper:
    """Text of a regular file, unpacked if it ends in .gz."""
    length = length_of(path)
    # Does not wait if the file has just become a pipe.
    raw = open(path, "rb", opener=lambda name, flags: os.open(name, flags | getattr(os, "O_NONBLOCK", 0)))
    if Path(path).suffix.lower() == ".gz":
        raw = io.BufferedReader(_Bounded(path, raw, most_unpacked(length)))
    # Foreign comments may be in any encoding; what is read from them is not.
    return io.TextIOWrapper(raw, encoding="utf-8", errors="replace")


class _Bounded(io.RawIOBase):
    """What a packed stream expands to, up to a limit."""

    def __init__(self, path, raw, most):
        self._path, self._raw, self._most, self._left = path, raw, most, most
        self._file = gzip.GzipFile(fileobj=raw)

    def readable(self):
        return True

    def readinto(self, buffer):
        """Fill a buffer; number of bytes."""
        count = self._file.readinto(buffer)
        self._left -= count
        if self._left < 0:
            raise ValueError(f"{self._path}: expands to more than {self._most} bytes; no packing does")
        return count

    def close(self):
        """Close the file as well."""
        self._file.close()
        self._raw.close()
        super().close()
