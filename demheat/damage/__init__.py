"""Damage: inclusions that have come off, links that are gone, insulated cracks."""

from importlib import import_module

# What is heavy loads with the first call.
_HOMES = {
    "Disc": "cracks",
    "Rectangle": "cracks",
    "cracked": "cracks",
    "debonded": "inclusions",
    "solve": "solver",
    "without_links": "links",
}
__all__ = list(_HOMES)  # noqa: PLE0605, found by `__getattr__`


def __getattr__(name):
    if name in _HOMES:
        return getattr(import_module(f"demheat.damage.{_HOMES[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
