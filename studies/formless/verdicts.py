"""What the rows must hold to: distances between methods, from walkers and from bounds, and what symmetry says."""

import math

import numpy as np

from demheat import referee
from studies.formless import walked
from studies.formless.parts import BAD, BOARDS, BRICKS, FRACTIONS, GOOD, HALF, LABYRINTHS
from studies.harness import methods
from studies.harness.pick import largest, pick


def claims(df, apart):
    """Sentences, values and limits."""
    rows = with_elements(df)
    for group, limits in apart.items():
        mine = rows[rows["group"] == group]
        for name, limit in limits.items():
            text = f"{group}, {methods.all_methods()[name].title}: largest distance from elements, %"
            yield text, largest(pick(mine, name=name), "apart_percent"), limit
    fine = rows[rows["finer_percent"].notna()]
    yield "finite elements: largest change to coarser ones, %", largest(fine, "finer_percent"), 0.5
    yield from _beside_walkers(walked.judged(df))
    boards = pick(df, name="fem-p1")
    sure = [walked.beyond(df, row) for row in walked.finest(boards).to_dict("records")]
    yield (
        "checkerboards, finite elements: largest distance outside of certain bounds, %",
        np.max(sure) if sure else None,
        2.0,
    )
    yield "least distance from a bound, % of it", _room(df), ">= 0"
    yield "labyrinths, finite elements: fractions off by, % of the cell", largest(_off(df), "off_percent"), 0.1
    yield "labyrinths, finite elements: contrast .01 beside 100 of the rest, %", _dual(df), 0.5
    yield "checkerboards: largest change to bricks of half the size, %", _halved(df), 10.0
    yield "checkerboard in order: contrast .01 beside 100, %", _swapped(df), 0.01
    third = pick(df, name="fem", contrast=0.0, fraction=HALF)
    third = third.assign(
        third_percent=100 * referee.value_error(third["k_ratio"].to_numpy(), np.full(len(third), 1 / 3))
    )
    yield "half labyrinths that do not conduct, finite elements: off a third, %", largest(third, "third_percent"), 1.5


def with_elements(df):
    """Rows with their group, and how far they are from the finest elements of the same scene, %."""
    df = df.reset_index(drop=True)
    group = df["part"].where(~df["part"].isin(LABYRINTHS), "labyrinths")
    apart, finer = [], []
    for row in df.to_dict("records"):
        where = {key: _none(row.get(key)) for key in ("part", "contrast", "fraction")}
        elements = pick(df, name="fem", **where)
        best = elements[elements["size"] == elements["size"].min()]["k_ratio"] if len(elements) else ()
        off = (
            100 * referee.value_error(row["k_ratio"], float(best.iloc[0]))
            if len(best) and float(best.iloc[0])
            else float("nan")
        )
        apart.append(off if row["name"] != "fem" else float("nan"))
        finer.append(off if row["name"] == "fem" and row["size"] > elements["size"].min() else float("nan"))
    return df.assign(group=group, apart_percent=apart, finer_percent=finer)


def _beside_walkers(rows):
    """Values that walkers' intervals should hold; of so many right ones a few lie outside by chance."""
    elements, others = rows[rows["name"] == "fem"], rows[rows["name"] != "fem"]
    text = "finite elements: largest distance from walkers, in halves of their intervals"
    yield text, largest(elements, "off_halves"), 2.0
    if len(elements):
        yield f"finite elements outside of walkers' intervals, of {len(elements)}", len(walked.outside(elements)), 3
    if len(others):
        text = f"DEM and FFT neither in walkers' intervals nor within 2 % of them, of {len(others)}"
        yield text, len(walked.wrong(others)), 0


def _none(value):
    return None if value is None or value != value else value


def _room(df):
    """Least distance from a bound, % of the upper one, of perfect conductors the lower; negative outside of them."""
    df = df[~df["name"].isin(walked.WITNESSES)]
    if not len(df):
        return None
    scale = df["upper_ratio"].where(df["upper_ratio"] < math.inf, df["lower_ratio"])
    low = (df["k_ratio"] - df["lower_ratio"]) / scale
    return float(100 * low.combine((df["upper_ratio"] - df["k_ratio"]) / scale, min).min(skipna=False))


def _off(df):
    rows = pick(df, name="fem")
    rows = rows[rows["part"].isin(LABYRINTHS)]
    return rows.assign(off_percent=100 * (rows["inclusion"] - rows["fraction"]))


def _dual(df):
    """Largest distance of a bad labyrinth from the good one that it is beside, %."""
    worst = None
    for part in LABYRINTHS:
        for fraction in FRACTIONS:
            one = pick(df, name="fem", part=part, contrast=BAD, fraction=fraction)["k_ratio"]
            other = pick(df, name="fem", part=part, contrast=GOOD)
            other = other[(other["fraction"] - (1 - fraction)).abs() < 1e-9].sort_values("size")["k_ratio"]
            if len(one) and len(other):
                off = abs(100 * referee.value_error(float(one.iloc[0]), BAD * float(other.iloc[-1])))
                worst = off if worst is None else max(worst, off)
    return worst


def _boards(df, part):
    """Conductivities of a checkerboard by contrasts, down, and sizes of bricks, across."""
    return (
        pick(df, part=part, name="fem-p1").pivot(index="contrast", columns="size", values="k_ratio").sort_index(axis=1)
    )


def _halved(df):
    """Largest change of a checkerboard's conductivity when its bricks are halved, %."""
    both = [each for each in (_boards(df, part) for part in BOARDS) if each.shape[1] == len(BRICKS)]
    return max(
        (
            float(abs(100 * referee.value_error(each.iloc[:, 1].to_numpy(), each.iloc[:, 0].to_numpy())).max())
            for each in both
        ),
        default=None,
    )


def _swapped(df):
    """Both materials of a checkerboard in order lie alike, %."""
    each = _boards(df, BOARDS[0])
    if not {BAD, GOOD} <= set(each.index):
        return None
    return float(abs(100 * referee.value_error(each.loc[BAD].to_numpy(), BAD * each.loc[GOOD].to_numpy())).max())
