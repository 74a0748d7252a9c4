"""A TOML file as it is read: its values, the line of each key, and errors that name file, line and key."""

import re
import stat
from pathlib import Path
from typing import NamedTuple

from demheat.io.scenes.lines import lines_of
from demheat.io.words import as_toml, nearest_file
from demheat.runtime.paths import checked_path

try:
    import tomllib
except ModuleNotFoundError:  # Python 3.10
    import tomli as tomllib

# A text of so many bytes has some hundred thousand spheres, which are better off in a table of their own.
LONGEST = 2**24
POSITION = re.compile(r"(.*) \(at (?:line (\d+), column (\d+)|end of document)\)")
# As "x+ = 5".
UNQUOTED = re.compile(r"\s*\w+\+")


class Source(NamedTuple):
    """A TOML file."""

    path: Path
    values: dict
    lines: dict  # See `demheat.io.scenes.lines.lines_of`
    scales: dict  # Scales of temperatures found so far, and the first path that has each

    def line(self, path: tuple) -> int:
        """Number of the line of a key, or of what holds it."""
        while path and path not in self.lines:
            path = path[:-1]
        return self.lines.get(path, 1)

    def error(self, path: tuple, what: str) -> ValueError:
        """The error to raise about a key."""
        return ValueError(f"{self.path}:{self.line(path)}: {spelled(path)}{what}")


def read_source(path) -> Source:
    """Read a TOML file."""
    path = checked_path(path)
    text = text_of(path, LONGEST)
    try:
        values = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        found = POSITION.fullmatch(str(error))
        lines = text.count("\n") + (not text.endswith("\n"))
        told, line = (found[1], found[2] or lines) if found else (str(error), 1)
        hint = "; a key with a plus needs quotes" if UNQUOTED.match(text.splitlines()[int(line) - 1]) else ""
        raise ValueError(f"{path}:{line}: no TOML: {told[0].lower()}{told[1:]}{hint}") from None
    except (RecursionError, ValueError) as error:
        # Numbers of too many digits, and brackets within brackets without end.
        raise ValueError(f"{path}: no TOML that can be read: {as_toml(str(error))}") from None
    return Source(path, values, lines_of(text), {})


def text_of(path: Path, longest: int) -> str:
    """Text of a regular file in UTF-8, a byte order mark taken off."""
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            raise ValueError(f"{path}: must be a regular file, no folder, device or pipe")
        if status.st_size > longest:
            raise ValueError(
                f"{path}: has {status.st_size} bytes, at most {longest} are read; must be shorter, with spheres in a "
                "file of their own (file = ...)"
            )
        data = path.read_bytes()
    except OSError as error:
        told = "there is no such file" if isinstance(error, FileNotFoundError) else error.strerror
        raise ValueError(f"{path}: cannot be read: {told}{nearest_file(path)}") from None
    if b"\0" in data:
        line = data[: data.index(b"\0")].count(b"\n") + 1
        raise ValueError(f"{path}:{line}: zero bytes, as in a binary file or UTF-16; must be text in UTF-8")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise ValueError(f"{path}:{line}: byte {data[error.start]:#04x} is no UTF-8; must be text in UTF-8") from None


def spelled(path: tuple) -> str:
    """A path as people write it: inclusions[2].radius."""
    words = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in path)
    return words.removeprefix(".")
