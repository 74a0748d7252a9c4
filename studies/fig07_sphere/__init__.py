"""A sphere heated from its surface: the temperature of its centre in time, against the exact series.

Haddad et al. (Int. J. Thermal Sciences 164, 2021, 106799), figure 7 and eq. 19, corrected: diameter 0.1 m, 20 C, its
surface at 200 C from time 0 on; 900 J/(kg K), 185 W/(m K), 2700 kg/m3. The paper's contact network with 1e5 elements
was 1.93 K off at 10 s. Facets of the radical tessellation ("laguerre") include the cells' walls at the surface, placed
so that the volume is exact. The laws of contacts hold the centres of the particles that touch the surface at its
temperature, as in the paper; C_t of "calibrated" is that of a cube of the same volume, packed with the same radii
between walls. Temperatures are read at the centre itself: in the particle there, with its own gradient. Finite elements
are straight linear (P1) and curved quadratic (P2) tetrahedra; one of their meshes is also marched with a tenth of the
temporal error. Costs leave out the packings, which come from the cache, and include the mesh.

The paper's network is here twice: "calibrated" is what `evolve` takes for it; the table of variants has both packings
with 1e5, temperatures held at centres or acting at the surface, and both calibrations
(`studies/common/paper_network.py`). There is no sphere without walls.
"""

from importlib import import_module

import numpy as np

from demheat import referee
from demheat.runtime.lazy import lazy_names
from studies.common import sphere_in_time
from studies.common.paper_network import NAME, PACKINGS, SEEDS, WALLED
from studies.common.paper_network import cases as network_cases
from studies.common.paper_variants import Variant, parted
from studies.common.sphere_in_time import CENTER_TIMES as TIMES
from studies.common.sphere_in_time import NUMBERS, PAPERS, SIZES
from studies.fig07_sphere.means import PAPER, TIGHTER, network_errors, plain
from studies.harness.cells import cell
from studies.harness.pick import pick

__getattr__, __dir__ = lazy_names(
    __name__, {"studies.fig07_sphere.tables": ("notes",), "studies.fig07_sphere.figure": ("plot",)}
)

# What rows of the paper's network run; its `NAME` is spelt out, so that others do not change with its module.
MODULES = {"network": "studies.fig07_sphere.rows"}
# Of the paper's network; the first is a quick run's.
FEW, NETWORK = 3_000, PAPERS
AS_PRINTED = Variant("lsa", "center", "flux")


def _cases():
    # A million are marched in figure 8; of the laws of contacts what the table needs.
    yield from (case for case in sphere_in_time.cases() if case.get("particles", 0) <= NETWORK)
    for size, accuracy in TIGHTER.items():
        yield {"order": 2, "size": size, "accuracy": accuracy, "method": "fem"}
    yield from network_cases([FEW], held=WALLED, packings=["relaxed"], seeds=[0])
    for packing in PACKINGS:
        for held in WALLED:
            # More than one of the paper's own kind, whose error is held beside the printed one.
            seeds = SEEDS if (packing, held) == AS_PRINTED[:2] else SEEDS[:1]
            yield from network_cases([NETWORK], held=[held], packings=[packing], seeds=seeds)


CASES = list(_cases())


def QUICK(case):
    """As of both figures of the sphere; of the paper's network and of the tighter marches the smallest."""
    if case.get("name") == NAME:
        return case["particles"] == FEW
    return sphere_in_time.quick(case)


def VALUES(case):
    """The paper's network, of which only errors are shown, and packings but the first."""
    return case.get("name") == NAME or case.get("seed", 0) > 0


# Limits that are far from the values, and why they are no nearer.
REASONS = {
    "heat lost over heat moved": "rounding; of elements the tolerance of each step's equations",
    "over its 1.93 K": "within a factor of 1.8 either way is asked, as packings scatter: no reproduction",
    "over Laguerre": "the limit of both laws of contacts",
}
TIMEOUT = 3600.0


def run(method, name=None, **knobs):
    """Errors of the centre in time."""
    if method in MODULES:
        return import_module(MODULES[method]).network_row(**knobs, times=TIMES)
    row = sphere_in_time.marched(TIMES, _look, method=method, **knobs)
    errors = np.array([row.pop(f"error_{t:g}") for t in TIMES])
    at, largest = referee.worst(errors)
    return row | {
        "error_10s": errors[TIMES.index(10.0)],
        "worst": abs(largest),
        "worst_at_s": TIMES[at],
        "errors": cell(errors),
    }


