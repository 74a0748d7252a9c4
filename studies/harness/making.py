"""Which files of `studies` make a study's rows: no other can move one.

These are the study's own file or folder, what all studies have in common, and files or folders of other studies which
any of these imports, in functions or by name included. Left out is what reads rows, by the convention in `runner`
(`figure.py` and `tables.py`, but where a module loads them at once), and what of the harness no row's making executes
(or for its stamp alone: this file). Of the engine, all of which may make a row, and of what all studies have in common
those rooms are left out that only a study which names them enters.
"""

import ast
import re
from functools import cache
from pathlib import Path

EVERYBODYS = ("common", "harness", "paper")
READING = ("figure.py", "tables.py")
# Of the harness; a test traces a row's making.
READERS = (
    *("making", "accept", "claims", "explained", "figures", "groups", "html", "lasting"),
    *("pictures", "readme", "replay", "report", "table", "tolerance"),
)
# As git has it.
EXCEPT = ":(exclude)"
# Rooms that no other enters, but the front, commands and sweeps, and how it has them named: laws of costs, and who asks
# these, are fitted to rows of a study, and would make all others old.
APART = {"demheat/cheapest": ("cheapest", "effective", "recommend", "sweep")}
# Of what all studies have in common: searches, which two of them make.
SHARED = ("common/searches",)
# A module that is named in words, to be loaded when it is asked for.
NAMED = re.compile(r"(studies|demheat)(\.\w+)+")


@cache
def paths_of(root: Path, file: str) -> tuple[str, ...]:
    """Files and folders that make the rows of a study's file; with `EXCEPT` before them what of these does not."""
    top = root / "studies"
    own = _home(top, Path(Path(file).relative_to(top).parts[0]).stem)
    homes, loaded, seen = {*(top / name for name in EVERYBODYS), own}, set(), None
    readers = {top / "harness" / f"{name}.py" for name in READERS}
    while seen != (homes, loaded):
        seen = homes, loaded
        closed = {top / room for room in SHARED} - homes
        files = {path for home in homes for path in _modules(home) if path.name not in READING or path in loaded}
        files = {path for path in files if not closed.intersection(path.parents)}
        names = {name for path in files - readers for name in _imported(path)[0]}
        homes = homes | {_home(top, name.split(".")[1]) for name in names if name.startswith("studies.")}
        homes = homes | {top / room for room in SHARED if any(_inside(name, room) for name in names)}
        loaded = loaded | {_file(root, name) for path in files - readers for name in _imported(path)[1]}
    out = readers | closed | {path.parent / name for path in files for name in READING} - loaded
    named = tuple(name.removeprefix("demheat.") for name in names if name.startswith("demheat."))
    out |= {root / room for room, ways in APART.items() if not any(name.startswith(ways) for name in named)}
    made = sorted(path.relative_to(root).as_posix() for path in homes if path.exists())
    return (*made, *sorted(f"{EXCEPT}{path.relative_to(root).as_posix()}" for path in out))


def _inside(name, room):
    """Whether a module's name is in a room."""
    return f"{name}.".startswith(f"studies.{room.replace('/', '.')}.")


def _home(top, name):
    """A study's folder, or its file."""
    return top / name if (top / name).is_dir() else top / f"{name}.py"


def _modules(home):
    return home.rglob("*.py") if home.is_dir() else [home] if home.exists() else []


def _file(root, name):
    return root.joinpath(*name.split(".")).with_suffix(".py")


@cache
def _imported(path):
    """Names of ours that a module imports, or has in words; and those that it imports outside of functions."""
    tree = ast.parse(path.read_bytes())
    names = [name for node in ast.walk(tree) for name in _names(node)]
    at_once = [name for node in tree.body for name in _names(node)]
    return [[name for name in each if NAMED.fullmatch(name)] for each in (names, at_once)]


def _names(node):
    if isinstance(node, ast.Import):
        return [each.name for each in node.names]
    if isinstance(node, ast.ImportFrom):
        return [node.module or "", *(f"{node.module}.{each.name}" for each in node.names)]
    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
        return [f"{node.value.id}.{node.attr}"]
    return [node.value] if isinstance(node, ast.Constant) and isinstance(node.value, str) else []
