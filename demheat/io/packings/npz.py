"""NumPy archives (.npz) read with care: no more than the file can hold, nothing unpickled, changes seen."""

import hashlib
import json
import zipfile

import numpy as np
from numpy.lib import format as npy

from demheat.io.packings.source import length_of, most_unpacked
from demheat.runtime.limits import check_free

CHECKSUM = "checksum"
# Kinds of NumPy's types: numbers (no complex ones, no dates), flags, text.
KINDS = "fiubU"
# Bytes before the numbers of an array, and levels of lists and objects in text as JSON.
HEADER, DEPTH = 20_000, 100


def save(stream, arrays: dict) -> None:
    """Write arrays with a checksum over all of them."""
    arrays = {name: np.asanyarray(array) for name, array in arrays.items()}
    np.savez(stream, **arrays, **{CHECKSUM: _checksum(arrays)})


def load(path, names) -> dict:
    """Read arrays; the checksum is held against them if there is one."""
    left = most_unpacked(length_of(path))
    try:
        with zipfile.ZipFile(path) as archive:
            stored = {each.filename.removesuffix(".npy"): each for each in archive.infolist()}
            lacking = [name for name in names if name not in stored]
            if lacking:
                raise ValueError(f"found the arrays {', '.join(list(stored)[:20])}; expected {', '.join(names)}")
            arrays = {}
            # The checksum is over all.
            for name in stored if CHECKSUM in stored else names:
                length = stored[name].file_size
                left -= length
                if left < 0:
                    raise ValueError(f"{name} takes {length} bytes, more than any packing in a file of this length")
                check_free(path, length)
                with archive.open(stored[name]) as member:
                    arrays[name] = _array(name, member, length)
    except OSError:
        raise
    # A changed header is parsed as Python: what it raises is not known.
    except Exception as error:  # noqa: BLE001
        raise ValueError(str(error) or type(error).__name__) from None
    said = arrays.pop(CHECKSUM, None)
    if said is not None and str(said) != _checksum(arrays):
        raise ValueError("the checksum does not fit: the file was changed after it was written")
    return arrays


def _array(name, member, length):
    """One array, of no more bytes than its length says."""
    version = npy.read_magic(member)
    read = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
    shape, in_columns, dtype = read(member, max_header_size=HEADER)
    count = 1
    for side in shape:
        count *= side
    if dtype.kind not in KINDS or min(shape, default=1) < 0 or member.tell() + count * dtype.itemsize != length:
        what = "real numbers or text, all there, nothing pickled"
        found = f"{shape} of {dtype}"[:100]
        raise ValueError(f"{name}: found {found} in {length} bytes; expected {what}")
    # One byte more than there is: at the end of a member its own checksum is looked at.
    content = member.read(length + 1)
    array = np.frombuffer(content, dtype=dtype, count=count).copy()
    return array.reshape(shape, order="F" if in_columns else "C")


def _checksum(arrays):
    digest = hashlib.sha256()
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        digest.update(repr((name, array.shape, array.dtype.str)).encode() + array.tobytes())
    return digest.hexdigest()


def parsed(text: str) -> dict:
    """A provenance out of JSON."""
    try:
        found = json.loads(text)
        level, depth = [found], 0
        while level and depth <= DEPTH:
            lists = [each for each in level if isinstance(each, list)]
            lists += [each.values() for each in level if isinstance(each, dict)]
            level, depth = [value for values in lists for value in values], depth + 1
    except RecursionError:
        depth = DEPTH + 1
    if depth > DEPTH:
        raise ValueError(f"found a provenance of more than {DEPTH} levels; expected fewer")
    if not isinstance(found, dict):
        raise ValueError(f"found a provenance of {type(found).__name__}; expected an object")
    return found
