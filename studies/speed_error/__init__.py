"""Error against CPU time and memory in time; kernels beside their peers; what costs scatter by.

Bodies that warm up: a slab, a ball and a beam, whose temperatures at points are held against series. Particles of the
DEM's conforming cells in boxes are cut from tiles that come with the package; other bodies and cells are packed, on the
spot. The DEM is run twice, also on steady scenes, which shows what a packing costs and, where none is made, what costs
scatter by. The cost of a Laguerre tessellation is set beside Voro++'s, that of the steady solver beside plain pyamg's
on the same matrix, and that of the scalar FFT scheme beside Eyre-Milton's, each pair on the same data. Who wins on
steady scenes is found by study `frontier`.
"""

from studies.harness.methods import EDGE
from studies.speed_error.cases import TIMEOUT, all_cases

CASES = list(all_cases())
PAPER = {}
# Limits that are far from the values, and why they are no nearer.
REASONS = {
    "over that of the best plain pyamg": "to be no slower than the library is what is asked",
}
# Why claims on the stored rows fail.
FAILS = {
    "DEM in time, 30000 particles, ball": (
        "one limit was set for all bodies; this one needs more particles: 100000, which are no row, give 0.075 %"
    ),
}

__all__ = ["CASES", "PAPER", "QUICK", "TIMEOUT", "claims", "in_time", "notes", "packing", "plot", "run", "table",
           "warm_up"]  # fmt: skip


def QUICK(case):
    """Coarse rows."""
    if case.get("seed", 0) > 0 or case.get("particles", 0) > 20_000:
        return False
    return case.get("size", EDGE) > 0.06 * EDGE and case.get("voxels", 0) <= 64


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
    from studies.speed_error import rows

    if scene is not None:
        knobs = {} if particles is None else {"particles": particles, "seed": seed}
        rows.warm_up(scene, method=method, **knobs, **solver)


def claims(df):
    """Kernels beside their peers on the same data; errors in time; how costs scatter.

    A kernel must not be slower than its peer. Costs of a quick run are too small to judge. When values were known the
    tessellation came down from 40, 20 and 15 microseconds and once Voro++, schemes from 1e-6, the beam from .1 %; what
    is a tie was set by how costs scatter.
    """
    from studies.speed_error.verdicts import all_claims

    return all_claims(df)


def table(df):
    """The cheapest way to an accuracy in time, with all costs counted and with the DEM's beside it.

    What steady scenes cost at an accuracy is searched for in study `frontier`. Of each method that resolution counts
    from which on every finer one stays within the target. "At the target" are CPU seconds that the target itself would
    cost, by a power law between that resolution and the next coarser one, which misses it; all factors are of these.
    Errors are root mean squares at 400 random points at the worst time, in % of the span. Seconds of the DEM count its
    packing, where one is made. "next" is the cheapest method that costs over 1.5 times as much: costs nearer to each
    other than that are a tie.
    """
    from studies.speed_error.tables import lines

    return lines(df)


def in_time(df):
    """The cheapest method by scene and accuracy, and how many times as much the next or the DEM costs."""
    from studies.speed_error import tables

    return tables.by_accuracy(df)


def notes(df):
    """Where the DEM wins and loses in time, in words made of the rows."""
    from studies.speed_error import means

    return [means.in_words(df, target) for target in means.TARGETS]


def packing(df):
    """What a packing costs that is made on the spot."""
    from studies.speed_error import means

    return means.packing_in_words(df)


def plot(df):
    """Error against CPU time, a panel for each scene in time."""
    from studies.speed_error.figure import draw

    return draw(df)
