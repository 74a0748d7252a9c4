"""A sphere heated from its surface: its whole temperature field at 10 s, against the exact series.

Haddad et al. (Int. J. Thermal Sciences 164, 2021, 106799), figure 8 and eq. 18, corrected; the scene and the methods
are those of figure 7. Errors are at the methods' own points: all particles of the DEM, all quadrature points of the
finite elements; root mean squares are weighted by volume. Fields at 2 and 5 s stand beside it: the error is largest
while the heat has not reached the centre. The slice is the plane z = R, on a grid of points that are no particles.
"""

import numpy as np

from demheat import referee
from studies.common import sphere_in_time
from studies.common.sphere_in_time import NUMBERS, SIZES
from studies.harness.cells import cell, numbers
from studies.harness.pick import pick, present
from studies.harness.store import printed

TIMES = (2.0, 5.0, 10.0)
CASES = list(sphere_in_time.cases())
QUICK = sphere_in_time.quick
PAPER = printed("fig07_sphere")
TIMEOUT = 3600.0


def run(method, **knobs):
    """Errors over the whole field, by radius, and on the slice."""
    row = sphere_in_time.marched(TIMES, _look, method=method, **knobs)
    # One packing's picture is enough for a number of particles.
    return row | ({"slice_error": None} if knobs.get("seed") else {})


def _look(field, exact):
    off, t = referee.temperature_error(field, exact, unit="K"), f"{field.time:g}"
    r, (at, largest) = sphere_in_time.radii(off.points), referee.worst(off.values)
    row = {f"worst_{t}": abs(largest), f"rms_{t}": off.rms, f"worst_r_{t}": r[at]}
    if field.time < TIMES[-1]:
        return row
    middle, mean, size = sphere_in_time.in_shells(r, off.values, off.weights)
    grid, _ = sphere_in_time.slice_grid()
    sliced = referee.temperature_error(field, exact, grid, unit="K")
    volume = abs(referee.value_error(off.weights.sum(), field.scene.volume))
    cells = {"profile_r": middle, "profile_error": mean, "profile_worst": size}
    row |= {"volume_error": volume, "slice_worst": sliced.max}
    return row | {name: cell(values) for name, values in cells.items()} | {"slice_error": cell(sliced.values, ".3g")}


def warm_up(method, **knobs):
    """Make and keep the packing, load and compile."""
    sphere_in_time.prepare((TIMES[-1],), _look, method=method, **knobs)


def claims(df):
    """The whole field by Laguerre and by finite elements; orders; volume and heat.

    The limits of `fig07_sphere`, a sixth and a twentieth of the 1.93 K that the paper's centre is off, hold here for
    every particle. The order expected is two.
    """
    df = sphere_in_time.solved(df)
    yield from present([*_accuracy(df), *_rest(df)])


def _accuracy(df):
    for number, limit in ((100_000, 0.3), (1_000_000, 0.1)):
        rows = pick(df, law="laguerre", particles=number)
        value = rows["worst_10"].max(skipna=False) if len(rows) else None
        yield f"Laguerre, {number:.0e} particles, 10 s: largest error of any particle, K", value, limit
    # A quick run has 1000 and 3000 particles only: the paper's error with 1e5 elements is their limit.
    small = pick(df, law="laguerre", particles=NUMBERS[0])["worst_10"].max(skipna=False)
    text = f"Laguerre, {NUMBERS[0]} particles, 10 s: largest error, K, below the paper's with 1e5 elements"
    yield text, small, f"< {PAPER['centre_10s']}"
    # Found 0.17 to 0.18 K at the coarsest edge.
    curved = pick(df, order=2, size=SIZES[2][0])["worst_10"].max(skipna=False)
    yield "FEM, P2, edges of 12 mm, 10 s: largest error, K", curved, 0.4


def _rest(df):
    dem = pick(df, law="laguerre")
    for t in (TIMES[0], TIMES[-1]):
        order = sphere_in_time.order_of(dem, f"rms_{t:g}")
        yield f"Laguerre: order in the particle spacing of the error rms at {t:g} s", order, ">= 1.5"
    yield "Laguerre: volume of all cells off the sphere's, relative", dem["volume_error"].max(skipna=False), 1e-9
    yield from sphere_in_time.balance(df)


