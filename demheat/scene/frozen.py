"""What is handed out: a dict and arrays that refuse to be changed, and small tables for notebooks."""

from collections.abc import Mapping
from html import escape

import numpy as np


class ReadOnly(dict):
    """A dict that cannot be changed: a copy of what it is made of. `dict(it)` and `it | other` give plain dicts."""

    def _refused(self, *args, **kwargs):
        raise TypeError("this mapping is read-only, as what was made with it would not follow; change a copy, dict(it)")

    __setitem__ = __delitem__ = __ior__ = clear = pop = popitem = setdefault = update = _refused

    def __hash__(self):
        """That of what it holds: a scene with walls can be a key."""
        return hash(frozenset(self.items()))

    def __reduce__(self):
        """Copies and pickles are made from a plain dict."""
        return type(self), (dict(self),)


def read_only(array) -> np.ndarray:
    """The same numbers, without a copy, in an array that cannot be written to."""
    view = np.asarray(array).view()
    view.flags.writeable = False
    return view


def table_of(rows: Mapping[str, object]) -> str:
    """A table of two columns as HTML; what is in it is text, whatever it looks like."""
    cells = (f"<tr><th>{escape(name)}</th><td>{escape(str(value))}</td></tr>" for name, value in rows.items())
    return f"<table>{''.join(cells)}</table>"
