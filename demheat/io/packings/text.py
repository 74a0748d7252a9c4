"""Lines of text files, counted, and the tables of numbers in them."""

import re
import sys
from functools import partial
from itertools import chain, islice
from pathlib import Path
from typing import NamedTuple

import numpy as np

from demheat.io.packings.source import text_of
from demheat.runtime.limits import ALWAYS, check_free

# Rows formatted at once, and read: their Python objects stay few, and what they take is looked at.
CHUNK, PIECE = 10_000, 100_000
# Characters of a line, and bytes of its text besides them.
LONGEST_LINE, OBJECT = 1_000_000, 57
MARK = re.compile(
    r"demheat packing: size {0} {0} {0}, periodic ([TF]) ([TF]) ([TF]), domain ([\w-]+)".format(
        # One way only to match digits: with two, a line of them would take the square of its length.
        r"(\d+(?:\.\d*)?(?:e[+-]?\d+)?)"
    ),
    re.ASCII,
)


class Rows(NamedTuple):
    """Lines of a table: their texts, the number of the first, and how many there should be (None: any)."""

    texts: list[str]
    first: int
    count: int | None


class Lines:
    """A text file (packed too, if it ends in .gz) as lines counted from 1."""

    def __init__(self, path):
        self.path, self.number = Path(path), 0
        self._file = text_of(self.path)
        self._stream = iter(partial(self._file.readline, LONGEST_LINE), "")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._file.close()

    def take(self):
        """Return the next line without the blanks around it, or None at the end of the file."""
        line = next(self._stream, None)
        if line is None:
            return None
        self.number += 1
        if len(line) >= LONGEST_LINE:
            self._check_lengths([line], self.number)
        return line.strip()

    def put_back(self, line):
        """Undo the last `take`, which gave `line`."""
        self._stream = chain([line], self._stream)
        self.number -= 1

    def take_rows(self, count=None) -> Rows:
        """Take up to `count` lines (all that are left if None) as they are, fewer only at the end of the file."""
        texts, used, left = [], 0, sys.maxsize if count is None else count
        first = self.number + 1
        while piece := list(islice(self._stream, min(PIECE, left - len(texts)))):
            self._check_lengths(piece, self.number + 1)
            self.number += len(piece)
            texts += piece
            more = used + sum(map(len, piece)) + OBJECT * len(piece)
            if more // ALWAYS > used // ALWAYS:
                # Their numbers take about a third of that besides.
                check_free(self.path, max(more / 3, ALWAYS + 1))
            used = more
        return Rows(texts, first, count)

    def _check_lengths(self, lines, first):
        if max(map(len, lines)) >= LONGEST_LINE:
            number = first + next(k for k, line in enumerate(lines) if len(line) >= LONGEST_LINE)
            raise self.broken(f"a line of {LONGEST_LINE} characters or more", "a shorter one", number=number)

    def broken(self, found, expected, *, number=None) -> ValueError:
        """The error to raise for a line."""
        if found is None:
            return broken(self.path, self.number + 1, "the end of the file", expected)
        return broken(self.path, number or self.number, found, expected)


def broken(path, number, found, expected) -> ValueError:
    """The one form of error of a broken file."""
    found = found if len(found) <= 100 else found[:100] + "..."
    return ValueError(f"{path}, line {number}: found {found}; expected {expected}")


def floats(lines, words, count, expected):
    """Cast the first words of the line last taken, or raise the error of a broken file."""
    try:
        values = np.array([float(word) for word in words[:count]])
    except ValueError:
        values = np.array([])
    if len(values) != count or not np.all(np.isfinite(values)):
        raise lines.broken(repr(" ".join(words)), expected)
    return values


def whole(lines, word, expected, *, least=None) -> int:
    """Cast a word of the line last taken to an integer, or raise the error of a broken file."""
    try:
        value = int(word)
    except (TypeError, ValueError):
        raise lines.broken(repr(word) if word is not None else None, expected) from None
    if abs(value) > sys.maxsize:
        raise lines.broken(repr(word), f"{expected}, at most {sys.maxsize}")
    if least is not None and value < least:
        raise lines.broken(repr(word), f"{expected}, >= {least}")
    return value


def read_table(lines, rows, columns, names, *, extra=()):
    """Read rows of numbers."""
    texts, first, count = rows
    numbers = range(first, first + len(texts))
    if any("#" in text for text in texts):
        texts = [text.partition("#")[0] for text in texts]
    widths = list(map(len, map(str.split, texts)))
    if count is None and 0 in widths:
        kept = [k for k, width in enumerate(widths) if width]
        texts, numbers, widths = ([column[k] for k in kept] for column in (texts, numbers, widths))
    _check_widths(lines, texts, numbers, widths, [names, extra], count)
    try:
        values = np.loadtxt(texts, usecols=list(columns.values()), comments=None, ndmin=2)
    except ValueError as error:
        raise _not_a_number(lines, texts, numbers, columns, error) from None
    return dict(zip(columns, values.T, strict=True)), numbers


def write_rows(stream, template, *columns):
    """Write one line per row."""
    for start in range(0, len(columns[0]), CHUNK):
        rows = zip(*(column[start : start + CHUNK].tolist() for column in columns), strict=True)
        stream.write("".join([template % row for row in rows]))


def numerals(values) -> str:
    """Floats as the shortest text that reads back to the same bits, blanks between them."""
    return " ".join(map(repr, np.ravel(values).tolist()))


def flags(periodic, true="T", false="F") -> str:
    """Periodic and walled axes as words."""
    return " ".join(true if flag else false for flag in periodic)


def mark(packing) -> str:
    """What a comment must say for `marked` to know the box of a packing."""
    box = f"size {numerals(packing.size)}, periodic {flags(packing.periodic)}, domain {packing.domain}"
    return f"demheat packing: {box}"


def marked(line):
    """(size, periodic, domain) as `mark` has written them into a line, or None."""
    found = MARK.search(line)
    if found is None:
        return None
    *numbers, domain = found.groups()
    return np.array(numbers[:3], dtype=float), np.array([flag == "T" for flag in numbers[3:]]), domain


def _check_widths(lines, texts, numbers, widths, names, count):
    """Raise for the first row that has another number of columns than it should, and for rows that lack."""
    usual, full = list(names[0]), [*names[0], *names[1]]
    columns = full if widths[:1] == [len(full)] else usual
    said = f"{f' of {count}' if count else ''}, {len(columns)} columns: {' '.join(columns)}"
    if set(widths) - {len(columns)}:
        k = next(k for k, width in enumerate(widths) if width != len(columns))
        raise lines.broken(f"{widths[k]} columns, {texts[k].strip()!r}", f"row {k + 1}{said}", number=numbers[k])
    if not texts or len(texts) < (count or 0):
        raise lines.broken(None, f"row {len(texts) + 1}{said}")


def _is_number(word):
    """Whether the fast reader takes a word; Python takes more: underscores between digits, digits of all scripts."""
    try:
        float(word)
    except ValueError:
        return False
    return word.isascii() and "_" not in word


def _not_a_number(lines, texts, numbers, columns, error):
    """The error of the first word that is not a number; `error` is what the fast reader said."""
    for number, text in zip(numbers, texts, strict=True):
        words = text.split()
        for name, index in columns.items():
            if not _is_number(words[index]):
                return lines.broken(f"{name} = {words[index]!r}", f"a number in column {index + 1}", number=number)
    return ValueError(f"{lines.path}: {error}")
