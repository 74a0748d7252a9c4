"""A sphere heated from its surface: the temperature of its centre in time, against the exact series.

Haddad et al. (Int. J. Thermal Sciences 164, 2021, 106799), figure 7 and eq. 19, corrected: diameter 0.1 m, 20 C, its
surface at 200 C from time 0 on; 900 J/(kg K), 185 W/(m K), 2700 kg/m3. The paper's contact network with 1e5 elements
was 1.93 K off at 10 s. Facets of the radical tessellation ("laguerre") include the cells' walls at the surface, placed
so that the volume is exact. The laws of contacts hold the centres of the particles that touch the surface at its
temperature, as in the paper; C_t of "calibrated" is that of a cube of the same volume, packed with the same radii
between walls. Temperatures are read at the centre itself: in the particle there, with its own gradient. Finite elements
are straight linear (P1) and curved quadratic (P2) tetrahedra. Costs leave out the packings, which come from the cache,
and include the mesh.
"""

import numpy as np

from demheat import referee
from studies.common import sphere_in_time
from studies.common.sphere_in_time import NUMBERS, PAPERS, SIZES
from studies.harness.cells import cell, numbers
from studies.harness.pick import pick, present
from studies.harness.store import printed

TIMES = (0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 12.0, 15.0, 20.0, 25.0, 30.0)
CASES = list(sphere_in_time.cases())
QUICK = sphere_in_time.quick
PAPER = printed("fig07_sphere")
TIMEOUT = 3600.0


def run(method, **knobs):
    """Errors of the centre in time."""
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


def warm_up(method, **knobs):
    """Make and keep the packing, load and compile."""
    sphere_in_time.prepare((1.0,), _look, method=method, **knobs)


def claims(df):
    """The centre by Laguerre, by the laws of contacts and by finite elements; orders; heat.

    The limits with 1e5 and 1e6 particles, 0.3 and 0.1 K, are a sixth and a twentieth of what the paper's network of 1e5
    is off at 10 s, 1.93 K; our network of that kind must be off by half to twice as much. The order expected is two.
    """
    df = sphere_in_time.solved(df)
    yield from present([*_accuracy(df), *_rest(df)])


def _accuracy(df):
    at_10s = df["error_10s"].abs()
    for number, limit in ((100_000, 0.3), (1_000_000, 0.1)):
        rows = pick(df, law="laguerre", particles=number).index
        value = at_10s[rows].max(skipna=False) if len(rows) else None
        yield f"Laguerre, {number:.0e} particles: error of the centre at 10 s, K (paper 1.93 with 1e5)", value, limit
    # A quick run has 1000 and 3000 particles only: the paper's error with 1e5 elements is their limit.
    small = pick(df, law="laguerre", particles=NUMBERS[0]).index
    text = f"Laguerre, {NUMBERS[0]} particles: error of the centre at 10 s, K, below the paper's with 1e5 elements"
    yield text, at_10s[small].max(skipna=False), f"< {PAPER['centre_10s']}"
    paper = pick(df, law="calibrated", particles=PAPERS).index
    value = at_10s[paper].max(skipna=False) / PAPER["centre_10s"] if len(paper) else None
    # Ours and theirs are single packings, of two algorithms, with other links.
    for limit in ("<= 2", ">= 0.5"):
        yield "Calibrated, 1e5 particles: error of the centre at 10 s over the paper's 1.93 K", value, limit
    for law in sphere_in_time.CONTACTS:
        ours, theirs = (at_10s[pick(df, law=name, particles=NUMBERS[1]).index].mean() for name in ("laguerre", law))
        text = f"{NUMBERS[1]} particles: error of the centre at 10 s, {law} over Laguerre"
        yield text, theirs / ours, ">= 3"
    # Found 0.13 to 0.15 K at the coarsest edge: a third order scheme that curves with the surface.
    curved = pick(df, order=2, size=SIZES[2][0]).index
    yield "FEM, P2, edges of 12 mm: error of the centre at 10 s, K", at_10s[curved].max(skipna=False), 0.3


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
    df = sphere_in_time.solved(df)
    df["at_10s"], df["packings"] = df["error_10s"].abs(), df["seed"].notna().astype(int)
    kept = {"at_10s": "mean", "worst": "mean", "worst_at_s": "mean", "packings": "sum"}
    kept |= {name: "mean" for name in ("unknowns", "elements", "steps", "iterations", "cpu_s", "peak_mib")}
    found = df.groupby(["name", "particles", "size"], sort=False, dropna=False)
    return found.agg(kept).reset_index()


def plot(df):
    """The centre in time, its error in time, and errors against unknowns."""
    from matplotlib import pyplot

    from references import series
    from studies.common.sphere_looks import LOOKS
    from studies.harness.figures import BLACK

    df = sphere_in_time.solved(df)
    figure, (left, middle, right) = pyplot.subplots(1, 3, figsize=(15, 4.6))
    times = np.array(TIMES)
    curve = np.linspace(0.0, 30.0, 121)
    exact = [f.temperature_at(sphere_in_time.CENTER)[0] for f in series.evolve(sphere_in_time.sphere(), curve)]
    left.plot(curve, exact, color=BLACK, linewidth=0.8, label="exact")
    for name, rows in df.groupby("name"):
        colour, marker = LOOKS[name]
        row = rows.loc[rows["unknowns"].idxmax()]
        there = np.interp(times, curve, exact) + numbers(row["errors"])
        label = f"{name}, {row['unknowns']:.0f} unknowns"
        left.plot(times, there, marker, color=colour, markersize=4, fillstyle="none", label=label)
        _errors(middle, right, name, rows, (colour, marker))
    left.set(xlabel="time, s", ylabel="temperature of the centre, C", title="The centre in time")
    middle.set(xlabel="time, s", ylabel="|error| of the centre, K", yscale="log", ylim=(1e-4, 20.0))
    middle.set_title("Its error: darker is finer (one packing)")
    right.plot(PAPER["particles"], PAPER["centre_10s"], "*", color=BLACK, markersize=11, label="DEM of the paper, 10 s")
    right.set(xlabel="unknowns", ylabel="|error| of the centre, K", xscale="log", yscale="log")
    right.set_title("Largest in time (lines), at 10 s (dots)")
    left.legend()
    right.legend()
    return figure


def _errors(middle, right, name, rows, look):
    colour, marker = look
    first = rows[rows["seed"].fillna(0) == 0].sort_values("unknowns")
    # The laws of contacts differ little from one size to the next.
    first = first[-1:] if name in ("DEM, calibrated", "DEM, platonic") else first
    for place, (_, row) in enumerate(first.iterrows(), start=1):
        size = np.abs(numbers(row["errors"]))
        middle.plot(TIMES, size, color=colour, alpha=place / len(first), linewidth=1.2)
    means = rows.assign(at_10s=rows["error_10s"].abs()).groupby(["particles", "size"], dropna=False)
    means = means[["unknowns", "worst", "at_10s"]].mean().sort_values("unknowns")
    right.plot(means["unknowns"], means["worst"], marker=marker, color=colour, label=name)
    right.plot(means["unknowns"], means["at_10s"], ":", marker=marker, markersize=3, color=colour)
