"""What is handed out and must not be changed: a dict and arrays that refuse it."""

from __future__ import annotations

import numpy as np


class ReadOnly(dict):
    """A dict that cannot be changed: a copy of what it is made of. `dict(it)` and `it | other` give plain dicts."""

    def _refused(self, *args, **kwargs):
        raise TypeError("this mapping is read-only, as what was made with it would not follow; change a copy, dict(it)")

    __setitem__ = __delitem__ = __ior__ = clear = pop = popitem = setdefault = update = _refused

    def __reduce__(self):
        """Copies and pickles are made from a plain dict."""
        return type(self), (dict(self),)


def read_only(array) -> np.ndarray:
    """The same numbers, without a copy, in an array that cannot be written to."""
    view = np.asarray(array).view()
    view.flags.writeable = False
    return view
