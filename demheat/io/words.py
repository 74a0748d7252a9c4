"""Words of errors about what is read: values cut short, and what may have been meant."""

import difflib
from difflib import SequenceMatcher
from pathlib import Path

SHOWN = 60
# Letters at least of a word within another.
PART = 4
# Of names of files: three of four letters.
ALIKE = 0.75


def as_toml(value) -> str:
    """A value for a message, cut if it is long; flags as TOML has them."""
    text = str(value).lower() if isinstance(value, bool) else repr(value)
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}..."


def nearest(word: str, words) -> str:
    """A suggestion for a word that is not known; empty if none is near."""
    lower = {each.lower(): each for each in words}
    word = word.lower()
    found = difflib.get_close_matches(word, lower, n=1)
    # "points" for "points_per_axis".
    found = found or [each for each in lower if min(len(word), len(each)) >= PART and (word in each or each in word)]
    return f"; did you mean {lower[found[0]]!r}?" if found else ""


def nearest_file(path: Path) -> str:
    """A suggestion for a file that is not there: one beside it whose name before the dot is like its; or empty."""
    try:
        names = [each.name for each in path.parent.iterdir()]
    except OSError:
        return ""
    # Endings are alike in most folders, and say nothing.
    stem = path.stem.lower()
    alike = [each for each in names if SequenceMatcher(None, stem, Path(each).stem.lower()).ratio() >= ALIKE]
    found = difflib.get_close_matches(path.name, alike, n=1, cutoff=0.0)
    return f"; did you mean {found[0]!r}?" if found else ""
