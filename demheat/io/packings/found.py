"""From what a file holds to a packing: one gate for all formats."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from demheat.io.packings.text import broken
from demheat.packing.base import Packing, make_packing, wrap


class Found(NamedTuple):
    """What a reader found in a file."""

    spheres: np.ndarray  # (n, 4) float array, m: Centre, in the coordinates of the file, and radius
    size: np.ndarray | None = None  # (3,) float array, m, or None: None if the file has no box
    periodic: np.ndarray | None = None  # (3,) bool array or None: None if the file does not say
    origin: np.ndarray | tuple = (0.0, 0.0, 0.0)  # (3,) float array, m: Corner of the box
    domain: str | None = None
    ids: np.ndarray | None = None  # (n,) float array or None
    numbers: Sequence[int] | None = None  # Line number of each sphere; None in files that have no lines
    provenance: dict | None = None  # What of it is known; `read` adds the file and the format


def to_packing(found: Found, path, *, size, periodic, domain, order) -> Packing:
    """Check what was found and make the packing of it."""
    _check_spheres(found, path)
    origin, sides, flags, source = _box(found, path, size, periodic)
    centers = _centers(found, path, origin, sides, flags)
    radii = found.spheres[:, 3]
    if found.ids is not None:
        rank = rank_of(found, path)
        centers, radii = centers[rank], radii[rank]
    provenance = {**(found.provenance or {}), **source}
    shape = domain or found.domain or "box"
    try:
        packing = make_packing(centers, radii, sides, flags, provenance, domain=shape)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    if order == "morton":
        return packing
    return packing._replace(centers=wrap(centers, packing.size, packing.periodic), radii=np.array(radii))


def _refuse(found, path, k, what, expected):
    """Raise the error of sphere k, by its line where there is one."""
    if found.numbers is not None:
        raise broken(path, found.numbers[k], what, expected)
    raise ValueError(f"{path}, sphere {k + 1}: found {what}; expected {expected}")


def _check_spheres(found, path):
    bad = ~np.all(np.isfinite(found.spheres), axis=1)
    if bad.any():
        k = int(np.argmax(bad))
        _refuse(found, path, k, f"x y z radius = {found.spheres[k].tolist()}", "finite numbers")
    bad = found.spheres[:, 3] <= 0
    if bad.any():
        k = int(np.argmax(bad))
        _refuse(found, path, k, f"radius {float(found.spheres[k, 3])!r}", "a radius > 0")


def _box(found, path, size, periodic):
    """Corner, sides and periodicity of the box, and a dict that says where the box comes from."""
    if found.size is not None:
        if size is not None:
            raise ValueError(f"size = {size!r}: {path} has its own box, {found.size.tolist()}; leave size out")
        if periodic is None and found.periodic is None:
            raise ValueError(f"periodic: {path} does not say which axes are periodic; give a bool or three bools")
        return found.origin, found.size, found.periodic if periodic is None else periodic, {}
    if size is not None:
        return found.origin, np.array(size, dtype=float), False if periodic is None else periodic, {"box": "given"}
    if periodic is not None and np.any(periodic):
        raise ValueError(f"size: {path} has no box, and a periodic one cannot be guessed; give three lengths")
    low = np.min(found.spheres[:, :3] - found.spheres[:, 3:], axis=0)
    high = np.max(found.spheres[:, :3] + found.spheres[:, 3:], axis=0)
    return low, high - low, False, {"box": "bounding box of the spheres"}


def _centers(found, path, origin, sides, flags):
    """Centres from the corner of the box; those outside a wall are refused."""
    origin = np.asarray(origin, dtype=float)
    centers = found.spheres[:, :3] - origin
    walls = ~np.broadcast_to(flags, 3)
    outside = np.any(walls & ((centers < 0) | (centers > sides)), axis=1)
    if outside.any():
        k = int(np.argmax(outside))
        box = f"a centre between the walls, {origin.tolist()} to {(origin + sides).tolist()}"
        _refuse(found, path, k, f"x y z = {found.spheres[k, :3].tolist()}", box)
    return centers


def rank_of(found, path):
    """Order of the spheres by their ids, which must be different integers."""
    bad = found.ids != np.round(found.ids)
    if bad.any() or not np.all(np.isfinite(found.ids)):
        k = int(np.argmax(bad))
        _refuse(found, path, k, f"id {float(found.ids[k])!r}", "an integer")
    rank = np.argsort(found.ids, kind="stable")
    again = np.flatnonzero(np.diff(found.ids[rank]) == 0)
    if len(again):
        k = int(rank[again[0] + 1])
        _refuse(found, path, k, f"id {int(found.ids[k])} once more", "each id once")
    return rank
