"""Silica in epoxy, 83 spheres: error against cost, up to 8e6 elements, 512^3 voxels and 2.3e6 tetrahedra.

Section 5 of Haddad et al. (Int. J. Thermal Sciences 164, 2021, 106799) at its full size, on two processors: one
periodic cell of fig17_etc, a fifth of it spheres, under a mean gradient. Errors are those of the conductivity against
Rayleigh's multipole method at its highest degree here. The DEM's costs are those from the scene to the conductivity,
its packing made on the spot, beyond two million particles as replicas of a smaller one. The steady solver stands
beside plain pyamg on the matrix of such spheres between walls.

"DEM as in the paper" stands on replicas of small relaxed packings that are made on the spot. What its packings and
walls change is in `fig17_etc`, on this cell, too; the paper's number of particles, 8e6, is in `fig18_fields`.
"""

import math
import tempfile
from importlib import import_module

from demheat import referee
from studies.common import silica_epoxy
from studies.harness import methods
from studies.harness.converged import converged
from studies.harness.pick import largest, pick
from studies.harness.printed import printed
from studies.many_inclusions.scenes import FRACTION, inside, spheres

# What rows of solvers side by side run: others do not change with its module.
STEADY = "steady"
MODULES = {STEADY: "studies.common.peers"}
PARTICLES = (10_000, 30_000, 100_000, 8_000_000)
NETWORKS = {1: 10_000, 2: 100_000}  # replicas along an edge, and particles, of the paper's law
VOXELS = (64, 128, 256, 512)
# Eyre and Milton's scheme is extrapolated in `fig17_etc`, and as near with as many voxels as the scalar one.
COARSER = VOXELS[:-1]
SIZES = {"fem": (1 / 24,), "fem-p1": (0.012,)}  # in edges of the cube
RESOLUTIONS = {"particles": PARTICLES, "voxels": VOXELS, "fft-em": COARSER, "size": SIZES["fem"]}
RESOLUTIONS |= {"fem-p1": SIZES["fem-p1"]}
DEGREES = (4, 8, 12, 14, 16)
SOLVED = 1_000_000  # particles of the matrix that pyamg solves too
# Limits that are far from the values, and why they are no nearer.
REASONS = {
    "Multipoles: last degree": "small beside the least error that is judged by them",
    "peak memory, GiB": "what a machine of 16 GiB can give",
    "within the paper's 0.5 %": "the paper's own number is the limit",
    "CPU time over that of pyamg's": "to be no slower than the library is what is asked",
}
PAPER = printed("many_inclusions")
TIMEOUT = 7200.0


def _cases():
    yield from (methods.case("multipole", highest=degree) for degree in DEGREES)
    for method in methods.compared("dem-calibrated", "fem-p1"):
        if method.name == "dem-calibrated":
            # Replicas of the same size: what is repeated does not matter for errors of some per cent.
            knobs = [methods.at(method, number) | {"replicas": replicas} for replicas, number in NETWORKS.items()]
        else:
            knobs = [methods.at(method, value) for value in methods.spent(method, RESOLUTIONS)]
        yield from (methods.case(method.name, **each) for each in knobs)
    yield {"name": STEADY, "particles": SOLVED, "seed": 0, "method": STEADY}


CASES = list(_cases())


def QUICK(case):
    """Coarse rows of the one cell, without elements, which spheres make fine and a quick run of `fig17_etc` has.

    Nor the steady solver beside pyamg, which a quick run of `speed_error` has.
    """
    if case["name"] == "multipole":
        return case["highest"] in DEGREES[:3]
    if case["name"] == STEADY:
        return False
    method = methods.all_methods()[case["name"]]
    coarsest = methods.at(method, methods.spent(method, RESOLUTIONS)[0])
    return coarsest.items() <= case.items() and case["method"] != "fem"


def run(name, highest=None, *, method, **knobs):
    """Solve the cell, or time solvers on its matrix."""
    if method == STEADY:
        walled = silica_epoxy.scene("walled", FRACTION, seed=0, boundary="walls")
        return import_module(MODULES[STEADY]).steady(**knobs, scene=walled)
    if highest is not None:
        knobs["order"] = highest
    # Nothing is kept: packings are part of the cost.
    with tempfile.TemporaryDirectory() as folder, methods.packings_in(folder):
        field, row = silica_epoxy.solved(spheres(), method=method, **knobs)
    return row | ({"inside": inside(field)} if "particles" in knobs else {})


def warm_up(name, highest=None, replicas=None, *, method, **knobs):
    """Make the dispersion, load and compile; what is solved for that is between walls and needs no replicas."""
    if method == STEADY:
        silica_epoxy.scene("walled", FRACTION, seed=0, boundary="walls")
        methods.warm_up("dem", **knobs)
    else:
        spheres()
        methods.warm_up(method, **knobs)


