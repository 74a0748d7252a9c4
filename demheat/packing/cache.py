"""Packings of boxes of one shape, each made once and kept on disk."""

import os
from collections.abc import Callable, Sequence

import numpy as np

from demheat.packing.base import Packing, check_box
from demheat.packing.domain import replicate, walled
from demheat.packing.kept import LSA, RELAX, cached, code_hash
from demheat.packing.lsa import lsa
from demheat.packing.radii import Gaussian, distribution
from demheat.packing.relax import relax
from demheat.powers import cube_root

# Of what is asked for, what no packing that is made depends on.
IDLE = ("progress", "allow_few")


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
    """`relax` with a memory: boxes of one shape share one packing, scaled."""
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
    """`lsa` with a memory: boxes of one shape share one packing, scaled."""
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
    """Replicas of one relaxed packing, which is made once; between walls for tessellations only."""
    sides, counts = np.array(size, dtype=float), np.array(counts)
    one = replica(number, counts, size=sides, seed=seed, folder=folder)
    packing = replicate(one, counts, keep=keep)
    # The size is met exactly: its replicas' may differ by rounding.
    centers = np.minimum(packing.centers, np.nextafter(sides, 0.0), out=packing.centers)
    packing = packing._replace(centers=centers, size=sides)
    return packing if periodic else walled(packing, None if keep is None else one.radii.mean())


def replica(number, counts, *, size, seed=0, folder=None) -> Packing:
    """The packing that `replicated` repeats."""
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
