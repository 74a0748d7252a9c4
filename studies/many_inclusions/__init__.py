"""Silica in epoxy, 83 spheres: error against cost, up to 8e6 elements, 512^3 voxels and 2.3e6 tetrahedra.

Section 5 of Haddad et al. (Int. J. Thermal Sciences 164, 2021, 106799) at its full size, on two processors: one
periodic cell of fig17_etc, a fifth of it spheres, under a mean gradient. Errors are those of the conductivity against
Rayleigh's multipole method at its highest degree here. The DEM's costs are those from the scene to the conductivity,
its packing made on the spot. The steady solver stands beside plain pyamg on the matrix of such spheres between walls.
FEM also meets cells of 124 spheres whose least gap is down to a thousandth of a diameter.

The paper's network is here twice: "DEM as in the paper" on replicas of small relaxed packings that are made on the
spot; and on both packings of `studies/common/paper_network.py`, from the cache, 125 000 particles or replicas of them
up to the paper's 8e6. The cell has no walls: what those change is in `fig14_single_inclusion` and `fig17_etc`.
"""

import math
import tempfile

from demheat import referee
from studies.common import paper_network, silica_epoxy
from studies.common.paper_network import NAME, unscaled
from studies.common.paper_variants import parted, values, variants
from studies.harness import methods
from studies.harness.converged import converged
from studies.harness.pick import largest, pick, present
from studies.harness.store import printed
from studies.many_inclusions.means import network_errors

FRACTION, CLOSE = 0.2, 0.3
PARTICLES = (10_000, 30_000, 100_000, 300_000, 1_000_000, 8_000_000)
NETWORKS = {1: 10_000, 2: 100_000, 4: 1_000_000}  # replicas along an edge, and particles, of the paper's law
# Of its packings: replicas along an edge, and packings that are repeated; one of the largest costs minutes.
REPLICATED = {125_000: (1, (0, 1, 2)), 1_000_000: (2, (0, 1, 2)), 8_000_000: (4, (0,))}
VOXELS = (64, 128, 256, 512)
SINGLE = (128, 512)  # voxels in float32
SIZES = {"fem": (1 / 24, 1 / 34, 1 / 48), "fem-p1": (1 / 20, 1 / 40, 0.012)}  # in edges of the cube
RESOLUTIONS = {"particles": PARTICLES, "voxels": VOXELS, "size": SIZES["fem"], "fem-p1": SIZES["fem-p1"]}
DEGREES = (4, 6, 8, 10, 12, 14, 16)
GAPS = (0.003, 0.001)
SOLVED = 1_000_000  # particles of the matrix that pyamg solves too
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
    yield from (methods.case("fft", voxels=voxels, precision="float32") for voxels in SINGLE)
    yield from (methods.case("fem", gap=gap, size=methods.EDGE / 24) for gap in GAPS)
    yield {"name": "steady", "particles": PARTICLES[0], "seed": 0, "method": "dem"}
    yield {"name": "steady", "particles": SOLVED, "seed": 0, "method": "dem"}
    for number, (replicas, seeds) in REPLICATED.items():
        yield from paper_network.cases([number], held=["periodic"], seeds=seeds, replicas=replicas)


CASES = list(_cases())


def QUICK(case):
    """Coarse rows of the one cell, without elements, which spheres make fine and a quick run of `fig17_etc` has.

    Nor the steady solver beside pyamg, which a quick run of `speed_error` has, nor the network's packings, which one of
    `fig14_single_inclusion` has.
    """
    if case["name"] == "multipole":
        return case["highest"] in DEGREES[:3]
    if case["name"] in ("steady", NAME):
        return False
    method = methods.found()[case["name"]]
    coarsest = methods.at(method, methods.spent(method, RESOLUTIONS)[0])
    return coarsest.items() <= case.items() and case["method"] != "fem"


def run(name, gap=None, highest=None, *, method, **knobs):
    """Solve the cell, or time solvers on its matrix."""
    if name == "steady":
        from studies.common import peers

        return peers.steady(**knobs, scene=silica_epoxy.scene("walled", FRACTION, seed=0, boundary="walls"))
    made = _scene(gap)
    if name == NAME:
        return _network(made, **knobs)
    if highest is not None:
        knobs["order"] = highest
    # Nothing is kept: packings are part of the cost.
    with tempfile.TemporaryDirectory() as folder, methods.packings_in(folder):
        field, row = silica_epoxy.solved(made, method=method, **knobs)
    return row | ({"inside": _inside(field)} if "particles" in knobs else {})


def _network(made, packing, held, particles, seed, replicas=1):
    one = paper_network.packed(made.size, packing, held, particles, seed, replicas)
    fields, row = paper_network.solved({"k": made}, one, held, replicas)
    k = unscaled(fields["k"], silica_epoxy.EPOXY.conductivity)
    return row | {"k_spheres": k, "number": len(made.inclusions), "inside": _inside(fields["k"])}


def _inside(field):
    """Particles whose centres lie in inclusions, twins among them."""
    return int((field.samples.phase > 0).sum())


def warm_up(name, gap=None, highest=None, replicas=None, *, method, **knobs):
    """Make the dispersion, load and compile; what is solved for that is between walls and needs no replicas."""
    made = _scene(gap)
    if name == NAME:
        paper_network.packed(made.size, **knobs)
        paper_network.warm_up(knobs["held"])
    else:
        methods.warm_up(method, **knobs)


def _scene(gap):
    if gap is None:
        return silica_epoxy.scene("periodic", FRACTION, seed=0)
    return silica_epoxy.scene("periodic", CLOSE, seed=0, gap=gap)


