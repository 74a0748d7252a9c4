"""Names of a package that load with their first use: what is heavy does not load before it is asked for."""

import sys
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module

from demheat.runtime.extras import extra


def lazy_names(
    package: str, homes: Mapping[str, Sequence[str]]
) -> tuple[Callable[[str], object], Callable[[], list[str]]]:
    """The `__getattr__` and `__dir__` of a package: `homes` are its modules, each with the names that it has.

    What reads the source, as an editor does, finds the names by an import under TYPE_CHECKING, and these two in its
    `else`: where a type checker sees a `__getattr__`, it takes every misspelt name.
    """
    home_of = {name: home for home, names in homes.items() for name in names}

    def found(name):
        if name not in home_of:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        with extra(package):
            return getattr(import_module(home_of[name]), name)

    # Python goes by it where it suggests another name.
    def listed():
        return sorted({*vars(sys.modules[package]), *home_of})

    return found, listed
