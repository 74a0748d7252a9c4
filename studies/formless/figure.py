"""Conductivities between bounds, how far methods are apart, and where they lie in walkers' intervals."""

from studies.formless import walked
from studies.formless.parts import GOOD, LABYRINTHS
from studies.formless.verdicts import with_elements
from studies.harness import methods
from studies.harness.pick import pick

MARKS = {"fem": "o", "fem-p1": "o", "dem": "s", "fft": "^", "fft-plain": "v", "fft-links": "<"}
COLOURS = {"fem": "C7", "fem-p1": "C7", "dem": "C0", "fft": "C1", "fft-plain": "C2", "fft-links": "C3"}


def plot(df):
    """Conductivity of labyrinths against their fraction, between bounds; how far methods are apart, and off walkers."""
    import matplotlib.pyplot as plt

    figure, (one, other, last) = plt.subplots(1, 3, figsize=(15, 6.5), layout="constrained", width_ratios=(1, 1, 1.15))
    _between_bounds(one, df)
    _apart(other, with_elements(df))
    _by_walkers(last, df)
    every = dict(zip(*reversed(last.get_legend_handles_labels()), strict=True))
    every |= dict(zip(*reversed(other.get_legend_handles_labels()), strict=True))
    figure.legend(every.values(), every, loc="outside lower right", ncols=4, fontsize=8)
    return figure


def _between_bounds(axes, df):
    for colour, part in zip(("C0", "C1", "C2"), LABYRINTHS, strict=True):
        for name in ("fem", "dem", "fft"):
            rows = pick(df, part=part, name=name, contrast=GOOD).sort_values("fraction")
            fill, label = colour if name == "fem" else "none", f"{part}, {methods.all_methods()[name].title}"
            axes.plot(rows["fraction"], rows["k_ratio"], MARKS[name], color=colour, mfc=fill, label=label)
    rows = pick(df, name="fem", part=LABYRINTHS[0], contrast=GOOD).sort_values("fraction")
    axes.fill_between(rows["fraction"], rows["lower_ratio"], rows["upper_ratio"], color="0.9", label="bounds")
    axes.set(xlabel="fraction", ylabel="conductivity over the matrix's", yscale="log", title="contrast 100")
    axes.legend(fontsize=7)


def _apart(axes, rows):
    """Distances from elements, scenes down."""
    rows = rows[rows["apart_percent"].notna()]
    places = _places(axes, rows)
    _marked(axes, rows, "apart_percent", places)
    axes.axvline(0.0, color="0.6", lw=0.8)
    axes.set(xlabel="distance from finite elements, %", title="where no exact value is known")


def _by_walkers(axes, df):
    """Distances from walkers and their intervals, scenes down."""
    rows = walked.judged(df)
    places = _places(axes, rows)
    halves = {_name(row): row["half_percent"] for row in rows.to_dict("records")}
    axes.barh(
        [places[name] for name in halves],
        [2 * half for half in halves.values()],
        left=[-half for half in halves.values()],
        height=0.7,
        color="0.85",
        label="walkers, 95 %",
    )
    _marked(axes, rows, "off_percent", places)
    for side in (-walked.NEAR, walked.NEAR):
        axes.axvline(side, color="0.6", lw=0.8, ls=":", label="2 %")
    axes.set(xlabel="distance from walkers, %", title="walkers as referee")
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
    for name, mark in MARKS.items():
        mine = pick(rows, name=name)
        if len(mine):
            heights = [places[_name(row)] for row in mine.to_dict("records")]
            title = methods.all_methods()[name].title
            axes.plot(mine[column], heights, mark, color=COLOURS[name], ms=5, label=title)
