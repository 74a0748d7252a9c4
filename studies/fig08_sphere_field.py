"""A sphere heated from its surface: its whole temperature field at 10 s, against the exact series.

Haddad et al. (Int. J. Thermal Sciences 164, 2021, 106799), figure 8 and eq. 18, corrected; the scene and the methods
are those of figure 7. Errors are at the methods' own points: all particles of the DEM, all quadrature points of the
finite elements; root mean squares are weighted by volume. Fields at 2 and 5 s stand beside it: the error is largest
while the heat has not reached the centre. The slice is the plane z = R, on a grid of points that are no particles: the
temperature of the paper's network with 1e5 elements, where the paper shows 1e6, too, and how far that is off the exact
field.
"""

from functools import partial

import numpy as np

from demheat import referee
from studies.common import sphere_in_time
from studies.common.sphere_in_time import NUMBERS, SIZES
from studies.harness.cells import cell, numbers
from studies.harness.pick import pick
from studies.harness.printed import printed

TIMES = (2.0, 5.0, 10.0)
# Points along a side of the slice; at sizes that are not drawn in a full run, fewer.
SIDE, COARSE = 81, 41


CASES = [case for case in sphere_in_time.cases() if case.get("law") != "platonic"]
# What these solves cost stands in figure 7.
VALUES = True
QUICK = sphere_in_time.quick


# Limits from elsewhere: what the paper prints.
ELSEWHERE = ("beside the paper's 1.93 K", "(the paper: at the centre)")
# Limits that are far from the values, and why they are no nearer.
REASONS = {
    "volume of all cells off": "rounding of a sum over cells",
    "heat lost over heat moved": "rounding; of elements the tolerance of each step's equations",
}
PAPER = printed("fig07_sphere")
ITS_NETWORK = "Contacts, calibrated, 1e5 particles"
TIMEOUT = 3600.0


def run(method, **knobs):
    """Errors over the whole field, by radius, and on the slice."""
    row = sphere_in_time.marched(TIMES, partial(_look, side=_side(**knobs)), method=method, **knobs)
    # One packing's picture is enough for a number of particles.
    return row | ({"slice_error": None} if knobs.get("seed") else {})


def _side(particles=0, size=np.inf, **_):
    return SIDE if particles >= sphere_in_time.PAPERS or size == SIZES[1][-1] else COARSE


def _look(field, exact, side=COARSE):
    off, t = referee.temperature_error(field, exact, unit="K"), f"{field.time:g}"
    r, (at, largest) = sphere_in_time.radii(off.points), referee.worst(off.values)
    row = {f"worst_{t}": abs(largest), f"rms_{t}": off.rms, f"worst_r_{t}": r[at]}
    if field.time < TIMES[-1]:
        return row
    middle, mean, size = sphere_in_time.in_shells(r, off.values, off.weights)
    grid, _ = sphere_in_time.slice_grid(side)
    sliced = referee.temperature_error(field, exact, grid, unit="K")
    volume = abs(referee.value_error(off.weights.sum(), field.scene.volume))
    cells = {"profile_r": middle, "profile_error": mean, "profile_worst": size}
    row |= {"volume_error": volume, "slice_worst": sliced.max, "slice_side": side}
    return row | {name: cell(values) for name, values in cells.items()} | {"slice_error": cell(sliced.values, ".3g")}


def claims(df):
    """The whole field by Laguerre, by finite elements and by the paper's network; orders; volume and heat.

    Limits are two to three times what was found: checks that later code does as well. The paper's 1.93 K at the centre,
    its largest difference with 1e5 elements, is asked of its network within a half either way, and of 1000 particles of
    Laguerre. Its largest error is at the centre, as printed, in means over shells, whose limit is the second of twenty
    (set when the value was seen): single particles scatter by as much (`worst_r_10`). The order expected is two.
    """
    df = sphere_in_time.solved(df)
    yield from [*_accuracy(df), *_rest(df)]