def claims(df):
    """Every method against the multipoles at full size, and what it costs; the paper's network in the paper's measure.

    Limits of errors are two to three times what was found; that of the memory is what a machine of 16 GiB can give, and
    those of elements per inclusion and of the paper's network are what the paper prints. Quick rows are coarse.
    """
    network, df = parted(df)
    df = errors(df)
    yield from present([*_witness(df), *_dem(df), *_network_claims(network, df), *_others(df)])


def _network_claims(network, df):
    """The printed 0.5 % is between DEM of 8e6 and FFT of 512^3."""
    fft = pick(df, name="fft", voxels=VOXELS[-1], precision=None)["k_ratio"]
    rows = pick(network, particles=max(REPLICATED))
    for variant in variants(["periodic"]) if len(fft) and len(rows) else ():
        k = values(rows, variant, "k_spheres")
        off = 100 * abs(referee.value_error(k, float(fft.iloc[0]))).max() if len(k) else None
        text = f"The paper's network, {max(REPLICATED)} particles, {variant.words}: off FFT, {VOXELS[-1]}^3, %"
        yield text, off, PAPER["dem_fft"]


def errors(df):
    """The rows with the error of k against the multipoles' finest, %."""
    spheres = pick(df, name="multipole")
    exact = spheres.loc[spheres["highest"].idxmax(), "k_ratio"]  # not-a-number, and all errors with it, if it failed
    of_cell = df["k_ratio"].notna() & (df["gap"].isna() if "gap" in df else True)
    df = df.assign(error_percent=(100 * referee.value_error(df["k_ratio"], exact)).where(of_cell))
    # Rows of before did not count what lies in inclusions.
    return df.assign(per_inclusion=df["inside"] / df["number"] if "inside" in df else math.nan)


def _witness(df):
    rows = pick(df, name="multipole").sort_values("highest")
    text = "Multipoles: last degree but one off the last, % of k"
    yield text, abs(rows["error_percent"].iloc[-2]), 1e-4 if rows["highest"].max() == DEGREES[-1] else 0.01


def _dem(df):
    for number, limit in ((PARTICLES[0], 2.0), (PARTICLES[-2], 0.05), (PARTICLES[-1], 0.0075)):
        rows = pick(df, name="dem", particles=number)
        yield f"DEM, {number} elements: error, %", largest(rows, "error_percent"), limit
    rows = pick(df, name="dem", particles=PARTICLES[-1]).assign(peak_gib=lambda found: found["peak_mib"] / 1024)
    yield f"DEM, {PARTICLES[-1]} elements: peak memory, GiB", largest(rows, "peak_gib"), 14.0
    fine = pick(df, name="dem").groupby("per_inclusion")["error_percent"].max().abs()
    if len(fine) == len(PARTICLES):
        few = min(number for number in fine.index if (fine[fine.index >= number] <= PAPER["dem_fft"]).all())
        yield "DEM: elements per inclusion from which it is within the paper's 0.5 %", few, PAPER["per_inclusion"]
    rows = pick(df, name="steady", particles=SOLVED)
    for peer in ("ruge_stuben", "aggregation") if len(rows) else ():
        ratio = (rows["cpu_s"] / rows[f"{peer}_cpu_s"]).max(skipna=False)
        yield f"Steady solve, {SOLVED} particles: CPU time over that of pyamg's {peer}", ratio, 1.0


def _others(df):
    for name in ("fft", "fft-em"):
        title = methods.found()[name].title
        for voxels, limit in ((VOXELS[0], 1.0), (VOXELS[-1], 0.05)):
            rows = pick(df, name=name, voxels=voxels)
            yield f"{title}, {voxels}^3: error, %", largest(rows, "error_percent"), limit
        limit = converged(df[df["precision"].isna()] if "precision" in df else df, name)
        exact = pick(df, name="multipole").sort_values("highest")["k_ratio"].iloc[-1]
        off = None if limit is None else 100 * abs(referee.value_error(limit, exact))
        # Quick rows have one grid of the three that are asked for.
        yield f"{title}, extrapolated: error, %", off, 0.01
    double, single = (pick(df, name="fft", voxels=VOXELS[-1], precision=p) for p in (None, "float32"))
    if len(double) and len(single):
        lost = referee.value_error(*(float(rows["k_ratio"].iloc[0]) for rows in (single, double)))
        yield f"FFT, scalar, {VOXELS[-1]}^3: what float32 changes, %", 100 * abs(lost), 1e-5
    for name, title, limit in (("fem", "FEM, P2", 0.05), ("fem-p1", "FEM, P1", 0.5)):
        rows = pick(df, name=name, size=SIZES[name][-1] * methods.EDGE, gap=None)
        yield f"{title}, finest elements: error, %", largest(rows, "error_percent"), limit


def table(df):
    """Errors, %, and costs. For the DEM these include its packing; `bytes` are those of the peak per unknown.

    Elements per inclusion are those whose centres lie in one, twins among them, as far as rows count them. Of FFT
    `s_per_iteration` is wall time and `in_fft` the part of it that the transforms take. `steady` is one solve of the
    spheres between walls, beside plain pyamg's Ruge-Stueben and smoothed aggregation on the same matrix (CPU seconds).
    """
    from studies.many_inclusions.tables import lines

    return lines(errors(parted(df)[1]))


def notes(df):
    """The paper's network on both packings; how many tetrahedra there are beside the paper's."""
    from studies.many_inclusions.tables import told

    return told(df, PAPER)


def plot(df):
    """Error against CPU time and memory; against elements per inclusion; in degrees and voxels."""
    from studies.many_inclusions.figure import draw

    df = df[df["status"] == "ok"]
    return draw(errors(parted(df)[1]), network_errors(df), PAPER)
