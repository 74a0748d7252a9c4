"""What takes long to make, kept on disk: packings by all that they depend on."""

import hashlib
import importlib.util
import json
import os
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np

from demheat.packing.base import Packing
from demheat.runtime.paths import replaced

# Layout of the files. Raise it when the arrays stored or their meaning change.
FORMAT = 4
ARRAYS = ("centers", "radii", "size", "periodic", "provenance", "domain")
RELAX = (
    "demheat.scene.bodies",
    "demheat.powers",
    *(f"demheat.packing.{part}" for part in ("base", "radii", "cells_kernels", "neighbours", "relax_kernels", "relax")),
)
LSA = (*RELAX, "demheat.packing.lsa_kernels", "demheat.packing.motion", "demheat.packing.lsa")


def cache_folder() -> Path:
    """Folder of the packings: DEMHEAT_CACHE, else demheat/packings in XDG_CACHE_HOME, else in ~/.cache."""
    if os.environ.get("DEMHEAT_CACHE"):
        return Path(os.environ["DEMHEAT_CACHE"]).expanduser()
    return Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache").expanduser() / "demheat" / "packings"


def code_hash(*modules: str) -> str:
    """Digest of the source of modules, given by dotted name: as part of a key, it retires what older code has made."""
    digest = hashlib.sha256()
    for module in modules:
        digest.update(Path(importlib.util.find_spec(module).origin).read_bytes())
    return digest.hexdigest()


def cached(make: Callable[[], Packing], key: dict, *, folder=None) -> Packing:
    """Return the packing stored under `key`, or make and store it."""
    text = json.dumps({"format": FORMAT} | dict(key), sort_keys=True, default=_plain)
    try:
        folder = Path(folder or cache_folder())
    except RuntimeError as error:  # nobody knows of a home
        warnings.warn(f"packing not cached: {error} Set DEMHEAT_CACHE", stacklevel=2)
        packing = make()
        return packing._replace(provenance=packing.provenance | {"cached": False})
    path = folder / f"{hashlib.sha256(text.encode()).hexdigest()[:32]}.npz"
    packing = _load(path, text)
    if packing is not None:
        return packing._replace(provenance=packing.provenance | {"cached": True})
    packing = make()
    try:
        _store(path, text, packing)
    except OSError as error:
        warnings.warn(f"packing not cached in {path.parent}: {error}; set DEMHEAT_CACHE", stacklevel=2)
    return packing._replace(provenance=packing.provenance | {"cached": False})


def _plain(value):
    """Plain number of a NumPy one, for JSON."""
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"key holds {value!r}: must be what JSON can hold")


def _load(path, text):
    """Load the packing at `path` if it is whole and its key is `text`, else None."""
    try:
        with open(path, "rb") as file, np.load(file, allow_pickle=False) as archive:
            stored = {name: archive[name] for name in ("key", *ARRAYS)}
            if str(archive["checksum"]) != _checksum(stored):
                raise ValueError("the checksum does not fit: the file was changed after it was written")
        if str(stored["key"]) != text:
            return None
        stored["provenance"], stored["domain"] = json.loads(str(stored["provenance"])), str(stored["domain"])
        return Packing(*(stored[name] for name in ARRAYS))
    except (FileNotFoundError, NotADirectoryError):
        return None
    # A changed archive may ask for anything: what reading it raises is not known.
    except Exception as error:
        warnings.warn(f"cached packing {path} cannot be read and is made again: {error}", stacklevel=3)
        return None


def _store(path, text, packing):
    """Write under a temporary name, then rename: a reader sees a whole file or none."""
    path.parent.mkdir(parents=True, exist_ok=True)
    arrays = packing._asdict() | {"provenance": json.dumps(packing.provenance), "key": text}
    with replaced(path) as temporary, temporary.open("wb") as file:
        np.savez(file, **arrays, checksum=_checksum(arrays))


def _checksum(arrays):
    """Digest of arrays, their types and shapes."""
    digest = hashlib.sha256()
    for name in sorted(arrays):
        array = np.asanyarray(arrays[name])
        digest.update(f"{name} {array.dtype.str} {array.shape}".encode() + array.tobytes())
    return digest.hexdigest()
