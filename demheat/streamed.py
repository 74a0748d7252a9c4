"""A solve in slabs on disk, as it was called: `demheat.mpi` is the way past one machine's memory now."""

import warnings

from demheat import dem
from demheat.field import Field
from demheat.laws import Laguerre
from demheat.scene import Scene


def solve(
    scene: Scene,
    *,
    folder=None,
    law: Laguerre | None = None,
    particles: int = 1_000_000,
    slabs: int | None = None,
    seed: int = 0,
    tolerance: float = 1e-8,
    replicas: int | None = None,
    seconds: float | None = None,
) -> Field:
    """`demheat.solve` in memory, with a warning; folder and slabs are not looked at."""
    warnings.warn(
        "demheat.streamed solves in memory now and will be gone: use demheat.solve, or demheat.mpi for bodies that are "
        "larger than that",
        DeprecationWarning,
        stacklevel=2,
    )
    how = {"particles": particles, "seed": seed, "tolerance": tolerance, "replicas": replicas, "seconds": seconds}
    return dem.solve(scene, law=Laguerre() if law is None else law, **how)