def table(df):
    """Errors in K over the whole field at 2, 5 and 10 s, means over packings.

    `worst_r_10` is the radius (in R) of the largest at 10 s, `slice_worst` the largest on the slice then, between
    particles too.
    """
    df = sphere_in_time.solved(df)
    shown = [f"{kind}_{t:g}" for kind in ("worst", "rms") for t in TIMES]
    shown += ["worst_r_10", "slice_worst", "volume_error", "unknowns", "elements", "cpu_s", "peak_mib"]
    return df.groupby(["name", "particles", "size"], sort=False, dropna=False)[shown].mean().reset_index()


def plot(df):
    """Temperature and error over the radius, errors against unknowns; the slice."""
    from matplotlib import pyplot

    from studies.common.sphere_looks import LOOKS

    df = sphere_in_time.solved(df)
    figure, ((left, middle, right), slices) = pyplot.subplots(2, 3, figsize=(14, 8.6))
    exact = _exact()
    for name, rows in df.groupby("name"):
        colour, marker = LOOKS[name]
        row = rows.loc[rows["unknowns"].idxmax()]
        label = f"{name}, {row['unknowns']:.0f} unknowns"
        r, error, size = (numbers(row[f"profile_{kind}"]) for kind in ("r", "error", "worst"))
        left.plot(r, exact(r) + error, marker, color=colour, fillstyle="none", markersize=4, label=label)
        middle.plot(r, size, marker=marker, color=colour, markersize=4)
        middle.plot(r, abs(error), ":", color=colour)
        means = rows.groupby(["particles", "size"], dropna=False)[["unknowns", "worst_10", "rms_10"]].mean()
        means = means.sort_values("unknowns")
        right.plot(means["unknowns"], means["worst_10"], marker=marker, color=colour)
        right.plot(means["unknowns"], means["rms_10"], ":", marker=marker, color=colour)
    _radial(left, middle, right, exact)
    _slices(figure, slices, df, exact)
    return figure


def _exact():
    """Exact temperature at 10 s of the radius, in radii."""
    from references import series

    (field,) = series.evolve(sphere_in_time.sphere(), [TIMES[-1]])
    reach = sphere_in_time.DIAMETER / 2
    return lambda r: field.temperature_at(sphere_in_time.CENTER + np.outer(r, [reach, 0.0, 0.0]))


def _radial(left, middle, right, exact):
    from studies.harness.figures import BLACK

    r = np.linspace(0.0, 1.0, 101)
    left.plot(r, exact(r), color=BLACK, linewidth=0.8, label="exact")
    left.set(xlabel="r / R", ylabel="temperature, C", title="10 s: exact, and plus mean errors in shells")
    middle.set(xlabel="r / R", ylabel="error, K", yscale="log", title="Finest rows, in shells: largest; dotted: |mean|")
    right.set(
        xlabel="unknowns", ylabel="error, K", xscale="log", yscale="log", title="Whole field: largest; dotted: rms"
    )
    left.legend(fontsize=8)


def _slices(figure, slices, df, exact):
    """The slice of the finest DEM, its error, and that of the finest FEM."""
    points, inside = sphere_in_time.slice_grid()
    pictured = df.dropna(subset=["slice_error"])
    dem, fem = (pick(pictured, method=method) for method in ("dem", "fem"))
    dem, fem = (rows.loc[rows["unknowns"].idxmax()] for rows in (dem, fem))
    errors = [numbers(row["slice_error"]) for row in (dem, fem)]
    pictures = [
        (exact(sphere_in_time.radii(points)) + errors[0], dem, "C"),
        (errors[0], dem, "K"),
        (errors[1], fem, "K"),
    ]
    for axes, (values, row, unit) in zip(slices, pictures, strict=True):
        plane = np.full(inside.shape, np.nan)
        plane[inside] = values
        most = None if unit == "C" else np.abs(values).max()
        scale = {} if most is None else {"vmin": -most, "vmax": most}
        image = axes.imshow(plane, origin="lower", cmap="inferno" if most is None else "RdBu_r", **scale)
        axes.set_axis_off()
        what = "temperature, C" if most is None else "error, K"
        axes.set_title(f"{row['name']}, {row['unknowns']:.0f} unknowns: {what}")
        figure.colorbar(image, ax=axes, shrink=0.8)
