"""What costs scatter by, and kernels beside their peers.

The DEM is run twice on the same body, which shows what a packing costs and, where none is made, what costs scatter by.
The cost of a Laguerre tessellation is set beside Voro++'s, that of the steady solver beside plain pyamg's on the same
matrix, and that of the scalar FFT scheme beside Eyre-Milton's, each pair on the same data. Who wins is found by study
`frontier`.
"""

from demheat.runtime.lazy import lazy_names
from studies.speed_error.cases import TIMEOUT, all_cases

__getattr__, __dir__ = lazy_names(
    __name__,
    {
        "studies.speed_error.verdicts": ("claims",),
        "studies.speed_error.tables": ("table",),
        "studies.speed_error.means": ("packing",),
    },
)

CASES = list(all_cases())
# Limits that are far from the values, and why they are no nearer.
REASONS = {
    "over that of the best plain pyamg": "to be no slower than the library is what is asked",
}
__all__ = ["CASES", "PAPER", "QUICK", "TIMEOUT", "claims", "packing", "run", "table", "warm_up"]


def QUICK(case):
    """Coarse rows."""
    if case.get("seed", 0) > 0 or case.get("particles", 0) > 20_000:
        return False
    return case.get("voxels", 0) <= 64


def run(name, particles=None, seed=None, scene=None, *, method, **solver):
    """Solve one case, the DEM from an empty packing cache and then again; or time our kernels beside their peers."""
    from studies.speed_error import rows

    if scene is None:
        return _beside_peers(name, particles, seed)
    knobs = {} if particles is None else {"particles": particles, "seed": seed}
    return rows.solved(scene, method=method, **knobs, **solver)


def _beside_peers(name, particles, seed):
    from demheat.gallery import sphere_in_cube
    from studies.common import peers

    if name == "tessellation":
        return peers.tessellation(particles, seed)
    return peers.steady(particles, seed, sphere_in_cube(10.0))


def warm_up(name, particles=None, seed=None, scene=None, *, method, **solver):
    """Load the solver; the peers load their own."""
    from studies.harness import methods

    if scene is not None:
        knobs = {} if particles is None else {"particles": particles, "seed": seed}
        methods.warm_up(method, **knobs, **solver)
