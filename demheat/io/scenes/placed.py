"""Inclusions and where they stand in a file: what a scene says of one, by its number, is said of that place."""

import math
import re
from typing import NamedTuple

NUMBERED = re.compile(r"(?:Scene\.)?inclusions\[(\d+)\](?:(?: and |, | is hidden by inclusions)\[(\d+)\])?")
SHRUNK = re.compile(r"; spheres of (\S+) times their radii would be$")


class Placed(NamedTuple):
    """An inclusion and where it stands, for messages: "scene.toml:12: inclusions[0]"."""

    shape: object
    place: str
    factor: float | None = None  # Of a sphere from a file: that of its radius


def placed_error(table, placed: list[Placed], error: ValueError) -> ValueError:
    """The error of a scene as one of the file: of an inclusion, by where that stands, or of a key."""
    found = NUMBERED.match(str(error))
    if not found:
        return table.blamed(error)
    named = [placed[int(number)] for number in found.groups() if number]
    first, *others = (each.place for each in named)
    told = str(error)[found.end() :].lstrip(": ")
    if others:
        own, other = first.rpartition(", ")[0], others[0]
        # Of the same entry of the file its place in the table is enough.
        other = other.removeprefix(f"{own}, ") if own else other
        mended = _mended([each.factor for each in named], SHRUNK.search(told)) if "overlap partially" in told else ""
        told = SHRUNK.sub("", told) if mended else told
        told = f"{found[0].removeprefix('Scene.')} {told} (the other stands in {other}){mended}"
    return ValueError(f"{first}: {told}")


def _mended(factors, shrunk):
    """Keys of a file of spheres with which these do not overlap, by the factors that it has and the one they need."""
    if not any(factors):
        return ""
    if not shrunk or factors[0] != factors[1]:
        return "; a smaller radius_factor or join = true may mend it"
    value = math.floor(1000 * factors[0] * float(shrunk[1])) / 1000
    return f"; radius_factor = {value:g} will mend it, or join = true"