def claims(df):
    """Every method against the multipoles at full size, and what it costs.

    Limits of errors are two to three times what was found; that of the memory is what a machine of 16 GiB can give, and
    that of elements per inclusion is what the paper prints. Quick rows are coarse.
    """
    df = errors(df)
    yield from [*_witness(df), *_dem(df), *_others(df)]


def errors(df):
    """The rows with the error of k against the multipoles' finest, %."""
    spheres = pick(df, name="multipole")
    exact = spheres.loc[spheres["highest"].idxmax(), "k_ratio"]  # not-a-number, and all errors with it, if it failed
    of_cell = df["k_ratio"].notna()
    df = df.assign(error_percent=(100 * referee.value_error(df["k_ratio"], exact)).where(of_cell))
    # Rows of before did not count what lies in inclusions.
    return df.assign(per_inclusion=df["inside"] / df["number"] if "inside" in df else math.nan)


def _witness(df):
    rows = pick(df, name="multipole").sort_values("highest")
    text = "Multipoles: last degree but one off the last, % of k"
    yield text, abs(rows["error_percent"].iloc[-2]), 1e-4 if rows["highest"].max() == DEGREES[-1] else 0.01


def _dem(df):
    for number, limit in ((PARTICLES[0], 0.03), (PARTICLES[-1], 0.0014)):
        rows = pick(df, name="dem", particles=number)
        yield f"DEM, {number} elements: error, %", largest(rows, "error_percent"), limit
    rows = pick(df, name="dem", particles=PARTICLES[-1]).assign(peak_gib=lambda found: found["peak_mib"] / 1024)
    yield f"DEM, {PARTICLES[-1]} elements: peak memory, GiB", largest(rows, "peak_gib"), 14.0
    fine = pick(df, name="dem").groupby("per_inclusion")["error_percent"].max().abs()
    if len(fine) == len(PARTICLES):
        enough = (number for number in fine.index if (fine[fine.index >= number] <= PAPER["dem_fft"]).all())
        few = min(enough, default=math.inf)
        yield "DEM: elements per inclusion from which it is within the paper's 0.5 %", few, PAPER["per_inclusion"]
    rows = pick(df, name=STEADY, particles=SOLVED)
    for peer in ("ruge_stuben", "aggregation") if len(rows) else ():
        ratio = (rows["cpu_s"] / rows[f"{peer}_cpu_s"]).max(skipna=False)
        yield f"Steady solve, {SOLVED} particles: CPU time over that of pyamg's {peer}", ratio, 1.0


def _others(df):
    for name, finest in (("fft", VOXELS[-1]), ("fft-em", COARSER[-1])):
        for voxels, limit in ((VOXELS[0], 0.8), (finest, 0.04)):
            rows = pick(df, name=name, voxels=voxels)
            yield f"{methods.all_methods()[name].title}, {voxels}^3: error, %", largest(rows, "error_percent"), limit
    limit = converged(df[df["precision"].isna()] if "precision" in df else df, "fft")
    exact = pick(df, name="multipole").sort_values("highest")["k_ratio"].iloc[-1]
    off = None if limit is None else 100 * abs(referee.value_error(limit, exact))
    # Quick rows have one grid of the three that are asked for.
    yield f"{methods.all_methods()['fft'].title}, extrapolated: error, %", off, 0.01
    rows = pick(df, name="fem-p1", size=SIZES["fem-p1"][-1] * methods.EDGE)
    yield "FEM, P1, finest elements: error, %", largest(rows, "error_percent"), 0.5


def table(df):
    """Errors, %, and costs. For the DEM these include its packing; `bytes` are those of the peak per unknown.

    Elements per inclusion are those whose centres lie in one, twins among them, as far as rows count them. Of FFT
    `s_per_iteration` is wall time and `in_fft` the part of it that the transforms take. `steady` is one solve of the
    spheres between walls, beside plain pyamg's Ruge-Stueben and smoothed aggregation on the same matrix (CPU seconds).
    """
    from studies.many_inclusions.tables import lines

    return lines(errors(df))


def notes(df):
    """How many tetrahedra there are beside the paper's."""
    from studies.many_inclusions.tables import told

    return told(df, PAPER)


def words(df):
    """The error of the DEM with as many particles as the first page has for one sphere."""
    rows = pick(errors(df), name="dem", particles=100_000)
    return f"{largest(rows, 'error_percent'):.2g} %"


def plot(df):
    """Error against CPU time and memory; against elements per inclusion; in degrees and voxels."""
    from studies.many_inclusions.figure import draw

    return draw(errors(df[df["status"] == "ok"]), PAPER)
