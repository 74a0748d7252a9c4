"""Modules by names that they have not: those of 0.2.0, which warn in 0.3 alone, and misspelt ones, which are told."""

import sys
import warnings
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from pkgutil import iter_modules

MOVED = {
    "demheat.files": "demheat.io.scenes",
    "demheat.packing.io": "demheat.io.packings",
    "demheat.slices": "demheat.terminal.slices",
    "demheat.commands": "demheat.terminal.commands",
    "demheat.build": "demheat.dem.networks",
}
OURS = ("demheat", "references")
# Functions of importlib that import, and that look for what a `from` import names.
IMPORTING, FROM = "_find_and_load_unlocked", "_handle_fromlist"
# Letters that two names share, over those of both: "sovle" and "solve" have .8, "ftt" and "fft" .67.
NEAR = 0.65


class Renamed(MetaPathFinder, Loader):
    """Finds modules by their old names."""

    def find_spec(self, name, path=None, target=None):
        """Of an old name; None of others."""
        if name not in MOVED:
            return None
        warnings.warn(f"{name} is now {MOVED[name]}", DeprecationWarning, stacklevel=2)
        return ModuleSpec(name, self)

    def exec_module(self, module):
        """Put the new one in its place: what stands there in the end is what is imported."""
        sys.modules[module.__name__] = import_module(MOVED[module.__name__])


class Misspelt(MetaPathFinder):
    """Asked last: says of a name that nobody finds, and that is nearly one of its package, what may have been meant."""

    def find_spec(self, name, path=None, target=None):
        """None, or the error: who only asks whether there is such a module, by `importlib.util.find_spec`, has None."""
        package, _, last = name.rpartition(".")
        asking = _asking()
        if package.partition(".")[0] not in OURS or package not in sys.modules or IMPORTING not in asking:
            return None
        # Loads only where something has gone wrong.
        from difflib import get_close_matches

        home = sys.modules[package]
        known = {each for each in (*dir(home), *(each.name for each in iter_modules(path or ()))) if each[0] != "_"}
        near = get_close_matches(last, sorted(known), n=1, cutoff=NEAR)
        if near:
            # Of a `from` import Python keeps to itself what was not found by its own name.
            told = None if FROM in asking else name
            raise ModuleNotFoundError(
                f"No module named {name!r}; did you mean `from {package} import {near[0]}`?", name=told
            )
        return None


def _asking():
    """Names of the functions of importlib that ask for a module."""
    names, frame = [], sys._getframe(2)
    while frame is not None and frame.f_code.co_filename.startswith("<frozen importlib"):
        names.append(frame.f_code.co_name)
        frame = frame.f_back
    return names


# Before others: a folder that is left over, with nothing but compiled files in it, would be found as an empty package.
sys.meta_path.insert(0, Renamed())
sys.meta_path.append(Misspelt())
