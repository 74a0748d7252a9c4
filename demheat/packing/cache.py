"""Packings kept on disk, so that each is made once."""

from __future__ import annotations

import hashlib
import importlib.util
import json
import os
import tempfile
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from demheat.packing.base import Packing, check_box
from demheat.packing.domain import replicate, walled
from demheat.packing.io import npz
from demheat.packing.lsa import lsa
from demheat.packing.radii import Gaussian, distribution
from demheat.packing.relax import relax
from demheat.powers import cube_root

# Layout of the files. Raise it when the arrays stored or their meaning change.
FORMAT = 3
ARRAYS = ("centers", "radii", "size", "periodic", "provenance", "domain")
RELAX = (
    "demheat.scene.bodies",
    "demheat.powers",
    *(f"demheat.packing.{part}" for part in ("base", "radii", "cells_kernels", "neighbours", "relax_kernels", "relax")),
)
LSA = (*RELAX, "demheat.packing.lsa_kernels", "demheat.packing.motion", "demheat.packing.lsa")
# Of what is asked for, what no packing that is made depends on.
IDLE = ("progress", "allow_few")


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
    """Return the packing stored under `key`, or make and store it.

    Parameters
    ----------
    make : callable () -> Packing
        Its provenance must survive JSON.
    key : dict
        Everything the packing depends on, code included (see `code_hash`); only what JSON can hold.
    folder : path, optional
        Default `cache_folder()`. If it cannot be written, a warning says so and the packing is returned all the same.

    Returns
    -------
    Packing
        provenance["cached"] says whether it came from the folder.
    """
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


def relaxed(
    number: int,
    *,
    size: Sequence[float] = (1.0, 1.0, 1.0),
    phi: float = 0.64,
    radii=None,
    periodic: bool | Sequence[bool] = True,
    seed: int = 0,
    folder: str | os.PathLike | None = None,
    **knobs,
) -> Packing:
    """`relax` with a memory: boxes of one shape share one packing, scaled.

    Parameters
    ----------
    number, size, phi, radii, periodic, seed, knobs
        As in `demheat.packing.relax.relax`.
    folder : path, optional
        Default `cache_folder()`.
    """
    request = {"number": number, "phi": phi, "seed": seed} | knobs
    return _of_shape(relax, RELAX, request, size, radii, periodic, folder)


def grown(
    number: int,
    *,
    size: Sequence[float] = (1.0, 1.0, 1.0),
    radii=None,
    periodic: bool | Sequence[bool] = True,
    seed: int = 0,
    folder: str | os.PathLike | None = None,
    **knobs,
) -> Packing:
    """`lsa` with a memory: boxes of one shape share one packing, scaled.

    Parameters
    ----------
    number, size, radii, periodic, seed, knobs
        As in `demheat.packing.lsa.lsa`, without `start`.
    folder : path, optional
        Default `cache_folder()`.
    """
    if "start" in knobs:
        raise ValueError("start: must not be given here; `lsa` takes it, and `cached` keeps what it makes")
    request = {"number": number, "seed": seed} | knobs
    return _of_shape(lsa, LSA, request, size, radii, periodic, folder)


def replicated(
    number: int,
    counts: Sequence[int],
    *,
    size: Sequence[float] = (1.0, 1.0, 1.0),
    periodic: bool = True,
    seed: int = 0,
    folder: str | os.PathLike | None = None,
    keep: Callable | None = None,
) -> Packing:
    """Replicas of one relaxed packing, which is made once; between walls for tessellations only.

    Parameters
    ----------
    number : int
        Rounded so that every replica has as many.
    counts : (3,) sequence of int
        Replicas along each axis, see `demheat.packing.domain.replica_counts`.
    size, seed, folder
        As in `relaxed`.
    periodic : bool
        If not, the replicas' outer particles are drawn off the walls, see `demheat.packing.domain.walled`.
    keep : callable (n, 3) float array, m -> (n,) bool array, optional
        Which centres are kept, before those at walls are drawn in: a part of the packing, without memory for the rest.
    """
    sides, counts = np.array(size, dtype=float), np.array(counts)
    one = replica(number, counts, size=sides, seed=seed, folder=folder)
    packing = replicate(one, counts, keep=keep)
    # The size is met exactly: its replicas' may differ by rounding.
    centers = np.minimum(packing.centers, np.nextafter(sides, 0.0), out=packing.centers)
    packing = packing._replace(centers=centers, size=sides)
    return packing if periodic else walled(packing, None if keep is None else one.radii.mean())


def replica(number, counts, *, size, seed=0, folder=None) -> Packing:
    """The packing that `replicated` repeats.

    Parameters
    ----------
    number, counts, size, seed, folder
        As in `replicated`.
    """
    counts = np.array(counts)
    sides = np.array(size, dtype=float) / counts
    return relaxed(round(number / int(counts.prod())), size=sides, seed=seed, folder=folder)


def _of_shape(maker, modules, request, size, radii, periodic, folder):
    """Packing of a box of this shape by `maker`, from the folder or made now, stretched to the size asked for."""
    sides, periodic = check_box(size, periodic)
    # 12 digits: sides such as 0.1 and 0.3 are rounded already, and so are their ratios.
    shape = np.round(sides / sides.max(), 12)
    radii = Gaussian() if radii is None else distribution(radii)
    key = {"algorithm": maker.__name__, "code": code_hash(*modules), "shape": shape.tolist()}
    key |= {"radii": repr(radii), "periodic": periodic.tolist()}
    key |= {name: value for name, value in request.items() if name not in IDLE}

    def make():
        return maker(size=shape, radii=radii, periodic=periodic, **request)

    unit = cached(make, key, folder=folder)
    # Stretched by the 1e-12 that rounding the shape took, so that the box is met exactly; volumes keep phi.
    stretch = sides / shape
    return unit._replace(
        centers=np.minimum(unit.centers * stretch, sides), radii=unit.radii * cube_root(np.prod(stretch)), size=sides
    )


def _plain(value):
    """Plain number of a NumPy one, for JSON."""
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"key holds {value!r}: must be what JSON can hold")


def _load(path, text):
    """Load the packing at `path` if it is whole and its key is `text`, else None."""
    try:
        stored = npz.load(path, (*ARRAYS, npz.CHECKSUM, "key"))
        if str(stored["key"]) != text:
            return None
        stored["provenance"], stored["domain"] = npz.parsed(str(stored["provenance"])), str(stored["domain"])
        return Packing(*(stored[name] for name in ARRAYS))
    except (FileNotFoundError, NotADirectoryError):
        return None
    except (OSError, ValueError) as error:
        warnings.warn(f"cached packing {path} cannot be read and is made again: {error}", stacklevel=3)
        return None


def _store(path, text, packing):
    """Write under a temporary name, then rename: a reader sees a whole file or none."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, suffix=".tmp")
    try:
        with os.fdopen(handle, "wb") as file:
            arrays = packing._asdict() | {"provenance": json.dumps(packing.provenance), "key": text}
            npz.save(file, arrays)
        os.replace(name, path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
