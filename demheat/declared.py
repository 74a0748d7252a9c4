"""Methods found where their modules declare them: loaded by their names alone, so that nothing heavy loads early."""

import pkgutil
import re
from dataclasses import replace
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

from demheat.method import Method

# Packages whose modules are the methods.
HOMES = ("demheat", "references")


@cache
def all_methods() -> dict[str, Method]:
    """All methods by name: those that compute fields, then formulas, then witnesses, each by home and module.

    Only modules whose source declares `METHODS` are loaded.
    """
    methods = []
    for home in HOMES:
        for module in sorted(each.name for each in pkgutil.iter_modules(import_module(home).__path__)):
            if _declares(f"{home}.{module}"):
                declared = import_module(f"{home}.{module}").METHODS
                methods += [replace(method, module=module) for method in declared]
    # The sort is stable.
    methods.sort(key=lambda method: 2 if method.role == "witness" else method.call == "estimate")
    names = [method.name for method in methods]
    if len(set(names)) < len(names):
        raise ValueError(f"methods {sorted(name for name in names if names.count(name) > 1)}: declared more than once")
    return dict(zip(names, methods, strict=True))


def path_of(method: str) -> str:
    """Path of a method's module by its name, the last part of it; empty if there is no such module."""
    paths = (f"{home}.{method}" for home in HOMES)
    return next((path for path in paths if method and find_spec(path)), "")


def load(method: str, part: str = ""):
    """Module of a method by its name, as "fem"; or a part of it, as "ranks"."""
    if not path_of(method):
        raise ValueError(f"method = {method!r}: must be a module of {' or '.join(HOMES)}")
    return import_module(f"{path_of(method)}.{part}" if part else path_of(method))


def _declares(path):
    return bool(re.search(r"^METHODS\b", Path(find_spec(path).origin).read_text(encoding="utf-8"), re.MULTILINE))