def _accuracy(df):
    for number, limit in ((100_000, 0.1), (1_000_000, 0.019)):
        rows = pick(df, law="laguerre", particles=number)
        value = rows["worst_10"].max(skipna=False) if len(rows) else None
        yield f"Laguerre, {number:.0e} particles, 10 s: largest error of any particle, K", value, limit
    # A quick run has 1000 and 3000 particles only: the paper's error with 1e5 elements is their limit.
    small = pick(df, law="laguerre", particles=NUMBERS[0])["worst_10"].max(skipna=False)
    text = f"Laguerre, {NUMBERS[0]} particles, 10 s: largest error, K, below the paper's with 1e5 elements"
    yield text, small, f"< {PAPER['centre_10s']}"
    network = pick(df, law="calibrated", particles=int(PAPER["particles"]))["worst_10"].max(skipna=False)
    ratio = network / PAPER["centre_10s"]
    text = f"{ITS_NETWORK}, 10 s: largest error of any particle, wherever it is, beside the paper's 1.93 K at the "
    text += "centre, factor"
    yield text, None if ratio != ratio else max(ratio, 1 / ratio), 1.5
    text = f"{ITS_NETWORK}, 10 s: radius of the shell whose mean error is largest, R (the paper: at the centre)"
    yield text, _widest(pick(df, law="calibrated", particles=int(PAPER["particles"]))), 0.075
    # Found 0.17 to 0.18 K at the coarsest edge.
    curved = pick(df, order=2, size=SIZES[2][0])["worst_10"].max(skipna=False)
    yield "FEM, P2, edges of 12 mm, 10 s: largest error, K", curved, 0.4


def _widest(rows):
    """Largest radius, over packings, of the middle of the shell whose mean is farthest off; None without rows."""
    found = [(numbers(row["profile_r"]), np.abs(numbers(row["profile_error"]))) for _, row in rows.iterrows()]
    return max((middle[np.nanargmax(size)] for middle, size in found), default=None)


def _rest(df):
    dem = pick(df, law="laguerre")
    for t in (TIMES[0], TIMES[-1]):
        order = sphere_in_time.order_of(dem, f"rms_{t:g}")
        yield f"Laguerre: order in the particle spacing of the error rms at {t:g} s", order, ">= 1.5"
    yield "Laguerre: volume of all cells off the sphere's, relative", dem["volume_error"].max(skipna=False), 1e-12
    yield from sphere_in_time.balance(df)


def table(df):
    """Errors in K over the whole field at 2, 5 and 10 s, means over packings.

    `worst_r_10` is the radius (in R) of the largest at 10 s, `slice_worst` the largest on the slice then, between
    particles too.
    """
    shown = [f"{kind}_{t:g}" for kind in ("worst", "rms") for t in TIMES]
    return _means(df, [*shown, "worst_r_10", "slice_worst"])


def notes(df):
    """What each row takes."""
    from studies.harness.table import markdown

    yield "Volume of all cells or elements off the sphere's, relative; costs of the same solves are in figure 7."
    yield markdown(_means(df, ["volume_error", "unknowns", "elements"]))


def _means(df, columns):
    """Means over packings of rows that have numbers, by method and resolution."""
    groups = sphere_in_time.solved(df).groupby(["name", "particles", "size"], sort=False, dropna=False)
    return groups[columns].mean().reset_index()


