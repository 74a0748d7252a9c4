"""Names of a package that load with their first use: what is heavy does not load before it is asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib import import_module


def lazy_names(package: str, homes: Mapping[str, Sequence[str]]) -> Callable[[str], object]:
    """The `__getattr__` of a package: `homes` are its modules, each with the names that it has.

    What reads the source, as an editor does, finds the names by an import under TYPE_CHECKING beside it.
    """
    home_of = {name: home for home, names in homes.items() for name in names}

    def __getattr__(name):
        if name not in home_of:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(home_of[name]), name)

    return __getattr__
