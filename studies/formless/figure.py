"""Conductivities between bounds, how far methods are apart, and where they lie in walkers' intervals and in bounds."""

from demheat.referee import value_error
from studies.formless import walked
from studies.formless.parts import BOARDS, GOOD, LABYRINTHS
from studies.formless.verdicts import with_elements
from studies.harness.figures import BLACK, look
from studies.harness.methods import all_methods, resolution
from studies.harness.pick import pick

# Marks of methods that have the colour and mark of another: plain and linked voxels are no diamonds here.
MARKS = {"fem": "^", "fem-p1": "^", "fft": "D", "fft-plain": "s", "fft-links": "P", "dem": "o"}
# Lines of labyrinths, by finite elements.
LINES = dict(zip(LABYRINTHS, ("-", "--", ":"), strict=True))
BAR = {"height": 0.7, "color": "0.85"}


def plot(df):
    """Labyrinths and checkerboards between bounds; how far methods are apart, and how far they are off walkers."""
    from matplotlib import pyplot

    panels = [["labyrinths", "apart", "walkers"], ["boards", "apart", "walkers"]]
    figure, axes = pyplot.subplot_mosaic(panels, figsize=(16, 8.5), width_ratios=(1, 1, 1.15), height_ratios=(1.5, 1))
    _between_bounds(axes["labyrinths"], df)
    _boards(axes["boards"], df)
    _apart(axes["apart"], with_elements(df))
    _by_walkers(axes["walkers"], df)
    every = {}
    for panel in ("walkers", "apart"):
        every |= dict(zip(*reversed(axes[panel].get_legend_handles_labels()), strict=True))
    figure.legend(every.values(), every, loc="outside lower right", ncols=7, fontsize=9)
    return figure


def _style(name, **more):
    # Voxels larger, so that they are seen below particles.
    size = 7 if name.startswith("fft") else 5
    return look(name, label=all_methods()[name].title, linestyle="", marker=MARKS[name], markersize=size) | more


def _between_bounds(axes, df):
    """Labyrinths by their fraction: a line each by elements, other methods open on it."""
    for part, line in LINES.items():
        rows = pick(df, part=part, name="fem", contrast=GOOD).sort_values("fraction")
        rows = rows.drop_duplicates("fraction", keep="last")
        style = _style("fem", linestyle=line, label=f"{part}, FEM")
        axes.plot(rows["fraction"], rows["k_ratio"], **style)
    for name, size in (("dem", 9), ("fft", 11)):
        rows = pick(df, name=name, contrast=GOOD)
        rows = rows[rows["part"].isin(LABYRINTHS)]
        axes.plot(rows["fraction"], rows["k_ratio"], **_style(name, markerfacecolor="none", markersize=size))
    rows = pick(df, name="fem", part=LABYRINTHS[0], contrast=GOOD).sort_values("fraction")
    axes.fill_between(rows["fraction"], rows["lower_ratio"], rows["upper_ratio"], color="0.9", label="bounds")
    axes.set(xlabel="fraction", ylabel="conductivity over the matrix's", yscale="log")
    axes.set_title("Labyrinths, contrast 100")
    axes.legend(fontsize=8)


def _boards(axes, df):
    """Checkerboards by bricks of both sizes, over the upper one of the bounds that hold for sure."""
    rows = pick(df, name="fem-p1")
    rows = rows[rows["part"].isin(BOARDS)].to_dict("records")
    names = list(dict.fromkeys(map(_name, rows)))[::-1]
    axes.set_yticks(range(len(names)), names, fontsize=8)
    for row in rows:
        (low, high), place = walked.certain(df, row), names.index(_name(row))
        over, fine = 100 * value_error(row["k_ratio"], high), row["size"] == min(each["size"] for each in rows)
        below = 100 * value_error(low, high)
        axes.barh(place, -below, left=below, label=_once(axes, "bounds"), **BAR)
        words = f"{all_methods()['fem-p1'].title}, {resolution(row)}"
        axes.plot(over, place, **_style("fem-p1", label=_once(axes, words)), markerfacecolor=None if fine else "none")
    axes.axvline(0.0, color=BLACK, lw=0.8)
    axes.set(xlabel="over the upper bound, %", title="Checkerboards: above bounds")
    axes.set_axisbelow(True)
    axes.use_sticky_edges = False
    axes.margins(x=0.05)
    if rows:
        axes.legend(fontsize=8, loc="upper right", bbox_to_anchor=(1.0, -0.22), ncols=3, columnspacing=1.0)


def _once(axes, label):
    return None if label in axes.get_legend_handles_labels()[1] else label


def _apart(axes, rows):
    """Distances from elements, scenes down."""
    rows = rows[rows["apart_percent"].notna()]
    places = _places(axes, rows)
    _marked(axes, rows, "apart_percent", places)
    axes.axvline(0.0, color="0.6", lw=0.8)
    axes.set(xlabel="distance from finite elements, %", title="Where no exact value is known")


def _by_walkers(axes, df):
    """Distances from walkers and their intervals, scenes down."""
    rows = walked.judged(df)
    places = _places(axes, rows)
    halves = {_name(row): row["half_percent"] for row in rows.to_dict("records")}
    heights, left = [places[name] for name in halves], [-half for half in halves.values()]
    axes.barh(heights, [2 * half for half in halves.values()], left=left, label="walkers, 95 %", **BAR)
    _marked(axes, rows, "off_percent", places)
    for side in (-walked.NEAR, walked.NEAR):
        axes.axvline(side, color="0.6", lw=0.8, ls=":", label="2 %")
    axes.set(xlabel="distance from walkers, %", title="Walkers as referee")
    axes.use_sticky_edges = False
    axes.margins(x=0.05)


def _name(row):
    fraction = "" if row["fraction"] != row["fraction"] else f" {row['fraction']:g}"
    return f"{row['part']}{fraction}, {row['contrast']:g}"


def _places(axes, rows):
    """Heights of scenes, the first above."""
    names = list(dict.fromkeys(map(_name, rows.to_dict("records"))))
    axes.set_yticks(range(len(names)), names[::-1], fontsize=8)
    axes.set_ylabel("part and fraction, contrast")
    return {name: k for k, name in enumerate(names[::-1])}


def _marked(axes, rows, column, places):
    for name in MARKS:
        mine = pick(rows, name=name)
        if len(mine):
            heights = [places[_name(row)] for row in mine.to_dict("records")]
            axes.plot(mine[column], heights, **_style(name))