def plot(df):
    """Temperature and error over the radius, errors against unknowns; the slice and how far it is off."""
    from matplotlib import pyplot

    from studies.common.sphere_looks import LOOKS

    df = sphere_in_time.solved(df)
    figure = pyplot.figure(figsize=(14, 12))
    charts, maps = figure.subfigures(2, 1, height_ratios=(1.0, 1.75))
    left, middle, right = charts.subplots(1, 3)
    exact = _exact()
    for name, rows in df.groupby("name"):
        colour, marker = LOOKS[name]
        row = rows.loc[rows["unknowns"].idxmax()]
        label = f"{name}, {row['unknowns']:.0f} unknowns"
        r, error, size = (numbers(row[f"profile_{kind}"]) for kind in ("r", "error", "worst"))
        left.plot(r, exact(r) + error, marker, color=colour, fillstyle="none", markersize=4, label=label)
        middle.plot(r, size, marker=marker, color=colour, markersize=4)
        means = rows.groupby(["particles", "size"], dropna=False)[["unknowns", "worst_10", "rms_10"]].mean()
        means = means.sort_values("unknowns")
        right.plot(means["unknowns"], means["worst_10"], marker=marker, color=colour)
        right.plot(means["unknowns"], means["rms_10"], ":", marker=marker, color=colour, markersize=3)
    _radial(left, middle, right, exact)
    charts.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    _slices(maps, df, exact)
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
    left.set(xlabel="r / R", ylabel="temperature, C", title="10 s: means in shells, and exact")
    middle.set(xlabel="r / R", ylabel="error, K", yscale="log", title="10 s: largest error in each shell")
    right.set(xlabel="unknowns", ylabel="error, K", xscale="log", yscale="log")
    right.set_title("10 s, whole field: largest (solid), rms (dotted)")


def _slices(figure, df, exact):
    """The slice by the paper's network, twice, by Laguerre and by elements; below each how far it is off."""
    rows = _shown(df)
    figure.suptitle("The plane z = R at 10 s: temperature, and its difference from the exact field", fontsize=12)
    columns = figure.subfigures(1, len(rows))
    planes = [_plane(row) for row in rows]
    off = [np.nanmax(np.abs(plane)) for plane in planes]
    for column, row, plane in zip(np.atleast_1d(columns), rows, planes, strict=True):
        upper, lower = column.subplots(2, 1)
        # One scale for both networks, one for what is far more exact.
        most = max(o for o, other in zip(off, rows, strict=True) if _contacts(other) == _contacts(row))
        points, inside = sphere_in_time.slice_grid(len(plane))
        field = np.full(inside.shape, np.nan)
        field[inside] = exact(sphere_in_time.radii(points)) + plane[inside]
        warm = upper.imshow(field, origin="lower", cmap="inferno", vmin=182.0, vmax=200.0)
        differ = lower.imshow(plane, origin="lower", cmap="RdBu_r", vmin=-most, vmax=most)
        size = f"{row['particles']:.0f} particles" if row["method"] == "dem" else f"{row['elements']:.0f} elements"
        upper.set_title(f"{row['name']},\n{size}", fontsize=10)
        lower.set_title(f"largest {np.nanmax(np.abs(plane)):.2g} K", fontsize=10)
        for axes, image, unit in ((upper, warm, "temperature, C"), (lower, differ, "difference, K")):
            axes.set_axis_off()
            figure_bar = column.colorbar(image, ax=axes, orientation="horizontal", shrink=0.8, pad=0.02)
            figure_bar.set_label(unit, fontsize=9)
            figure_bar.ax.locator_params(nbins=4)


def _contacts(row):
    return row["name"] == "DEM, calibrated"


def _shown(df):
    """The two largest networks of the paper, the largest of Laguerre, the finest quadratic elements; with pictures."""
    pictured = df.dropna(subset=["slice_error"])
    networks = pick(pictured, law="calibrated").sort_values("particles").tail(2)
    others = (pick(pictured, law="laguerre"), pick(pictured, order=2))
    return [row for _, row in networks.iterrows()] + [
        rows.loc[rows["unknowns"].idxmax()] for rows in others if len(rows)
    ]


def _plane(row):
    """Differences on the square that holds the slice, K; not-a-number outside the sphere."""
    side = row.get("slice_side", np.nan)
    _, inside = sphere_in_time.slice_grid(COARSE if side != side else int(side))
    plane = np.full(inside.shape, np.nan)
    plane[inside] = numbers(row["slice_error"])
    return plane