def _look(field, exact):
    off = referee.temperature_error(field, exact, sphere_in_time.CENTER, unit="K")
    return {f"error_{field.time:g}": float(off.values[0])}


def warm_up(method, name=None, **knobs):
    """Make and keep the packing, load and compile."""
    return sphere_in_time.prepare((1.0,), _look, method=method, **knobs)


def claims(df):
    """The centre by Laguerre, by the laws of contacts and by finite elements; orders; heat; the printed 1.93 K.

    Limits of errors are some three times what was found with one to three packings. The paper's network as the paper
    has it, LSA, temperatures at centres and C_t under a flux, must be off by half to twice the printed error: ours and
    theirs are other packings, with other links. The order expected is two.
    """
    network, others = parted(df)
    others = plain(others)
    yield from [*_accuracy(others), *_network(network), *_rest(others)]


def _accuracy(df):
    at_10s = df["error_10s"].abs()
    for number, limit in ((100_000, 0.06),):
        rows = pick(df, law="laguerre", particles=number).index
        value = at_10s[rows].max(skipna=False) if len(rows) else None
        yield f"Laguerre, {number:.0e} particles: error of the centre at 10 s, K (paper 1.93 with 1e5)", value, limit
    # A quick run has 1000 and 3000 particles only: the paper's error with 1e5 elements is their limit.
    small = pick(df, law="laguerre", particles=NUMBERS[0]).index
    text = f"Laguerre, {NUMBERS[0]} particles: error of the centre at 10 s, K, below the paper's with 1e5 elements"
    yield text, at_10s[small].max(skipna=False), f"< {PAPER['centre_10s']}"
    for law in sphere_in_time.CONTACTS:
        ours, theirs = (at_10s[pick(df, law=name, particles=NUMBERS[1]).index].mean() for name in ("laguerre", law))
        text = f"{NUMBERS[1]} particles: error of the centre at 10 s, {law} over Laguerre"
        yield text, theirs / ours, ">= 4"
    # Found 0.13 to 0.15 K at the coarsest edge: a third order scheme that curves with the surface.
    curved = pick(df, order=2, size=SIZES[2][0]).index
    yield "FEM, P2, edges of 12 mm: error of the centre at 10 s, K", at_10s[curved].max(skipna=False), 0.3


def _network(network):
    made = network_errors(pick(network, particles=NETWORK))
    papers = next((found for (variant, _), found in made.items() if variant == AS_PRINTED), None)
    if papers is None:
        return
    value = abs(papers["error_10s"].mean) / PAPER["centre_10s"]
    for limit in ("<= 1.8", ">= 0.55"):
        text = "The paper's network as the paper has it, 1e5 particles: error of the centre at 10 s over its 1.93 K"
        yield text, value, limit


def _rest(df):
    dem = pick(df, law="laguerre")
    # A thousand are five diameters to the centre: no law of powers yet.
    fine = dem[dem["particles"] >= NUMBERS[1]]
    order = sphere_in_time.order_of(fine, "worst") if fine["particles"].nunique() > 1 else None
    yield "Laguerre, from 3000 on: order in the particle spacing of the largest error of the centre", order, ">= 1.5"
    yield from sphere_in_time.balance(df)
    yield (
        "Laguerre: spectral radius over the mean row (slivers: hundreds)",
        dem["spectral_ratio"].max(skipna=False),
        20.0,
    )


def table(df):
    """Errors of the centre in K, means over packings: size at 10 s, largest over 0.5 to 30 s, and when it is found."""
    df = plain(parted(df)[1])
    df["at_10s"], df["packings"] = df["error_10s"].abs(), df["seed"].notna().astype(int)
    kept = {"at_10s": "mean", "worst": "mean", "worst_at_s": "mean", "packings": "sum"}
    kept |= {name: "mean" for name in ("unknowns", "elements", "steps", "iterations", "cpu_s", "peak_mib")}
    found = df.groupby(["name", "particles", "size"], sort=False, dropna=False)
    return found.agg(kept).reset_index()
