"""Modules that the manual of 0.2.0 showed under other names: found where they are now, with a warning, in 0.3 alone."""

from __future__ import annotations

import sys
import warnings
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec

MOVED = {
    "demheat.files": "demheat.io.scenes",
    "demheat.packing.io": "demheat.io.packings",
    "demheat.slices": "demheat.terminal.slices",
    "demheat.commands": "demheat.terminal.commands",
    "demheat.build": "demheat.dem.networks",
}


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


# Before others: a folder that is left over, with nothing but compiled files in it, would be found as an empty package.
sys.meta_path.insert(0, Renamed())
