"""NumPy archives (.npz): every bit, with provenance and domain."""

import json

import numpy as np

from demheat.io.packings import npz
from demheat.io.packings.found import Found
from demheat.packing.base import Packing, check_box
from demheat.scene.inputs import one_line

# Letters of what a library says: it may show all that it has found.
LONGEST = 300
NAMES = ("centers", "radii", "size", "periodic", "provenance", "domain")


def write(packing: Packing, stream) -> None:
    """Write a packing; its provenance as JSON."""
    try:
        provenance = json.dumps(packing.provenance, default=_plain)
    except TypeError as error:
        raise ValueError(f"packing.provenance: {error}") from None
    npz.save(stream, packing._asdict() | {"provenance": provenance})


def read(path) -> Found:
    """Read an archive without unpickling anything."""
    try:
        arrays = npz.load(path, NAMES)
        centers, radii = arrays["centers"], arrays["radii"]
        if centers.ndim != 2 or centers.shape[1] != 3 or radii.shape != (len(centers),) or len(radii) == 0:
            raise ValueError(f"found centers {centers.shape} and radii {radii.shape}; expected (n, 3) and (n,), n > 0")
        size, periodic = check_box(arrays["size"], arrays["periodic"])
        if centers.dtype.kind not in "fiu" or radii.dtype.kind not in "fiu":
            raise ValueError(f"found centers of {centers.dtype} and radii of {radii.dtype}; expected numbers")
        provenance = npz.parsed(str(arrays["provenance"]))
        spheres = np.column_stack((centers, radii)).astype(float)
    except FileNotFoundError:
        raise
    except (OSError, TypeError, ValueError) as error:
        raise ValueError(f"{path}: not a whole packing archive: {one_line(error)[:LONGEST]}") from None
    return Found(spheres, size, periodic, domain=str(arrays["domain"]), provenance=provenance)


def _plain(value):
    """What JSON can hold of a NumPy value."""
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise TypeError(f"holds {value!r}: must be what JSON can hold")
