"""What all formats of images have in common: a file that is there, bytes as an array, errors as one line."""

import math
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from demheat.io.words import nearest_file
from demheat.runtime.limits import ALWAYS
from demheat.scene.inputs import one_line

# Lengths as formats have them, in metres.
UNITS = {
    "m": 1.0,
    "cm": 1e-2,
    "mm": 1e-3,
    "um": 1e-6,
    "\N{MICRO SIGN}m": 1e-6,
    "micron": 1e-6,
    "microns": 1e-6,
    "nm": 1e-9,
}
# What an array takes while it is read, over what it needs itself.
FACTOR = 4


def check_there(path: Path, *, folder: bool = False) -> None:
    """Raise ValueError unless there is a regular file, or a folder."""
    if path.is_dir() if folder else path.is_file():
        return
    if not path.exists():
        raise ValueError(f"{path}: there is no such file{nearest_file(path)}")
    kind = "a folder, as zarr writes one" if folder else "a regular file, no folder, device or pipe"
    raise ValueError(f"{path}: must be {kind}")


@contextmanager
def told_in_one_line(path: Path, kind: str):
    """What libraries and their decoders happen to raise, as one ValueError of the file."""
    try:
        yield
    except OSError:
        raise
    except Exception as error:  # noqa: BLE001
        if isinstance(error, ValueError) and str(error).startswith(str(path)):
            raise
        told = one_line(error) or type(error).__name__
        raise ValueError(f"{path}: no {kind}, or a part of one: {told}") from None


def most_of(needed: int) -> int:
    """Bytes that one piece of an array may take that needs so many bytes itself."""
    return max(ALWAYS, FACTOR * needed)


def mapped(path: Path, shape, *, dtype, offset: int) -> np.ndarray:
    """Raw bytes, x fastest, as an array; they must all be there."""
    needed, there = offset + math.prod(shape) * np.dtype(dtype).itemsize, path.stat().st_size
    if needed > there or offset < 0:
        sides = " x ".join(map(str, shape))
        raise ValueError(
            f"{path}: has {there} bytes; {sides} voxels of {np.dtype(dtype)} take {needed} with what is before them"
        )
    return np.memmap(path, dtype=dtype, mode="r", offset=offset, shape=tuple(shape), order="F")
