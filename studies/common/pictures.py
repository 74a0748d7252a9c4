"""Pictures of many pixels as one short cell of a table, and back: whole steps, differences along rows, compressed."""

import base64
import zlib

import numpy as np

# Readers of CSV take no longer cells than 131072 characters.
LONGEST = 131_072


def packed(values, step):
    """Square picture as a cell."""
    values = np.asarray(values, dtype=float)
    if values.ndim != 2 or values.shape[0] != values.shape[1] or not np.isfinite(values).all():
        raise ValueError(f"picture of shape {values.shape}: must be square, of finite numbers")
    whole = np.ascontiguousarray(np.diff(np.round(values / step), axis=1, prepend=0.0), dtype="<i4")
    # The four bytes of all differences one after the other: high ones hardly differ.
    planes = np.ascontiguousarray(whole.view(np.uint8).reshape(-1, 4).T)
    text = f"{len(values)}:{float(step)!r}:" + base64.b64encode(zlib.compress(planes.tobytes(), 9)).decode("ascii")
    if len(text) > LONGEST:
        raise ValueError(f"picture of {len(text)} characters: a cell has {LONGEST} at most; use a larger step")
    return text


def unpacked(text):
    """The picture of a cell, (n, n) float array."""
    try:
        side, step, rest = str(text).split(":")
        planes = np.frombuffer(zlib.decompress(base64.b64decode(rest)), np.uint8).reshape(4, -1)
        whole = np.ascontiguousarray(planes.T).view("<i4").reshape(int(side), int(side))
    except (ValueError, zlib.error) as error:
        raise ValueError(f"cell {str(text)[:20]!r}: must hold a packed picture: {error}") from None
    return float(step) * np.cumsum(whole, axis=1)
