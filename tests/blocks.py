"""Blocks of code in pages of the manual: what they are, and whether what they print is what the page says."""

import re
from pathlib import Path
from typing import NamedTuple

DOCS = Path(__file__).parents[1] / "docs"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
NUMBER = re.compile(r"-?\d+\.?\d*(?:e-?\d+)?")
# Of numbers on pages: meshes and packings may differ with versions of libraries, and are coarse here.
CLOSE = 0.01


class Block(NamedTuple):
    """A block of a page, and what the page says that it prints: None if nothing."""

    kind: str
    text: str
    printed: str | None


def blocks(page):
    """All blocks of a page but those of text, in order."""
    found = BLOCK.findall((DOCS / page).read_text(encoding="utf-8"))
    after = [*found[1:], ("", "")]
    return [
        Block(kind, text, said if then == "text" else None)
        for (kind, text), (then, said) in zip(found, after, strict=True)
        if kind != "text"
    ]


def check_alike(printed, said):
    """Words are those that the page says, numbers close to those; "..." is the rest of a line, or of all."""
    lines = printed.rstrip("\n").split("\n")
    for number, line in enumerate(said.rstrip("\n").split("\n")):
        if line == "...":
            return
        assert number < len(lines), f"not printed: {line}"
        words, got = line.split(), lines[number].split()
        if words[-1:] == ["..."]:
            words, got = words[:-1], got[: len(words) - 1]
        assert len(words) == len(got), f"{lines[number]!r} is printed, {line!r} said"
        for word, other in zip(words, got, strict=True):
            _check_word(word, other, lines[number])
    assert len(lines) == number + 1, f"also printed: {lines[number + 1 :]}"


def _check_word(said, printed, line):
    assert NUMBER.sub("#", said) == NUMBER.sub("#", printed), f"{said!r} said, {printed!r} printed in {line!r}"
    for one, other in zip(NUMBER.findall(said), NUMBER.findall(printed), strict=True):
        assert abs(float(one) - float(other)) <= CLOSE * abs(float(one)), f"{one} said, {other} printed in {line!r}"
