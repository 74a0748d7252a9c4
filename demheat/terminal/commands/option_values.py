"""What is typed behind options, read: parts and per cent, seconds, names of methods; what is wrong names the option."""

import argparse
import re
from collections.abc import Sequence

from demheat.io.scenes.units import part_of
from demheat.io.words import nearest

PARTS = "must be a number from 1e-9 to below 1, as 0.01, or per cent, as 1%"


def accuracy(text: str) -> float:
    """A part: a number, or per cent."""
    number = part_of(text)
    if not 1e-9 <= number < 1:
        raise argparse.ArgumentTypeError(f"--accuracy {text}: {PARTS}{_meant(text)}")
    return number


def seconds(text: str) -> float:
    """A time budget."""
    number = _number(text)
    if not 0 < number < float("inf"):
        raise argparse.ArgumentTypeError(f"--seconds {text}: must be a number of seconds > 0, as 60{_meant(text)}")
    return number


def several(text: str, words: Sequence[str], option: str) -> list[str]:
    """Names with commas between them, each one of some words."""
    found = [name for name in re.split(r"[,;\s]+", text) if name]
    for name in found or [""]:
        if name not in words:
            near = nearest(name, words) or f"; must be one of {', '.join(words)}"
            raise ValueError(f"{option} {text}: no such method{'' if name == text else f', {name!r}'}{near}")
    return found


class Methods(argparse.Action):
    """Names of methods that a command takes, one or several, as often as they are given."""

    def __call__(self, parser, namespace, values, option_string=None):
        """Put the names behind those that are there."""
        names = several(values, _taken(parser.prog.split()[-1]), option_string)
        setattr(namespace, self.dest, [*(getattr(namespace, self.dest) or []), *names])


def _taken(command):
    """Methods of a command."""
    if command == "effective":
        from demheat.cheapest.ways import HOMES

        return list(HOMES)
    from demheat.declared import all_methods

    return list(all_methods())


def _number(text):
    try:
        return float(text)
    except ValueError:
        return float("nan")


def _meant(text):
    """What a number with a decimal comma is."""
    return "; decimals have a point" if re.fullmatch(r"\s*\d+,\d+\s*%?\s*", text) else ""
